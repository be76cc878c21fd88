//! Lines of the kernel's GPIO character device.
//!
//! The kernel records the time of each edge and keeps 64 of them, so that a loop that reads later loses none.

use super::clock::Monotonic;
use embedded_hal::digital::{ErrorKind, ErrorType, OutputPin};
use gpiocdev::Request;
use gpiocdev::line::{Bias, EdgeDetection, Value};
use hal::Edges;
use std::time::Duration;

/// The name of the lines' consumer, as `gpioinfo` shows it.
const CONSUMER: &str = "airball";
/// Edges that the kernel keeps: a third of a second of the fastest small fans.
const EDGES: u32 = 64;

/// The falling edges of an input with a pull-up, as an open collector needs it.
pub(super) struct KernelEdges {
    request: Request,
    clock: Monotonic,
}

impl KernelEdges {
    pub(super) fn open(chip: &str, line: u32, clock: Monotonic) -> gpiocdev::Result<Self> {
        let request = Request::builder()
            .on_chip(chip)
            .with_consumer(CONSUMER)
            .with_line(line)
            .as_input()
            .with_bias(Bias::PullUp)
            .with_edge_detection(EdgeDetection::FallingEdge)
            .with_kernel_event_buffer_size(EDGES)
            .request()?;
        Ok(Self { request, clock })
    }
}

impl Edges for KernelEdges {
    /// A line that cannot be read any more gives no edges, like a fan that does not turn.
    fn next_edge_s(&mut self) -> Option<f64> {
        self.request.has_edge_event().ok().filter(|is_there| *is_there)?;
        let edge = self.request.read_edge_event().ok()?;
        Some(self.clock.seconds_at(Duration::from_nanos(edge.timestamp_ns)))
    }
}

/// An output that begins high.
pub(super) struct KernelLine(Request);

impl KernelLine {
    pub(super) fn open(chip: &str, line: u32) -> gpiocdev::Result<Self> {
        let mut builder = Request::builder();
        builder.on_chip(chip).with_consumer(CONSUMER).with_line(line).as_output(Value::Active);
        builder.request().map(Self)
    }

    fn set(&self, value: Value) -> Result<(), ErrorKind> {
        self.0.set_lone_value(value).map_err(|_| ErrorKind::Other)
    }
}

impl ErrorType for KernelLine {
    type Error = ErrorKind;
}

impl OutputPin for KernelLine {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        self.set(Value::Inactive)
    }

    fn set_high(&mut self) -> Result<(), ErrorKind> {
        self.set(Value::Active)
    }
}

#[cfg(test)]
mod tests {
    use super::{KernelEdges, KernelLine};
    use crate::bench::Monotonic;

    #[test]
    fn a_chip_that_is_none_is_an_error_and_no_panic() {
        assert!(KernelLine::open("/dev/null", 17).is_err());
        assert!(KernelEdges::open("/dev/no-gpiochip", 17, Monotonic::start()).is_err());
    }
}
