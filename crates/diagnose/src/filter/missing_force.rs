//! The missing force: the force, beyond the model, that explains how the ball moved.
//!
//! ```text
//! ÿ = model + f        df = √q·dW        f: a random walk of intensity q
//! f̂(t), σ(t)           from all readings, before and after t: the smoother of `ekf::smoother`
//! q                    maximum likelihood
//! ```
//!
//! For plots and shapes, not for tests: in closed loop the duty follows whatever is missing, so a force plotted against
//! duty has a shape under a right model too. It replaces a turbulence that the model may have.
//! Source: Durbin and Koopman, *Time Series Analysis by State Space Methods*, chapters 2 and 4.

use crate::filter::track::{innovations, smoothed_states};
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use plant::Model;
use rayon::prelude::*;
use serde::Serialize;

/// Correlation time of the force, seconds: so long that it is a random walk on any record.
const FORGETS_S: f64 = 1e4;
/// Orders of magnitude of the intensity that are tried, relative to one that moves the ball by the readings' standard
/// deviation in a second.
const ORDERS: std::ops::RangeInclusive<i32> = -3..=9;
/// Steps of the second scan, about the best order.
const FINER: [f64; 6] = [-0.75, -0.5, -0.25, 0.25, 0.5, 0.75];

/// The missing force at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MissingForce {
    /// Time in the record, seconds.
    pub time_s: f64,
    /// The duty that was in force, percent.
    pub duty_percent: f64,
    /// Position of the ball, mm.
    pub position_mm: f64,
    /// Velocity of the ball, mm/s.
    pub velocity_mm_per_s: f64,
    /// The force divided by the ball's mass, upward, mm/s².
    pub force_mm_per_s2: f64,
    /// Its standard deviation, mm/s².
    pub sigma_mm_per_s2: f64,
}

/// The force that `model` lacks on `recording`, at each reading in free flight. The white noise of `model` should be
/// the believed one: noise that was fitted to a record has grown by what is missing.
#[must_use]
pub(crate) fn missing_force(model: &Model, recording: &Recording) -> Vec<MissingForce> {
    let folds = Folds::new(model, recording);
    let samples = recording.samples();
    let free = with_likely_force(model, recording, &folds);
    let mut row_then = 0;
    let known = smoothed_states(&free, recording).into_iter().filter(|(row, _)| folds.counts(*row));
    known
        .map(|(row, known)| {
            let time_s = samples[recording.flight_of(row).start].time_s + known.time_s;
            // A delayed reading belongs to an earlier time, when another duty was in force.
            while samples.get(row_then + 1).is_some_and(|next| next.time_s < time_s) {
                row_then += 1;
            }
            MissingForce {
                time_s,
                duty_percent: samples[row_then].duty_percent,
                position_mm: known.position_mm,
                velocity_mm_per_s: known.velocity_mm_per_s,
                force_mm_per_s2: known.air_mm_per_s2.0,
                sigma_mm_per_s2: known.air_mm_per_s2.1,
            }
        })
        .collect()
}

/// The model with a random-walk force of the most likely intensity.
fn with_likely_force(model: &Model, recording: &Recording, folds: &Folds) -> Model {
    let scale = model.noise.sensor_mm.max(recording.resolution_mm()).powi(2);
    let likelihood = |free: &Model| -> f64 {
        innovations(free, recording).iter().filter(|s| folds.counts(s.row)).map(|s| s.log_density).sum()
    };
    let best = |orders: Vec<f64>| {
        let rated = orders.into_par_iter().map(|order| {
            let free = with_force(model, scale * 10_f64.powf(order));
            (likelihood(&free), order, free)
        });
        // Of equal ones the first in the list, whichever thread ends first.
        rated.collect::<Vec<_>>().into_iter().reduce(|best, next| if next.0 > best.0 { next } else { best })
    };
    let Some((likely, order, free)) = best(ORDERS.map(f64::from).collect()) else { return model.clone() };
    let finer = best(FINER.map(|by| order + by).to_vec());
    finer.filter(|finer| finer.0 > likely).map_or(free, |finer| finer.2)
}

/// The model with a random-walk force of `intensity` mm²/s⁵.
fn with_force(model: &Model, intensity: f64) -> Model {
    let sigma_mm_per_s2 = (0.5 * intensity * FORGETS_S).sqrt();
    let effects = model.effects.with_coloured_force(sigma_mm_per_s2, FORGETS_S);
    Model { effects, ..model.clone() }
}

#[cfg(test)]
mod tests;
