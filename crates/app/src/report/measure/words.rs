//! A measurement in words and as JSON.

use crate::analysis::measurement::{Band, Calibration, Found, Steps};
use crate::analysis::step_response::AT_REST_PERCENT;
use crate::cli::Measurement;
use crate::report::kit::table::empty;
use anyhow::Result;
use clap::ValueEnum;
use config::Tables;
use diagnose::measure::Estimate;
use diagnose::measure::critical::{Critical, CriticalTime, Swing};
use diagnose::measure::dead_zone::DeadZone;
use diagnose::measure::jumps::{Jump, Jumps};
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
    /// The log.
    pub log: String,
    /// The result as a config patch.
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

/// A measured number, and the config's value.
pub struct Row {
    pub name: &'static str,
    /// `None`: it is not identifiable.
    pub measured: Option<Estimate>,
    /// Decimal places.
    pub digits: usize,
    pub unit: &'static str,
    pub believed: Option<f64>,
}

const fn row(
    name: &'static str,
    measured: Option<Estimate>,
    digits: usize,
    unit: &'static str,
    believed: Option<f64>,
) -> Row {
    Row { name, measured, digits, unit, believed }
}

/// The measurement as a table with the config's values, and a line or two.
#[must_use]
pub fn words(found: &Found, tables: &Tables) -> Vec<String> {
    let rows = rows(found, tables);
    match found {
        Found::DeadZone { zone, jumps } => vec![table(&rows), verdict_of_zone(zone, jumps), given(jumps)],
        Found::ForceCurve { jumps, .. } => vec![table(&rows), given(jumps), OF_PATCH.into(), where_forces_are(jumps)],
        Found::CriticalGain(critical) => words_of_gain(critical),
        Found::CriticalTime(critical) => words_of_time(critical),
        Found::Steps(steps) => vec![table_of_steps(&rows), settled(steps)],
        Found::NoiseFloor(floor) => vec![table(&rows), readings(floor)],
        Found::Calibration(calibration) => {
            let scale = calibration.sensor_scale.is_none().then(|| BLIND.into());
            [table(&rows), bands(calibration).table()].into_iter().chain(scale).collect()
        }
    }
}

/// Every number that was measured.
pub fn rows(found: &Found, tables: &Tables) -> Vec<Row> {
    match found {
        Found::DeadZone { zone, jumps } | Found::ForceCurve { zone, jumps } => rows_of_zone(zone, jumps, tables),
        Found::CriticalGain(critical) => {
            vec![row("critical gain", Some(critical.kp_per_mm), 5, " per mm", None)]
        }
        Found::CriticalTime(critical) => vec![row("critical integral time", Some(critical.ti_s), 3, " s", None)],
        Found::Steps(steps) => vec![
            row("overshoot", steps.overshoot_percent, 1, " %", None),
            row("first peak", steps.peak_s, 2, " s", None),
            row("settled to ±5 %", steps.settling_s, 2, " s", None),
        ],
        Found::NoiseFloor(floor) => rows_of_floor(floor, tables),
        Found::Calibration(found) => {
            let rig = tables.rig.as_ref();
            let (offset_mm, scale) = (rig.map(|rig| rig.sensor_to_bottom_mm), rig.map(|rig| rig.sensor_scale));
            vec![
                row("sensor to bottom", Some(found.sensor_to_bottom_mm), 2, " mm", offset_mm),
                row("scale of distances", found.sensor_scale, 4, "", scale),
            ]
        }
    }
}

