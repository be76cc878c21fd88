//! The second range sensor: started with the first, with its own address by its XSHUT.

use super::Sighting;
use super::lines::Pin;
use super::range::{BEYOND_PIPE_MM, START_ALLOWED_S, kind};
use control::Millimetres;
use embedded_hal::i2c::{ErrorKind, I2c};
use hal::{Clock, Range, RangeError, RangeSensor, SeparateError, separate};

/// The sensor, its direction, and the line that keeps it out of reset.
pub(super) struct Second<S: I2c, C: Clock> {
    sensor: RangeSensor<S, C>,
    table: config::SecondSensor,
    pipe_mm: f64,
    _xshut: Pin,
}

/// A second sensor that has its own address and is not started yet.
pub(super) struct Apart<S> {
    bus: S,
    table: config::SecondSensor,
    xshut: Pin,
}

impl<S: I2c> Apart<S> {
    /// Leaves the first sensor at its address and moves the second to its own.
    pub(super) fn of(
        mut bus: S,
        table: config::SecondSensor,
        mut xshut: Pin,
        clock: &impl Clock,
    ) -> Result<Self, SeparateError<S::Error>> {
        separate(&mut bus, &mut xshut.as_mut(), clock, table.address)?;
        Ok(Self { bus, table, xshut })
    }

    /// Starts it, and begins ranging.
    pub(super) fn start<C: Clock + Clone>(self, clock: C, pipe_mm: f64) -> Result<Second<S, C>, RangeError<S::Error>> {
        let Self { bus, table, xshut } = self;
        let mut sensor = RangeSensor::prepare_at(table.address, bus, clock, START_ALLOWED_S)?;
        sensor.range(START_ALLOWED_S)?;
        Ok(Second { sensor, table, pipe_mm, _xshut: xshut })
    }
}

impl<S: I2c, C: Clock + Clone> Second<S, C> {
    /// Reads it, without waiting.
    pub(super) fn position(&mut self) -> Result<Sighting, ErrorKind> {
        Ok(match self.sensor.poll().map_err(kind)? {
            None => Sighting::NotReady,
            Some(Range::NoTarget { reported_mm }) => Sighting::NoBall { reported_mm },
            Some(Range::Doubtful { status, reported_mm }) => Sighting::Doubtful { status, reported_mm },
            Some(Range::Distance(Millimetres(reported))) => {
                let position_mm = self.table.position_mm(reported);
                if (-BEYOND_PIPE_MM..=self.pipe_mm + BEYOND_PIPE_MM).contains(&position_mm) {
                    Sighting::Ball(Millimetres(position_mm))
                } else {
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it came from a u16")]
                    Sighting::NoBall { reported_mm: reported as u16 }
                }
            }
        })
    }
}
