//! The picture of a flight: positions above duties.

use crate::flight::vocabulary::Cycle;
use crate::report::kit::palette::{DUTY, NOMINAL, RECORDED, SETPOINT};
use crate::report::kit::plot::{Line, PlotError, SIZE, draw};
use plotters::style::RGBColor;
use std::path::Path;

/// Size of a picture for a page of the gallery, pixels.
const SMALL: (u32, u32) = (700, 420);

/// Draws a flight: setpoint, position and duty.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn flight(path: &Path, title: &str, cycles: &[Cycle]) -> Result<(), PlotError> {
    let position = vec![
        over_cycles(cycles, "setpoint", SETPOINT, |c| c.setpoint_mm),
        over_cycles(cycles, "position", RECORDED, |c| c.position_mm),
    ];
    draw(path, SIZE, title, position, vec![over_cycles(cycles, "", DUTY, |c| Some(c.duty_percent))])
}

/// Draws one experiment on two rigs: with an effect, and without it.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn two_flights(path: &Path, with: &[Cycle], without: &[Cycle]) -> Result<(), PlotError> {
    let position = vec![
        over_cycles(with, "setpoint", SETPOINT, |c| c.setpoint_mm),
        over_cycles(without, "without it", NOMINAL, |c| c.position_mm),
        over_cycles(with, "with it", RECORDED, |c| c.position_mm),
    ];
    let duty = |cycles, colour| over_cycles(cycles, "", colour, |c: &Cycle| Some(c.duty_percent));
    draw(path, SMALL, "", position, vec![duty(without, NOMINAL), duty(with, RECORDED)])
}

fn over_cycles(cycles: &[Cycle], label: &'static str, colour: RGBColor, value: fn(&Cycle) -> Option<f64>) -> Line {
    let points = cycles.iter().map(|cycle| (cycle.time_s, value(cycle).unwrap_or(f64::NAN))).collect();
    Line { label, colour, points }
}
