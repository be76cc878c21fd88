//! The lines besides the bus: GPIO of the kernel, or those of an emulated rig.

use super::clock::Monotonic;
use super::error::BenchError;
use super::gpio::{KernelEdges, KernelLine};
use super::socket_lines::{Line, SocketEdges, SocketLine};
use crate::config;
use embedded_hal::digital::{ErrorKind, OutputPin};
use hal::Edges;
use hal::emulator::{EmulatedBus, World};
use std::path::Path;

/// A line that the rig drives.
pub type Pin = Box<dyn OutputPin<Error = ErrorKind>>;

/// The lines of the tables of `[rig]`.
#[derive(Default)]
pub struct Lines {
    /// Edges of the fan's tachometer.
    pub edges: Option<Box<dyn Edges>>,
    /// XSHUT of the second sensor.
    pub xshut: Option<Pin>,
    /// Output-enable of the fan driver, high: its outputs are off.
    pub output_enable: Option<Pin>,
}

impl Lines {
    /// Requests the lines of the bench.
    ///
    /// # Errors
    /// [`BenchError::Line`] names the line and its table.
    pub(super) fn of_bench(bus: &config::Bus, rig: &config::Rig, clock: Monotonic) -> Result<Self, BenchError> {
        let edges = rig.tachometer.map(|tachometer| -> Result<Box<dyn Edges>, BenchError> {
            let refused = refused(&rig.gpio_chip, tachometer.line, "rig.tachometer");
            Ok(match bus.socket() {
                Some(path) => Box::new(SocketEdges::open(Path::new(path), clock).map_err(|e| refused(e.into()))?),
                None => {
                    Box::new(KernelEdges::open(&rig.gpio_chip, tachometer.line, clock).map_err(|e| refused(e.into()))?)
                }
            })
        });
        let xshut = rig.second_sensor.map(|second| {
            pin(bus, &rig.gpio_chip, second.xshut_line, Line::Xshut).map_err(refused(
                &rig.gpio_chip,
                second.xshut_line,
                "rig.second_sensor",
            ))
        });
        let output_enable = rig.output_enable.map(|enable| output_enable(bus, &rig.gpio_chip, enable.line));
        Ok(Self { edges: edges.transpose()?, xshut: xshut.transpose()?, output_enable: output_enable.transpose()? })
    }

    /// The lines of an emulated rig.
    pub(super) fn emulated<W: World + 'static>(bus: &EmulatedBus<W>, rig: &config::Rig) -> Self {
        Self {
            edges: rig.tachometer.map(|_| Box::new(bus.edges()) as Box<dyn Edges>),
            xshut: rig.second_sensor.map(|_| Box::new(bus.xshut()) as Pin),
            output_enable: rig.output_enable.map(|_| Box::new(bus.output_enable()) as Pin),
        }
    }
}

/// Requests the line of output-enable, high: the outputs are off from then on.
///
/// # Errors
/// [`BenchError::Line`]: mostly that the loop still holds it.
pub(super) fn output_enable(bus: &config::Bus, chip: &str, line: u32) -> Result<Pin, BenchError> {
    pin(bus, chip, line, Line::OutputEnable).map_err(refused(chip, line, "rig.output_enable"))
}

type Cause = Box<dyn std::error::Error + Send + Sync>;

fn pin(bus: &config::Bus, chip: &str, line: u32, role: Line) -> Result<Pin, Cause> {
    Ok(match bus.socket() {
        Some(path) => Box::new(SocketLine::open(Path::new(path), role)?),
        None => Box::new(KernelLine::open(chip, line)?),
    })
}

fn refused(chip: &str, line: u32, table: &'static str) -> impl Fn(Cause) -> BenchError {
    let chip = chip.to_owned();
    move |source| BenchError::Line { chip: chip.clone(), line, table, source }
}
