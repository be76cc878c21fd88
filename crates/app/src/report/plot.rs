//! Pictures as SVG: the signal path over time, position above duty; and what a [`diagnosis`](fn@diagnosis) found.

mod diagnosis;
pub mod identify;

pub use diagnosis::diagnosis;

use crate::log::record::Cycle;
use diagnose::{FreeRun, Recording};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::path::{Path, PathBuf};

/// The same colours for the same signals in every picture.
pub(super) const SETPOINT: RGBColor = RGBColor(0x88, 0x88, 0x88);
pub(super) const RECORDED: RGBColor = RGBColor(0x1f, 0x77, 0xb4);
pub(super) const NOMINAL: RGBColor = RGBColor(0xd6, 0x27, 0x28);
const DUTY: RGBColor = RGBColor(0x2c, 0x7a, 0x2c);
const MENDED: RGBColor = RGBColor(0x2c, 0xa0, 0x2c);
const FORCE: RGBColor = RGBColor(0x7b, 0x3f, 0xa0);
const SHADE: RGBColor = RGBColor(0xff, 0xb3, 0x47);

/// Size of a picture, pixels, and the part of its height that shows the position.
const SIZE: (u32, u32) = (1100, 620);
const POSITION_SHARE: f64 = 0.68;
/// Points that a line is drawn with at most: more cannot be seen.
const MOST_POINTS: usize = 4000;

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

/// A line of a picture.
pub(super) struct Line {
    pub(super) label: &'static str,
    pub(super) colour: RGBColor,
    /// Abscissa, usually the time in s, and value. NaN breaks the line.
    pub(super) points: Vec<(f64, f64)>,
}

/// One of the diagrams of a picture.
#[derive(Clone, Copy, Default)]
pub(super) struct Panel<'a> {
    pub(super) title: &'a str,
    pub(super) abscissa: &'a str,
    pub(super) ordinate: &'a str,
    pub(super) lines: &'a [Line],
    /// Crosses.
    pub(super) marks: &'a [(f64, f64)],
    /// Outline of a band about the first line.
    pub(super) band: &'a [(f64, f64)],
    /// Stretches of the abscissa to be pointed out.
    pub(super) shaded: &'a [(f64, f64)],
}

/// Draws a flight: setpoint, position and duty.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn flight(path: &Path, title: &str, cycles: &[Cycle]) -> Result<(), PlotError> {
    let line = |label, colour, value: fn(&Cycle) -> Option<f64>| {
        let points = cycles.iter().map(|cycle| (cycle.time_s, value(cycle).unwrap_or(f64::NAN))).collect();
        Line { label, colour, points }
    };
    let position = [line("setpoint", SETPOINT, |c| c.setpoint_mm), line("position", RECORDED, |c| c.position_mm)];
    draw(path, title, &position, &line("duty", DUTY, |cycle| Some(cycle.duty_percent)))
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
    draw(path, title, &position, &Line { label: "duty", colour: DUTY, points: duty })
}

fn recorded(recording: &Recording) -> Line {
    let points = recording.samples().iter().filter_map(|s| Some((s.time_s, s.position_mm?))).collect();
    Line { label: "recorded", colour: RECORDED, points }
}

/// Free runs as one line, broken between them.
fn forecasts(label: &'static str, colour: RGBColor, recording: &Recording, runs: &[FreeRun]) -> Line {
    let samples = recording.samples();
    let mut points = Vec::new();
    for run in runs {
        points.extend(run.forecasts.iter().map(|f| (samples[f.row].time_s, f.position_mm)));
        points.push((f64::NAN, f64::NAN));
    }
    Line { label, colour, points }
}

fn draw(path: &Path, title: &str, position: &[Line], duty: &Line) -> Result<(), PlotError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(failed)?;
        let (upper, lower) = area.split_vertically(f64::from(SIZE.1) * POSITION_SHARE);
        let over_time = Panel { abscissa: "time, s", ..Panel::default() };
        panel(&upper, Panel { title, ordinate: "position, mm", lines: position, ..over_time })?;
        panel(&lower, Panel { ordinate: "duty, %", lines: std::slice::from_ref(duty), ..over_time })?;
        area.present().map_err(failed)?;
    }
    write(path, &svg)
}

