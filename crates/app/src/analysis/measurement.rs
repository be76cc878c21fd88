//! The result of a measurement: the analysis of each kind, and the parts that need the app's config.
//!
//! Calibration: `position = sensor_to_bottom − scale·distance`. Positions of a log were made with the `[rig]` that flew
//! it, so that a correction `position = c·(reading − bottom)` gives
//!
//! ```text
//! scale' = c·scale        sensor_to_bottom' = c·(sensor_to_bottom − bottom)
//! ```

use super::step_response::{AT_REST_PERCENT, Moment, Step, steps_of};
use crate::cli::Measurement;
use crate::log::reader::LoadedLog;
use anyhow::{Result, anyhow};
use config::{Rig, Tables};
use diagnose::measure::Estimate;
use diagnose::measure::critical::{Critical, CriticalTime, critical, critical_time};
use diagnose::measure::dead_zone::{DeadZone, dead_zone};
use diagnose::measure::jumps::{Jumps, jumps};
use diagnose::measure::noise_floor::{NoiseFloor, noise_floor};
use diagnose::measure::two_ends::{TwoEnds, two_ends};
use serde::Serialize;

/// Below this distance the sensor cannot range a target, mm: its blind zone with the ball's curvature.
const BLIND_MM: f64 = 30.0;
/// Bands of a calibration, chosen so that a loop is not affected. Offset of the bottom in mm, scale off 1, noise of a
/// reading in mm.
const OFFSET_MM: f64 = 5.0;
const SCALE: f64 = 0.03;
const NOISE_MM: f64 = 5.0;
/// A step that begins before this is the take-off, seconds.
const TAKE_OFF_S: f64 = 1.0;

/// The result of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Found {
    /// Dead zone, by jumps near hover.
    DeadZone {
        /// Its edges.
        zone: DeadZone,
        /// The jumps.
        jumps: Jumps,
    },
    /// Force curve, by jumps at many duties.
    ForceCurve {
        /// The edges about hover, and the gains there.
        zone: DeadZone,
        /// The jumps.
        jumps: Jumps,
    },
    /// Critical gain.
    CriticalGain(Critical),
    /// Critical integral time.
    CriticalTime(CriticalTime),
    /// Step metrics.
    Steps(Steps),
    /// Noise floor.
    NoiseFloor(NoiseFloor),
    /// Calibration.
    Calibration(Calibration),
}

/// Step metrics over a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Steps {
    /// Steps, the take-off left out.
    pub steps: usize,
    /// Those that settled before the next.
    pub settled: usize,
    /// Those that began away from rest, which the means leave out.
    pub left_out: usize,
    /// Mean overshoot of the others, percent of the jump.
    pub overshoot_percent: Option<Estimate>,
    /// Mean time of the first peak, of those that have one, seconds.
    pub peak_s: Option<Estimate>,
    /// Mean settling time to ±5 %, of those that settled, seconds.
    pub settling_s: Option<Estimate>,
    /// Step by step.
    #[serde(skip)]
    pub each: Vec<Step>,
}

/// A calibration and its result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// The two ends.
    pub ends: TwoEnds,
    /// The corrected distance from the sensor to the ball at the bottom, mm.
    pub sensor_to_bottom_mm: Estimate,
    /// The corrected scale. `None`: the top is in the sensor's blind zone.
    pub sensor_scale: Option<Estimate>,
    /// The bands, with the measured values.
    pub bands: Vec<Band>,
}

/// A number that must lie in a band.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Its name, with its unit.
    pub name: &'static str,
    /// The number. `None`: it could not be measured.
    pub value: Option<f64>,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether it lies within.
    pub pass: bool,
}

impl Found {
    /// Analyses a log of the experiment. `travel_mm`: the ball's travel between its two ends, for a calibration.
    ///
    /// # Errors
    /// What the log lacks.
    pub fn of(what: Measurement, log: &LoadedLog, tables: &Tables, travel_mm: Option<f64>) -> Result<Self> {
        let recording = &log.recording;
        Ok(match what {
            Measurement::DeadZone => {
                let jumps = jumps(recording, drag_of(tables)?)?;
                Self::DeadZone { zone: dead_zone(&jumps)?, jumps }
            }
            Measurement::ForceCurve => {
                let jumps = jumps(recording, drag_of(tables)?)?;
                Self::ForceCurve { zone: dead_zone(&jumps)?, jumps }
            }
            Measurement::CriticalGain => Self::CriticalGain(critical(recording)?),
            Measurement::CriticalTime => Self::CriticalTime(critical_time(recording)?),
            Measurement::Steps | Measurement::Square => Self::Steps(Steps::of(log)?),
            Measurement::NoiseFloor => Self::NoiseFloor(noise_floor(recording)?),
            Measurement::Calibration => Self::Calibration(Calibration::of(log, tables, travel_mm)?),
        })
    }
}

/// The drag that is assumed for the forces of jumps, 1/s.
fn drag_of(tables: &Tables) -> Result<f64> {
    let drag_per_s = tables.plant.as_ref().map(|plant| plant.drag_per_s).filter(|drag_per_s| *drag_per_s > 0.0);
    drag_per_s.ok_or_else(|| {
        anyhow!("the ball's drag is not known, and jumps cannot tell it from the fan's lag; give [plant] drag_per_s")
    })
}

