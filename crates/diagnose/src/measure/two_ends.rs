//! Two-end calibration of the sensor: a ball at rest at the bottom and at the top, a known distance apart.
//!
//! ```text
//! position = scale·(reading − bottom)      scale = travel/(top − bottom)
//! ```
//!
//! Readings are positions by the present calibration; the result corrects it. The interval of a mean includes the
//! correlation of the readings. Neglected: non-linearity of the sensor between the ends.

use super::hold::{Hold, holds};
use super::noise_floor::{NoiseFloor, of_hold};
use super::{Estimate, MeasureError};
use crate::record::recording::Recording;
use serde::Serialize;

/// Smallest distance of the ends, as a share of the travel.
const APART: f64 = 0.5;
/// Shorter holds belong to the motion between the ends, seconds.
const SHORTEST_S: f64 = 4.0;

/// The result of the two ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TwoEnds {
    /// Mean reading at the bottom, mm; it should be 0.
    pub bottom_mm: Estimate,
    /// Noise at the bottom, 1σ, mm.
    pub noise_mm: f64,
    /// The result at the top; `None` if the ball is in the sensor's blind zone there, so that readings are missing or
    /// wrong.
    pub top: Option<Top>,
}

/// The result at the top.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Top {
    /// Mean reading, mm; it should be the travel.
    pub reading_mm: Estimate,
    /// Factor for distances from the bottom.
    pub scale: Estimate,
    /// Noise, 1σ, mm.
    pub noise_mm: f64,
}

/// Calibrates with `travel_mm`, the distance between the rest positions at the bottom and at the top. A top above
/// `blind_above_mm` is not used, because the ball is too near to the sensor there; where readings are missing the duty
/// cannot be held either.
///
/// # Errors
/// [`MeasureError`] names the missing end.
pub fn two_ends(recording: &Recording, travel_mm: f64, blind_above_mm: f64) -> Result<TwoEnds, MeasureError> {
    let holds: Vec<Hold> = holds(recording).into_iter().filter(|hold| hold.duration_s() > SHORTEST_S).collect();
    let by_duty = |a: &&Hold, b: &&Hold| a.duty_percent.total_cmp(&b.duty_percent);
    let Some(low) = holds.iter().min_by(by_duty) else {
        return Err(MeasureError::NoRest { found: 0, needed: 1 });
    };
    let resolution_mm = recording.resolution_mm();
    let bottom = of_hold(low, resolution_mm)?;
    let higher = holds.iter().max_by(by_duty).filter(|hold| hold.duty_percent > low.duty_percent);
    let seen = higher.map(|hold| of_hold(hold, resolution_mm)).transpose()?;
    if let Some(top) = seen.filter(|top| top.position_mm - bottom.position_mm < APART * travel_mm) {
        return Err(MeasureError::NotAtTheEnds { lowest_mm: bottom.position_mm, highest_mm: top.position_mm });
    }
    let bottom_mm = mean(&bottom);
    let top = seen.filter(|top| top.position_mm < blind_above_mm).map(|top| {
        let reading_mm = mean(&top);
        let way = reading_mm.value - bottom_mm.value;
        let deviation = half_width(bottom_mm).hypot(half_width(reading_mm)) / crate::stats::student::NORMAL_QUANTILE;
        let scale = travel_mm / way;
        Top { reading_mm, scale: Estimate::normal(scale, scale * deviation / way), noise_mm: top.sensor_mm.value }
    });
    Ok(TwoEnds { bottom_mm, noise_mm: bottom.sensor_mm.value, top })
}

/// The mean of correlated readings, as of a first-order process.
fn mean(end: &NoiseFloor) -> Estimate {
    let correlation = end.correlation.clamp(0.0, 0.99);
    let effective = end.readings as f64 * (1.0 - correlation) / (1.0 + correlation);
    let variance = end.sensor_mm.value.powi(2) + end.resolution_mm.powi(2) / 12.0;
    Estimate::normal(end.position_mm, (variance / effective).sqrt())
}

fn half_width(estimate: Estimate) -> f64 {
    (estimate.high - estimate.low) / 2.0
}