fn rows_of_zone(zone: &DeadZone, jumps: &Jumps, tables: &Tables) -> Vec<Row> {
    let model = tables.plant.as_ref();
    let edge = |pick: fn(&plant::effects::DeadZone) -> f64| {
        model.map(|model| {
            model.hover_duty_percent + model.effects.get::<plant::effects::DeadZone>().as_ref().map_or(0.0, pick)
        })
    };
    let gain = model.map(|model| model.gain_mm_per_s2_per_percent);
    let lag = model.map(|model| model.effects.fan_lag_s().unwrap_or_default());
    vec![
        row("the ball falls below a duty of", Some(zone.lower_duty_percent), 3, " %", edge(|zone| zone.lower_percent)),
        row("the ball rises above a duty of", Some(zone.upper_duty_percent), 3, " %", edge(|zone| zone.upper_percent)),
        row("force below, mm/s² per percent", Some(zone.gain_below), 0, "", gain),
        row("force above, mm/s² per percent", Some(zone.gain_above), 0, "", gain),
        row("fan lag", Some(jumps.lag_s), 3, " s", lag),
    ]
}

fn rows_of_floor(floor: &NoiseFloor, tables: &Tables) -> Vec<Row> {
    let believed = tables.plant.as_ref().map(|model| model.effects.reading_sigma_mm(model.noise.sensor_mm));
    vec![
        row("noise of a reading, 1σ", Some(floor.sensor_mm), 3, " mm", believed),
        row("drift", Some(floor.drift_mm_per_s), 4, " mm/s", None),
    ]
}

/// Whether there is a dead zone.
pub fn verdict_of_zone(zone: &DeadZone, jumps: &Jumps) -> String {
    let (lower, upper) = (zone.lower_duty_percent, zone.upper_duty_percent);
    let (width, count) = (upper.value - lower.value, jumps.jumps.len());
    if upper.low > lower.high {
        format!(
            "A dead zone of {width:.3} %, from {count} jumps. Any duty within it may be called hover; the patch takes \
             its centre."
        )
    } else {
        format!(
            "No significant dead zone: from {count} jumps its width is {width:.3} %, and the intervals of the edges \
             overlap."
        )
    }
}

/// The assumptions of the forces.
pub fn given(jumps: &Jumps) -> String {
    format!("The forces assume the drag of the config, {} 1/s.", jumps.drag_per_s)
}

/// What the patch of a force curve does to the controllers.
pub const OF_PATCH: &str = "The patch makes the control value an acceleration in mm/s², so it multiplies the gains of \
     all controllers by the force per percent of duty.";

/// Where all forces are listed: on a terminal their many rows would hide the measured numbers.
fn where_forces_are(jumps: &Jumps) -> String {
    format!("The forces of all {} jumps are on the page of --html and in the document of --json.", jumps.jumps.len())
}

