//! The lines besides the bus: GPIO of the kernel, or those of `airball emulate`.

use super::clock::Monotonic;
use super::error::BenchError;
use super::gpio::{KernelEdges, KernelLine};
use super::socket_lines::{Line, SocketEdges, SocketLine};
use hal::Edges;
use rig::{Lines, Pin};
use std::path::Path;

/// Requests the lines of the tables of `[rig]`.
///
/// # Errors
/// [`BenchError::Line`] names the line and its table.
pub(super) fn lines(bus: &config::Bus, rig: &config::Rig, clock: Monotonic) -> Result<Lines, BenchError> {
    let edges = rig.tachometer.map(|tachometer| -> Result<Box<dyn Edges>, BenchError> {
        let refused = refused(&rig.gpio_chip, tachometer.line, "rig.tachometer");
        Ok(match bus.socket() {
            Some(path) => Box::new(SocketEdges::open(Path::new(path), clock).map_err(|e| refused(e.into()))?),
            None => Box::new(KernelEdges::open(&rig.gpio_chip, tachometer.line, clock).map_err(|e| refused(e.into()))?),
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
    Ok(Lines { edges: edges.transpose()?, xshut: xshut.transpose()?, output_enable: output_enable.transpose()? })
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
