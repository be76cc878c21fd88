//! The picture of a measurement: the flight above, the result below, as SVG.

use crate::analysis::measurement::Found;
use crate::analysis::step_response::Step;
use crate::report::kit::palette::{NOMINAL, RECORDED, SETPOINT};
use crate::report::kit::plot::{Diagram, Line, PlotError, commanded, drawn, panel, recorded, write};
use diagnose::Recording;
use diagnose::measure::Estimate;
use diagnose::measure::critical::Swing;
use diagnose::measure::dead_zone::DeadZone;
use diagnose::measure::jumps::Jumps;
use std::path::Path;

/// Size of the picture, pixels.
const SIZE: (u32, u32) = (1100, 800);
/// Visible time of a step, seconds.
const STEP_S: f64 = 6.0;

/// Draws a measurement.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn draw(path: &Path, recording: &Recording, found: &Found) -> Result<(), PlotError> {
    let (flight, result) = (flight(recording), result(recording, found));
    let svg = drawn(SIZE, |area| {
        let (upper, lower) = area.split_vertically(area.dim_in_pixel().1 / 2);
        panel(&upper, &flight)?;
        panel(&lower, &result)
    })?;
    write(path, &svg)
}

/// Setpoint and position over the flight.
pub fn flight(recording: &Recording) -> Diagram {
    let lines = vec![commanded(recording), Line { label: "position", ..recorded(recording) }];
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}

/// The result.
pub fn result(recording: &Recording, found: &Found) -> Diagram {
    match found {
        Found::DeadZone { zone, jumps } | Found::ForceCurve { zone, jumps } => forces(zone, jumps),
        Found::CriticalGain(found) => {
            let over = ("growth rate of the oscillation over the gain", "K_p, % per mm", "critical gain, 90 %");
            growths(&found.swings, |swing| swing.kp_per_mm, found.kp_per_mm, over)
        }
        Found::CriticalTime(found) => {
            let over = ("growth rate of the oscillation over the integral time", "T_i, s", "critical time, 90 %");
            growths(&found.swings, |swing| swing.ti_s, found.ti_s, over)
        }
        Found::Steps(steps) => overlaid(recording, &steps.each),
        Found::NoiseFloor(_) | Found::Calibration(_) => histogram(recording),
    }
}

/// Force over duty: each jump a cross, and the lines from the edges.
fn forces(zone: &DeadZone, jumps: &Jumps) -> Diagram {
    let duties = || jumps.jumps.iter().map(|jump| jump.duty_percent);
    let (lowest, highest) = (duties().fold(f64::INFINITY, f64::min), duties().fold(f64::NEG_INFINITY, f64::max));
    let (lower, upper) = (zone.lower_duty_percent.value, zone.upper_duty_percent.value);
    let fit = vec![
        (lowest, zone.gain_below.value * (lowest - lower)),
        (lower, 0.0),
        (upper, 0.0),
        (highest, zone.gain_above.value * (highest - upper)),
    ];
    Diagram {
        title: "force over duty".into(),
        abscissa: "duty, %",
        ordinate: "force, mm/s²",
        lines: vec![Line { label: "from the edges", colour: SETPOINT, points: fit }],
        marks: jumps.jumps.iter().map(|jump| (jump.duty_percent, jump.mm_per_s2.value)).collect(),
        ..Diagram::default()
    }
}

/// Growth of the oscillation over what was varied, critical where it crosses zero.
fn growths(
    swings: &[Swing],
    varied: fn(&Swing) -> f64,
    critical: Estimate,
    (title, abscissa, interval_of): (&str, &'static str, &'static str),
) -> Diagram {
    let mut points: Vec<(f64, f64)> = swings.iter().map(|swing| (varied(swing), swing.growth_per_s)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ends = |value: f64| points.first().zip(points.last()).map_or(vec![], |(a, b)| vec![(a.0, value), (b.0, value)]);
    let interval = vec![(critical.low, 0.0), (critical.high, 0.0)];
    Diagram {
        title: title.into(),
        abscissa,
        ordinate: "growth, 1/s",
        lines: vec![
            Line { label: "marginally stable", colour: SETPOINT, points: ends(0.0) },
            Line { label: interval_of, colour: NOMINAL, points: interval },
        ],
        marks: points,
        ..Diagram::default()
    }
}

/// Every step over its own time, as a share of its jump.
fn overlaid(recording: &Recording, steps: &[Step]) -> Diagram {
    let mut points = Vec::new();
    for step in steps {
        let jump = step.to_mm - step.from_mm;
        let own = |row: &diagnose::Sample| Some((row.time_s - step.time_s, (row.position_mm? - step.from_mm) / jump));
        let shown = recording.samples().iter().filter_map(own).filter(|(t, _)| (0.0..STEP_S).contains(t));
        points.extend(shown);
        points.push((f64::NAN, f64::NAN));
    }
    let reached = Line { label: "setpoint", colour: SETPOINT, points: vec![(0.0, 1.0), (STEP_S, 1.0)] };
    Diagram {
        title: "steps".into(),
        abscissa: "time since the step, s",
        ordinate: "share of the jump",
        lines: vec![reached, Line { label: "position", colour: RECORDED, points }],
        ..Diagram::default()
    }
}

/// Histogram of the readings, to whole millimetres.
fn histogram(recording: &Recording) -> Diagram {
    let mut counts = std::collections::BTreeMap::<i64, f64>::new();
    for reading in recording.samples().iter().filter_map(|row| row.position_mm) {
        #[expect(clippy::cast_possible_truncation, reason = "no pipe is longer than i64 millimetres")]
        let millimetre = reading.round() as i64;
        *counts.entry(millimetre).or_default() += 1.0;
    }
    #[expect(clippy::cast_precision_loss, reason = "millimetres of a pipe")]
    let points = counts.into_iter().map(|(mm, count)| (mm as f64, count)).collect();
    Diagram {
        title: "how often each reading came".into(),
        abscissa: "position, mm",
        ordinate: "readings",
        lines: vec![Line { label: "readings", colour: RECORDED, points }],
        ..Diagram::default()
    }
}
