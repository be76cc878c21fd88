//! Pictures as SVG: the signal path over time, position above duty; and what a [`diagnosis`](fn@diagnosis) found.

mod legend;
mod panel;
mod thinned;

pub use panel::{Diagram, Line, Panel, drawn, failed, panel, shapes};

use super::palette::{DUTY, NOMINAL, RECORDED, SETPOINT};
use crate::flight::vocabulary::Cycle;
use diagnose::{FreeRun, Recording};
use plotters::style::RGBColor;
use std::path::{Path, PathBuf};

/// Size of a picture, pixels, and of one for a page of the gallery; and the part of its height that shows the position.
const SIZE: (u32, u32) = (1100, 620);
const SMALL: (u32, u32) = (700, 420);
const POSITION_PERCENT: u32 = 68;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file cannot be written.
    #[error("cannot write the picture {}: {source}; check the folder of --plot", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Something that is no picture has this name.
    #[error("{} exists and is no SVG picture; it is kept: give --plot another name", path.display())]
    Taken {
        /// The file.
        path: PathBuf,
    },
    /// The plotting library failed.
    #[error("cannot draw the picture: {0}; please report it with the log")]
    Draw(String),
    /// Nothing to draw.
    #[error("the log has no position to draw; fly for longer than a second")]
    Nothing,
}

/// Refuses a name for a picture that something else has: a config, a log, a record. An older picture may be replaced.
///
/// # Errors
/// [`PlotError::Taken`] names the file.
pub fn may_write(path: &Path) -> Result<(), PlotError> {
    match std::fs::read(path) {
        Ok(bytes) if !bytes.starts_with(b"<svg") => Err(PlotError::Taken { path: path.to_owned() }),
        _ => Ok(()),
    }
}

/// Draws a flight: setpoint, position and duty.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn flight(path: &Path, title: &str, cycles: &[Cycle]) -> Result<(), PlotError> {
    let position = [
        over_cycles(cycles, "setpoint", SETPOINT, |c| c.setpoint_mm),
        over_cycles(cycles, "position", RECORDED, |c| c.position_mm),
    ];
    draw(path, SIZE, title, &position, &[over_cycles(cycles, "", DUTY, |c| Some(c.duty_percent))])
}

/// Draws one experiment on two rigs: with an effect, and without it.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn two_flights(path: &Path, with: &[Cycle], without: &[Cycle]) -> Result<(), PlotError> {
    let position = [
        over_cycles(with, "setpoint", SETPOINT, |c| c.setpoint_mm),
        over_cycles(without, "without it", NOMINAL, |c| c.position_mm),
        over_cycles(with, "with it", RECORDED, |c| c.position_mm),
    ];
    let duty = |cycles, colour| over_cycles(cycles, "", colour, |c: &Cycle| Some(c.duty_percent));
    draw(path, SMALL, "", &position, &[duty(without, NOMINAL), duty(with, RECORDED)])
}

fn over_cycles(cycles: &[Cycle], label: &'static str, colour: RGBColor, value: fn(&Cycle) -> Option<f64>) -> Line {
    let points = cycles.iter().map(|cycle| (cycle.time_s, value(cycle).unwrap_or(f64::NAN))).collect();
    Line { label, colour, points }
}

/// Draws a replay: the recorded position, the model's free runs from every 10 s, and the duty.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn replay(path: &Path, title: &str, recording: &Recording, runs: &[FreeRun]) -> Result<(), PlotError> {
    let samples = recording.samples();
    let forecast = forecasts("model, free from every 10 s", NOMINAL, recording, runs);
    let position = [recorded(recording), forecast];
    let duty = samples.iter().map(|s| (s.time_s, s.duty_percent)).collect();
    draw(path, SIZE, title, &position, &[Line { label: "", colour: DUTY, points: duty }])
}

/// Recorded positions, and the free runs of a model.
pub fn free_runs_of(recording: &Recording, runs: &[FreeRun]) -> Diagram {
    let lines = vec![recorded(recording), forecasts("simulator", NOMINAL, recording, runs)];
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}

/// The setpoint, where the log has one.
pub fn commanded(recording: &Recording) -> Line {
    let rows = recording.samples().iter();
    let points = rows.map(|row| (row.time_s, row.setpoint_mm.unwrap_or(f64::NAN))).collect();
    Line {
        label: if recording.samples().iter().any(|row| row.setpoint_mm.is_some()) { "setpoint" } else { "" },
        colour: SETPOINT,
        points,
    }
}

/// The duty.
pub fn duty(recording: &Recording) -> Diagram {
    let points = recording.samples().iter().map(|row| (row.time_s, row.duty_percent)).collect();
    let lines = vec![Line { label: "", colour: DUTY, points }];
    Diagram { abscissa: "time, s", ordinate: "duty, %", lines, ..Diagram::default() }
}

/// The readings.
pub fn recorded(recording: &Recording) -> Line {
    let points = recording.samples().iter().filter_map(|s| Some((s.time_s, s.position_mm?))).collect();
    Line { label: "recorded", colour: RECORDED, points }
}

/// Free runs as one line, broken between them.
pub fn forecasts(label: &'static str, colour: RGBColor, recording: &Recording, runs: &[FreeRun]) -> Line {
    let samples = recording.samples();
    let mut points = Vec::new();
    for run in runs {
        points.extend(run.forecasts.iter().map(|f| (samples[f.row].time_s, f.position_mm)));
        points.push((f64::NAN, f64::NAN));
    }
    Line { label, colour, points }
}

fn draw(path: &Path, size: (u32, u32), title: &str, position: &[Line], duty: &[Line]) -> Result<(), PlotError> {
    let svg = drawn(size, |area| {
        let (upper, lower) = area.split_vertically(area.dim_in_pixel().1 * POSITION_PERCENT / 100);
        let over_time = Panel { abscissa: "time, s", ..Panel::default() };
        panel(&upper, Panel { title, ordinate: "position, mm", lines: position, ..over_time })?;
        panel(&lower, Panel { ordinate: "duty, %", lines: duty, ..over_time })
    })?;
    write(path, &svg)
}

/// Writes a picture, unless something that is none has its name.
pub fn write(path: &Path, svg: &str) -> Result<(), PlotError> {
    may_write(path)?;
    std::fs::write(path, svg).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}
