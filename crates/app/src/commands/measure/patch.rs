//! What a measurement found, as a config patch.

use crate::analysis::measurement::Found;
use crate::report::kit::patch::rounded;
use anyhow::{Result, anyhow};
use config::{Tables, with_other_control};
use control::predistortion::{MAX_POINTS, Predistortion};
use diagnose::identify::fan_lag_s;
use diagnose::measure::critical::Critical;
use diagnose::measure::dead_zone::DeadZone;
use diagnose::measure::jumps::Jumps;
use plant::Effect;
use plant::effects::{DeadZone as PlantDeadZone, FanLag};
use toml::{Table, Value};

/// The slope of a curve about hover is computed over this much to either side, percent.
const ABOUT_HOVER_PERCENT: f64 = 0.5;
/// Lags that a fan may have, seconds.
const LAGS_S: std::ops::Range<f64> = 0.002..1.0;

/// Sets a number of a patch by its path.
type Set<'a> = dyn FnMut(&[&str], Value) + 'a;

/// The patch of what was found; `None` where a config holds no such number.
pub(super) fn patch(found: &Found, tables: &Tables) -> Result<Option<String>> {
    let mut patch = Table::new();
    let mut set = |path: &[&str], value: Value| put(&mut patch, path, value);
    match found {
        Found::DeadZone { zone, .. } => of_dead_zone(zone, tables, &mut set),
        Found::ForceCurve { zone, jumps } => of_force_curve(zone, jumps, tables, &mut set)?,
        Found::CriticalGain(critical) => {
            if let Some(lag_s) = lag_of(critical, tables) {
                set(&["plant", "effects", FanLag::ENTRY.name, "time_constant_s"], lag_s.into());
            }
        }
        Found::Steps(_) | Found::CriticalTime(_) => {}
        Found::NoiseFloor(floor) => {
            let sensor_mm = floor.sensor_mm.value;
            if let Some(plant) = &tables.plant {
                // The part of an effect of the plant is measured as well, and is kept.
                let added_mm = plant.effects.reading_sigma_mm(0.0);
                set(&["plant", "noise", "sensor_mm"], (sensor_mm.powi(2) - added_mm.powi(2)).max(0.0).sqrt().into());
            }
            if tables.observer.is_some() {
                set(&["observer", "sensor_mm"], sensor_mm.into());
            }
        }
        Found::Calibration(calibration) => {
            set(&["rig", "sensor_to_bottom_mm"], calibration.sensor_to_bottom_mm.value.into());
            if let Some(scale) = calibration.sensor_scale {
                set(&["rig", "sensor_scale"], scale.value.into());
            }
        }
    }
    Ok(if patch.is_empty() { None } else { Some(rounded(&toml::to_string(&patch)?)) })
}

/// Writes a value at a path, with the tables on the way.
fn put(table: &mut Table, path: &[&str], value: Value) {
    match path {
        [] => {}
        [key] => drop(table.insert((*key).to_owned(), value)),
        [key, rest @ ..] => {
            let below = table.entry(*key).or_insert_with(|| Value::Table(Table::new()));
            if let Value::Table(below) = below {
                put(below, rest, value);
            }
        }
    }
}

/// Hover in the middle of the zone, the zone's edges about it: corrected in `[compensation]`, believed in `[plant]`. A
/// zone whose width is not significantly above 0 counts as none.
fn of_dead_zone(zone: &DeadZone, tables: &Tables, set: &mut Set<'_>) {
    let (lower, upper) = (zone.lower_duty_percent, zone.upper_duty_percent);
    let hover = (lower.value + upper.value) / 2.0;
    let half = if upper.low > lower.high { upper.value - hover } else { 0.0 };
    let corrected = tables.compensation.as_ref();
    if corrected.is_some() {
        set(&["compensation", "hover_duty_percent"], hover.into());
    }
    if half > 0.0 || corrected.is_some_and(|compensation| compensation.dead_zone.is_some()) {
        set(&["compensation", "dead_zone", "lower_percent"], (-half).into());
        set(&["compensation", "dead_zone", "upper_percent"], half.into());
    }
    let Some(model) = &tables.plant else { return };
    set(&["plant", "hover_duty_percent"], hover.into());
    if half > 0.0 || model.effects.get::<PlantDeadZone>().is_some() {
        set(&["plant", "effects", PlantDeadZone::ENTRY.name, "lower_percent"], (-half).into());
        set(&["plant", "effects", PlantDeadZone::ENTRY.name, "upper_percent"], half.into());
    }
}

/// The measured curve as predistortion. The control value becomes mm/s², so that all gains of the config are converted
/// to that unit. The curve includes the dead zone, which is no longer corrected separately.
fn of_force_curve(zone: &DeadZone, jumps: &Jumps, tables: &Tables, set: &mut Set<'_>) -> Result<()> {
    let mut points: Vec<[f64; 2]> = jumps.jumps.iter().map(|jump| [jump.duty_percent, jump.mm_per_s2.value]).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points.dedup_by(|a, b| a[0] - b[0] < 1e-6);
    points.truncate(MAX_POINTS);
    let curve = Predistortion { points: Some(points.iter().copied().collect()) };
    curve.check().map_err(|error| anyhow!("the measured curve is no predistortion: {error}; fly it again"))?;
    let pairs = points.iter().map(|point| Value::Array(point.iter().map(|number| (*number).into()).collect()));
    set(&["compensation", "predistortion", "points"], Value::Array(pairs.collect()));
    let Some(compensation) = &tables.compensation else { return Ok(()) };
    set(&["compensation", "hover_duty_percent"], hover_of(zone).into());
    if compensation.dead_zone.is_some() {
        set(&["compensation", "dead_zone", "lower_percent"], 0.0.into());
        set(&["compensation", "dead_zone", "upper_percent"], 0.0.into());
    }
    let slope = |curve: &Predistortion| {
        let curve = curve.curve();
        (curve.mm_per_s2(ABOUT_HOVER_PERCENT) - curve.mm_per_s2(-ABOUT_HOVER_PERCENT)) / (2.0 * ABOUT_HOVER_PERCENT)
    };
    let old = compensation.predistortion.as_ref().map_or(1.0, slope);
    let factor = (zone.gain_below.value + zone.gain_above.value) / 2.0 / old;
    for (key, value) in with_other_control(tables, factor) {
        let path: Vec<&str> = key.split('.').collect();
        set(&path, value.into());
    }
    Ok(())
}

fn hover_of(zone: &DeadZone) -> f64 {
    (zone.lower_duty_percent.value + zone.upper_duty_percent.value) / 2.0
}

/// The lag of the fan that gives the config's model the measured critical gain, sampled as the loop does it; proposed
/// in the thesis' conclusion. `None`: no lag does, or there is no model.
fn lag_of(found: &Critical, tables: &Tables) -> Option<f64> {
    let (model, period_s) = (tables.plant.as_ref()?, tables.r#loop?.period_s);
    let lag_s = fan_lag_s(&model.linear(), found.ti_s, found.kp_per_mm.value, Some(period_s)).ok();
    lag_s.filter(|lag_s| LAGS_S.contains(lag_s))
}

#[cfg(test)]
mod tests;