/// Rows of words under their heads.
pub struct Rows<const N: usize> {
    pub heads: [&'static str; N],
    pub rows: Vec<[String; N]>,
}

impl<const N: usize> Rows<N> {
    fn table(self) -> String {
        let mut table = empty(self.heads);
        table.add_rows(self.rows);
        table.to_string()
    }
}

/// The force curve, by rising duty.
pub fn forces(jumps: &Jumps) -> Rows<6> {
    let mut sorted = jumps.jumps.clone();
    sorted.sort_by(|a, b| a.duty_percent.total_cmp(&b.duty_percent));
    let row = |jump: &Jump| {
        let Estimate { value, low, high } = jump.mm_per_s2;
        [
            format!("{:.2} %", jump.duty_percent),
            format!("{:.0} mm", jump.to_mm - jump.from_mm),
            format!("{:.2} s", jump.time_s),
            format!("{value:.0} mm/s²"),
            format!("{low:.0} to {high:.0}"),
            jump.timed_mm_per_s2.map_or_else(String::new, |timed| format!("{timed:.0}")),
        ]
    };
    let heads = ["duty", "jump", "time", "force", "90 % interval", "without fan lag"];
    Rows { heads, rows: sorted.iter().map(row).collect() }
}

/// The steps that oscillate.
pub fn swings(steps: &[Swing]) -> Rows<5> {
    let row = |swing: &Swing| {
        [
            format!("{:.0} s", swing.time_s),
            format!("{:.5} per mm", swing.kp_per_mm),
            format!("{:.2} s", swing.ti_s),
            format!("{:+.3} 1/s", swing.growth_per_s),
            format!("{:.2} rad/s", swing.omega),
        ]
    };
    Rows { heads: ["step at", "K_p", "T_i", "growth", "frequency"], rows: steps.iter().map(row).collect() }
}

fn words_of_gain(found: &Critical) -> Vec<String> {
    let Estimate { value, low, high } = found.kp_per_mm;
    let (ti_s, omega) = (found.ti_s, found.omega);
    vec![
        swings(&found.swings).table(),
        format!(
            "critical gain {value:.5} per mm ({low:.5} to {high:.5}) under PI control with T_i = {ti_s:.1} s; it \
             oscillates at {omega:.2} rad/s"
        ),
    ]
}

fn words_of_time(found: &CriticalTime) -> Vec<String> {
    let Estimate { value, low, high } = found.ti_s;
    let (kp_per_mm, omega) = (found.kp_per_mm, found.omega);
    vec![
        swings(&found.swings).table(),
        format!(
            "critical integral time {value:.3} s ({low:.3} to {high:.3}) under PI control with K_p = {kp_per_mm:.4} \
             per mm; it oscillates at {omega:.2} rad/s"
        ),
    ]
}

fn table_of_steps(rows: &[Row]) -> String {
    let mut table = empty(["mean of the steps", "measured", "90 % interval"]);
    for Row { name, measured, digits, unit, .. } in rows {
        let [value, interval] = measured.map_or(["too few".into(), String::new()], |m| said(m, *digits, unit));
        table.add_row([(*name).to_owned(), value, interval]);
    }
    table.to_string()
}

/// How many steps settled, and how many the means leave out.
pub fn settled(steps: &Steps) -> String {
    let Steps { steps, settled, left_out, .. } = steps;
    let all = format!("{steps} steps, of which {settled} settled before the next.");
    match left_out {
        0 => all,
        out => format!(
            "{all} {out} began more than {AT_REST_PERCENT:.0} % of the jump away from the old setpoint: the means leave \
             {} out.",
            if *out == 1 { "it" } else { "them" }
        ),
    }
}

/// The readings at rest.
pub fn readings(floor: &NoiseFloor) -> String {
    let NoiseFloor { correlation, resolution_mm, readings, wild, .. } = floor;
    format!(
        "{readings} readings at rest, {wild} outliers left out; resolution {resolution_mm:.2} mm, autocorrelation at \
         lag 1 {correlation:+.3}."
    )
}

/// Why a scale is not identifiable.
pub const BLIND: &str = "At the top the ball is in the sensor's blind zone: the scale cannot be measured. Mount the \
     sensor at least 30 mm above the ball's rest there.";

/// The bands, and whether each is met.
pub fn bands(found: &Calibration) -> Rows<5> {
    let row = |band: &Band| {
        let verdict = match band {
            Band { pass: true, .. } => "pass",
            Band { value: None, .. } => "cannot tell",
            Band { .. } => "FAIL",
        };
        [
            band.name.to_owned(),
            band.value.map_or_else(|| "–".into(), |value| format!("{value:.3}")),
            format!("{}", band.low),
            format!("{}", band.high),
            verdict.to_owned(),
        ]
    };
    Rows { heads: ["pass band", "measured", "from", "to", "verdict"], rows: found.bands.iter().map(row).collect() }
}

fn table(rows: &[Row]) -> String {
    let mut table = empty(["", "measured", "90 % interval", "config"]);
    for Row { name, measured, digits, unit, believed } in rows {
        let [value, interval] = measured.map_or(["cannot tell".into(), String::new()], |m| said(m, *digits, unit));
        let believed = believed.map_or_else(String::new, |believed| format!("{believed:.digits$}{unit}"));
        table.add_row([(*name).to_owned(), value, interval, believed]);
    }
    table.to_string()
}

/// Value and interval.
pub fn said(estimate: Estimate, digits: usize, unit: &str) -> [String; 2] {
    let Estimate { value, low, high } = estimate;
    [format!("{value:.digits$}{unit}"), format!("{low:.digits$} to {high:.digits$}{unit}")]
}
