//! A measurement in words and as JSON.

use super::table::empty;
use crate::cli::Measurement;
use crate::config::Tables;
use crate::measured::{Calibration, Found, Steps};
use anyhow::Result;
use clap::ValueEnum;
use diagnose::measure::Estimate;
use diagnose::measure::critical::Critical;
use diagnose::measure::dead_zone::DeadZone;
use diagnose::measure::jumps::Jumps;
use diagnose::measure::noise_floor::NoiseFloor;
use serde::Serialize;
use std::path::Path;

/// The document of `airball measure --json`.
#[derive(Debug, Serialize)]
pub struct Document<'a> {
    /// Name and version of this document.
    pub schema: &'static str,
    /// What was measured.
    pub what: String,
    /// What was found.
    pub found: &'a Found,
    /// The log that it was found in.
    pub log: String,
    /// The same as a config patch.
    pub config_patch: Option<&'a str>,
}

/// The document of a measurement.
///
/// # Errors
/// None in practice: every measurement has a name.
pub fn document<'a>(what: Measurement, found: &'a Found, log: &Path, patch: Option<&'a str>) -> Result<Document<'a>> {
    let what = what.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    Ok(Document { schema: "airball.measure/1", what, found, log: log.display().to_string(), config_patch: patch })
}

/// A line of the table.
struct Row {
    name: String,
    measured: Option<Estimate>,
    digits: usize,
    unit: &'static str,
    believed: Option<f64>,
}

fn row(name: &str, measured: Option<Estimate>, digits: usize, unit: &'static str, believed: Option<f64>) -> Row {
    Row { name: name.into(), measured, digits, unit, believed }
}

/// The measurement as a table beside what the config believes, and a line or two.
#[must_use]
pub fn words(found: &Found, tables: &Tables) -> Vec<String> {
    match found {
        Found::DeadZone { zone, jumps } => {
            vec![table(&rows_of_zone(zone, jumps, tables)), verdict_of_zone(zone, jumps), given(jumps)]
        }
        Found::ForceCurve { zone, jumps } => {
            vec![forces(jumps), table(&rows_of_zone(zone, jumps, tables)), given(jumps)]
        }
        Found::CriticalGain(critical) => words_of_gain(critical),
        Found::Steps(steps) => words_of_steps(steps),
        Found::NoiseFloor(floor) => words_of_floor(floor, tables),
        Found::Calibration(calibration) => words_of_calibration(calibration, tables),
    }
}

fn rows_of_zone(zone: &DeadZone, jumps: &Jumps, tables: &Tables) -> Vec<Row> {
    let model = tables.plant.as_ref();
    let edge = |pick: fn(&plant::effects::DeadZone) -> f64| {
        model.map(|model| model.hover_duty_percent + model.effects.dead_zone.as_ref().map_or(0.0, pick))
    };
    let gain = model.map(|model| model.gain_mm_per_s2_per_percent);
    let lag = model.map(|model| model.effects.fan_lag.map_or(0.0, |lag| lag.time_constant_s));
    vec![
        row("the ball falls below a duty of", Some(zone.lower_duty_percent), 3, " %", edge(|zone| zone.lower_percent)),
        row("the ball rises above a duty of", Some(zone.upper_duty_percent), 3, " %", edge(|zone| zone.upper_percent)),
        row("force below, mm/s² per percent", Some(zone.gain_below), 0, "", gain),
        row("force above, mm/s² per percent", Some(zone.gain_above), 0, "", gain),
        row("lag of the fan", Some(jumps.lag_s), 3, " s", lag),
    ]
}

fn verdict_of_zone(zone: &DeadZone, jumps: &Jumps) -> String {
    let (lower, upper) = (zone.lower_duty_percent, zone.upper_duty_percent);
    let (width, count) = (upper.value - lower.value, jumps.jumps.len());
    if upper.low > lower.high {
        format!("A dead zone of {width:.3} %, by {count} jumps; which duty within it is called hover is a choice.")
    } else {
        format!(
            "No dead zone beyond doubt: by {count} jumps the edges lie {width:.3} % apart, and their intervals meet."
        )
    }
}

fn given(jumps: &Jumps) -> String {
    format!("The forces are those of a ball with the config's drag, {} 1/s.", jumps.drag_per_s)
}

/// The force curve, by rising duty.
fn forces(jumps: &Jumps) -> String {
    let mut table = empty(["duty", "jump", "time", "force", "90 % interval", "without the fan's lag"]);
    let mut sorted = jumps.jumps.clone();
    sorted.sort_by(|a, b| a.duty_percent.total_cmp(&b.duty_percent));
    for jump in sorted {
        let Estimate { value, low, high } = jump.mm_per_s2;
        table.add_row([
            format!("{:.2} %", jump.duty_percent),
            format!("{:.0} mm", jump.to_mm - jump.from_mm),
            format!("{:.2} s", jump.time_s),
            format!("{value:.0} mm/s²"),
            format!("{low:.0} to {high:.0}"),
            jump.timed_mm_per_s2.map_or_else(String::new, |timed| format!("{timed:.0}")),
        ]);
    }
    table.to_string()
}

