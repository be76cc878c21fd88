//! Pictures as SVG: diagrams, and the lines of a record that many of them show.

mod diagram;
mod legend;
mod panel;
mod phase;
mod thinned;

pub use diagram::{Diagram, Line, Timeline};
pub use panel::{drawn, failed, panel, shapes, titled};
pub use phase::{nearest, unwrapped};
pub use thinned::extremes;

use super::palette::{DUTY, RECORDED, SETPOINT};
use crate::files;
use diagnose::{FreeRun, Recording};
use plotters::style::RGBColor;
use std::path::{Path, PathBuf};

/// Size of a picture of a flight, pixels, and the height of the part that shows the position.
pub const SIZE: (u32, u32) = (1100, 620);
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
    /// A file of this name exists and is not a picture.
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

/// Refuses a picture's name that another file has: a config, a log, a record; and a folder that cannot take it. An
/// older picture may be replaced.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn may_write(path: &Path) -> Result<(), PlotError> {
    match std::fs::read(path) {
        Ok(bytes) if !bytes.starts_with(b"<svg") => Err(PlotError::Taken { path: path.to_owned() }),
        _ => files::may_be_made(path).map_err(|source| PlotError::Write { path: path.to_owned(), source }),
    }
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

/// Draws positions above duties, over time.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn draw(path: &Path, size: (u32, u32), title: &str, position: Vec<Line>, duty: Vec<Line>) -> Result<(), PlotError> {
    let over_time = |ordinate, lines| Diagram { abscissa: "time, s", ordinate, lines, ..Diagram::default() };
    let (position, duty) = (over_time("position, mm", position), over_time("duty, %", duty));
    let svg = drawn(size, |area| {
        let (upper, lower) = area.split_vertically(area.dim_in_pixel().1 * POSITION_PERCENT / 100);
        titled(&upper, title, &position)?;
        panel(&lower, &duty)
    })?;
    write(path, &svg)
}

/// Writes a picture, unless another kind of file has its name.
pub fn write(path: &Path, svg: &str) -> Result<(), PlotError> {
    may_write(path)?;
    files::write(path, svg.as_bytes()).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}