impl Steps {
    fn of(log: &LoadedLog) -> Result<Self> {
        let rows = log.recording.samples();
        let moments: Vec<Moment> = rows
            .iter()
            .map(|row| Moment { time_s: row.time_s, setpoint_mm: row.setpoint_mm, position_mm: row.position_mm })
            .collect();
        // A ball takes off once there is a setpoint.
        let start_s = rows.iter().find(|row| row.setpoint_mm.is_some()).map_or(0.0, |row| row.time_s);
        let each: Vec<Step> = steps_of(&moments).into_iter().filter(|s| s.time_s - start_s > TAKE_OFF_S).collect();
        if each.is_empty() {
            return Err(anyhow!(
                "the log has no step of its setpoint that was followed for a second; fly experiments/steps.toml, or name \
                 the setpoint's column in [import]"
            ));
        }
        let (from_rest, away): (Vec<&Step>, Vec<&Step>) =
            each.iter().partition(|step| step.off_at_start_percent <= AT_REST_PERCENT);
        // Where no step began at rest, all are as good.
        let (used, left_out) = if from_rest.is_empty() { (away, 0) } else { (from_rest, away.len()) };
        let of = |value: fn(&Step) -> Option<f64>| used.iter().copied().filter_map(value).collect::<Vec<f64>>();
        Ok(Self {
            steps: each.len(),
            settled: each.iter().filter(|step| step.settling_s.is_some()).count(),
            left_out,
            overshoot_percent: Estimate::of_mean(&of(|step| Some(step.overshoot_percent))),
            peak_s: Estimate::of_mean(&of(|step| step.peak_s)),
            settling_s: Estimate::of_mean(&of(|step| step.settling_s)),
            each,
        })
    }
}

impl Calibration {
    fn of(log: &LoadedLog, tables: &Tables, travel_mm: Option<f64>) -> Result<Self> {
        let flown = log.config_toml.as_deref().map(toml::from_str::<Tables>).transpose();
        let flown =
            flown.map_err(|error| anyhow!("the config in the log cannot be read, and with it its sensor: {error}"))?;
        let rig = flown.and_then(|held| held.rig).or_else(|| tables.rig.clone()).ok_or_else(|| {
            anyhow!("neither log nor config has a table [rig], so that the sensor's own distances are not known")
        })?;
        let travel_mm =
            travel_mm.or_else(|| tables.plant.as_ref().map(|plant| plant.pipe_length_mm)).ok_or_else(|| {
                anyhow!("the ball's way between its rests is not known; give --travel-mm, or [plant] pipe_length_mm")
            })?;
        let blind_above_mm = rig.sensor_to_bottom_mm - rig.sensor_scale * BLIND_MM;
        let ends = two_ends(&log.recording, travel_mm, blind_above_mm)?;
        Ok(Self::judged(ends, &rig))
    }

    fn judged(ends: TwoEnds, rig: &Rig) -> Self {
        let bottom = ends.bottom_mm.mapped(-1.0, rig.sensor_to_bottom_mm);
        let half_width = |estimate: Estimate| (estimate.high - estimate.low) / 2.0;
        // S' = travel·(S − b)/(t − b): its slopes along b and t, where the scale is corrected.
        let (value, half) = ends.top.map_or((bottom.value, half_width(bottom)), |top| {
            let way = top.reading_mm.value - ends.bottom_mm.value;
            let above = rig.sensor_to_bottom_mm - top.reading_mm.value;
            let (by_bottom, by_top) = (top.scale.value * above / way, top.scale.value * bottom.value / way);
            let half = (by_bottom * half_width(ends.bottom_mm)).hypot(by_top * half_width(top.reading_mm));
            (top.scale.value * bottom.value, half)
        });
        let sensor_scale = ends.top.map(|top| top.scale.mapped(rig.sensor_scale, 0.0));
        let band = |name, value: Option<f64>, low: f64, high: f64| Band {
            name,
            value,
            low,
            high,
            pass: value.is_some_and(|value| (low..=high).contains(&value)),
        };
        Self {
            sensor_to_bottom_mm: Estimate { value, low: value - half, high: value + half },
            sensor_scale,
            bands: vec![
                band("ball at the bottom, mm", Some(ends.bottom_mm.value), -OFFSET_MM, OFFSET_MM),
                band("scale of distances", ends.top.map(|top| top.scale.value), 1.0 - SCALE, 1.0 + SCALE),
                band("noise at the bottom, mm", Some(ends.noise_mm), 0.0, NOISE_MM),
                band("noise at the top, mm", ends.top.map(|top| top.noise_mm), 0.0, NOISE_MM),
            ],
            ends,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Steps;
    use crate::log::reader;
    use std::path::Path;

    #[test]
    fn a_step_that_began_away_from_rest_is_counted_and_left_out_of_the_means() {
        // From 200 to 300 mm and back with 10, 20 and 30 % of overshoot, and back with 90 % from 30 mm beside.
        let mut text = "time_s,duty_percent,position_mm,setpoint_mm\n".to_owned();
        for k in 0..2500 {
            let (setpoint, position) = match k {
                0..500 => (200.0, 200.0),
                500..520 => (300.0, 310.0),
                520..1000 => (300.0, 300.0),
                1000..1020 => (200.0, 180.0),
                1020..1500 => (200.0, 200.0),
                1500..1520 => (300.0, 330.0),
                1520..1900 => (300.0, 300.0),
                1900..2000 => (300.0, 330.0),
                2000..2020 => (200.0, 110.0),
                _ => (200.0, 200.0),
            };
            text += &format!("{},20,{position},{setpoint}\n", f64::from(k) / 100.0);
        }
        let log = reader::parse(Path::new("steps.csv"), text.as_bytes(), None).unwrap();
        let found = Steps::of(&log).unwrap();
        assert_eq!((found.steps, found.settled, found.left_out), (4, 4, 1));
        assert!((found.overshoot_percent.unwrap().value - 20.0).abs() < 1e-9, "{found:?}");
    }
}