fn words_of_gain(found: &Critical) -> Vec<String> {
    let mut swings = empty(["step at", "K_p", "growth", "frequency"]);
    for swing in &found.swings {
        swings.add_row([
            format!("{:.0} s", swing.time_s),
            format!("{:.5} per mm", swing.kp_per_mm),
            format!("{:+.3} 1/s", swing.growth_per_s),
            format!("{:.2} rad/s", swing.omega),
        ]);
    }
    let Estimate { value, low, high } = found.kp_per_mm;
    let (ti_s, omega) = (found.ti_s, found.omega);
    vec![
        swings.to_string(),
        format!(
            "critical gain {value:.5} per mm ({low:.5} to {high:.5}) at T_i = {ti_s:.1} s without derivative, swinging at {omega:.2} rad/s"
        ),
    ]
}

fn words_of_steps(steps: &Steps) -> Vec<String> {
    let rows = [
        row("overshoot", steps.overshoot_percent, 1, " %", None),
        row("first peak", steps.peak_s, 2, " s", None),
        row("settled to ±5 %", steps.settling_s, 2, " s", None),
    ];
    let mut table = empty(["mean of the steps", "measured", "90 % interval"]);
    for Row { name, measured, digits, unit, .. } in rows {
        let [value, interval] = measured.map_or(["too few".into(), String::new()], |m| said(m, digits, unit));
        table.add_row([name, value, interval]);
    }
    vec![table.to_string(), format!("{} steps, of which {} settled before the next.", steps.steps, steps.settled)]
}

fn words_of_floor(floor: &NoiseFloor, tables: &Tables) -> Vec<String> {
    let believed = tables.plant.as_ref().map(|model| {
        model.effects.sensor_noise.map_or(model.noise.sensor_mm, |more| model.noise.sensor_mm.hypot(more.sigma_mm))
    });
    let NoiseFloor { correlation, resolution_mm, readings, wild, .. } = floor;
    vec![
        table(&[
            row("noise of a reading, 1σ", Some(floor.sensor_mm), 3, " mm", believed),
            row("drift", Some(floor.drift_mm_per_s), 4, " mm/s", None),
        ]),
        format!(
            "{readings} readings at rest, {wild} wild ones left out; steps of {resolution_mm:.2} mm, correlation of neighbours {correlation:+.3}."
        ),
    ]
}

fn words_of_calibration(found: &Calibration, tables: &Tables) -> Vec<String> {
    let rig = tables.rig.as_ref();
    let mut lines = vec![table(&[
        row("sensor to bottom", Some(found.sensor_to_bottom_mm), 2, " mm", rig.map(|rig| rig.sensor_to_bottom_mm)),
        row("scale of distances", found.sensor_scale, 4, "", rig.map(|rig| rig.sensor_scale)),
    ])];
    let mut bands = empty(["pass band", "measured", "from", "to", ""]);
    for band in &found.bands {
        bands.add_row([
            band.name.to_owned(),
            band.value.map_or_else(|| "–".into(), |value| format!("{value:.3}")),
            format!("{}", band.low),
            format!("{}", band.high),
            if band.pass {
                "pass"
            } else if band.value.is_none() {
                "cannot tell"
            } else {
                "FAIL"
            }
            .to_owned(),
        ]);
    }
    lines.push(bands.to_string());
    if found.sensor_scale.is_none() {
        lines.push(
            "At the top the ball is in the sensor's blind zone: the scale cannot be told. Mount the sensor at least 30 mm \
             above the ball's rest there."
                .into(),
        );
    }
    lines
}

fn table(rows: &[Row]) -> String {
    let mut table = empty(["", "measured", "90 % interval", "config"]);
    for Row { name, measured, digits, unit, believed } in rows {
        let [value, interval] = measured.map_or(["cannot tell".into(), String::new()], |m| said(m, *digits, unit));
        let believed = believed.map_or_else(String::new, |believed| format!("{believed:.digits$}{unit}"));
        table.add_row([name.clone(), value, interval, believed]);
    }
    table.to_string()
}

fn said(estimate: Estimate, digits: usize, unit: &str) -> [String; 2] {
    let Estimate { value, low, high } = estimate;
    [format!("{value:.digits$}{unit}"), format!("{low:.digits$} to {high:.digits$}{unit}")]
}