/// Writes a picture, unless something that is none has its name.
pub(super) fn write(path: &Path, svg: &str) -> Result<(), PlotError> {
    may_write(path)?;
    std::fs::write(path, svg).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws one diagram.
pub(super) fn panel(area: &Area<'_>, panel: Panel<'_>) -> Result<(), PlotError> {
    let points = || {
        panel
            .lines
            .iter()
            .flat_map(|line| &line.points)
            .chain(panel.band)
            .chain(panel.marks)
            .filter(|(t, y)| is_there(*t, *y))
    };
    let (times, values) = (range(points().map(|p| p.0))?, padded(range(points().map(|p| p.1))?));
    let mut chart = ChartBuilder::on(area);
    chart.margin(12).x_label_area_size(38).y_label_area_size(58);
    if !panel.title.is_empty() {
        chart.caption(panel.title, ("sans-serif", 18));
    }
    let mut chart = chart.build_cartesian_2d(times.0..times.1, values.clone()).map_err(failed)?;
    let shade = |&(from, to): &(f64, f64)| {
        Rectangle::new([(from.max(times.0), values.start), (to.min(times.1), values.end)], SHADE.mix(0.25).filled())
    };
    chart.draw_series(panel.shaded.iter().map(shade)).map_err(failed)?;
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(panel.abscissa).y_desc(panel.ordinate).light_line_style(WHITE.mix(0.0)).draw().map_err(failed)?;
    if let Some(line) = panel.lines.first().filter(|_| !panel.band.is_empty()) {
        let outline = Polygon::new(panel.band.to_vec(), line.colour.mix(0.25).filled());
        chart.draw_series([outline]).map_err(failed)?;
    }
    for line in panel.lines {
        let colour = line.colour;
        for piece in line.points.split(|(t, y)| !is_there(*t, *y)) {
            chart.draw_series(LineSeries::new(thinned(piece), colour.stroke_width(2))).map_err(failed)?;
        }
        // The label belongs to a series of its own: a line may be in several pieces.
        let labelled = chart.draw_series(LineSeries::new([], colour)).map_err(failed)?;
        labelled
            .label(line.label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
    }
    let cross = |at: &(f64, f64)| Cross::new(*at, 6, NOMINAL.stroke_width(2));
    chart.draw_series(panel.marks.iter().map(cross)).map_err(failed)?;
    let mut labels = chart.configure_series_labels();
    labels.position(SeriesLabelPosition::LowerRight).background_style(WHITE.mix(0.85));
    labels.border_style(RGBColor(0xcc, 0xcc, 0xcc)).draw().map_err(failed)
}

fn is_there(t: f64, y: f64) -> bool {
    t.is_finite() && y.is_finite()
}

/// A line with at most about [`MOST_POINTS`] points: the lowest and the highest of each stretch, so that no peak is lost.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil(MOST_POINTS / 2);
    let extremes = |piece: &[(f64, f64)]| {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let mut both: Vec<(f64, f64)> =
            piece.iter().min_by(by_value).into_iter().chain(piece.iter().max_by(by_value)).copied().collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        both
    };
    points.chunks(stretch).flat_map(extremes).collect()
}

fn range(values: impl Iterator<Item = f64>) -> Result<(f64, f64), PlotError> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { Ok((low, high.max(low + 1e-9))) } else { Err(PlotError::Nothing) }
}

fn padded((low, high): (f64, f64)) -> std::ops::Range<f64> {
    let pad = 0.05 * (high - low).max(1e-6);
    low - pad..high + pad
}

pub(super) fn failed(error: impl std::fmt::Display) -> PlotError {
    PlotError::Draw(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::{MOST_POINTS, thinned};

    #[test]
    fn a_thinned_line_keeps_its_peaks_and_its_order() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|k| (f64::from(k), 0.0)).collect();
        points[54_321].1 = 9.0;
        points[65_432].1 = -9.0;
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS + 2, "{}", thin.len());
        assert!(thin.contains(&(54_321.0, 9.0)) && thin.contains(&(65_432.0, -9.0)));
        assert!(thin.is_sorted_by_key(|p| p.0));
    }
}
