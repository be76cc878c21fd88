//! Timed jumps: constant duties from rest, and the force of each.
//!
//! ```text
//! lag τ and the noise levels from all jumps together (see `glide`), then the force of each jump
//! var F = var of the filter + J·Σ·Jᵀ          Σ: covariance of the common parameters θ, J = ∂F/∂θ
//! ```
//!
//! The drag is given, as in the thesis, which takes it from its model: jumps cannot separate it from the fan lag. For
//! long jumps forces are proportional to the drag, so a wrong drag scales the curve; the edges of a dead zone do not
//! depend on it. The thesis measures the time over a fixed distance. The result of its corrected formula is given next
//! to each force for comparison. It neglects the fan lag, which makes the forces of short jumps look too small.
//! Source: the thesis, section 3.2.2; see [`crate::measure::timed_jump`].

use super::glide::{Glide, Way};
use super::hold::{Hold, holds};
use super::optimum::maximise;
use super::{Estimate, MeasureError};
use crate::measure::timed_jump::acceleration;
use crate::record::recording::Recording;
use rayon::prelude::*;
use serde::Serialize;

/// Shortest duration of a jump, seconds, and its smallest number of readings.
const SHORTEST_S: f64 = 0.3;
const FEWEST_READINGS: usize = 8;
/// Smallest number of jumps: they determine the lag.
const FEWEST: usize = 6;
/// Step of the numerical derivatives for J.
const DIFFERENCE: f64 = 0.02;

/// The jumps of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Jumps {
    /// a: linear drag of the ball, as given, 1/s.
    pub drag_per_s: f64,
    /// τ: fan lag, seconds.
    pub lag_s: Estimate,
    /// The jumps in sequence.
    pub jumps: Vec<Jump>,
}

/// One jump.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// The constant duty, percent.
    pub duty_percent: f64,
    /// Start and end, mm.
    pub from_mm: f64,
    /// See `from_mm`.
    pub to_mm: f64,
    /// Duration, seconds.
    pub time_s: f64,
    /// The force over the mass, mm/s².
    pub mm_per_s2: Estimate,
    /// The same from distance and time only, without the fan lag, mm/s².
    pub timed_mm_per_s2: Option<f64>,
    /// Standard deviation of the force due to this jump alone, mm/s².
    #[serde(skip)]
    pub(super) own_deviation: f64,
    /// Standard deviation of the force due to the common parameters, mm/s².
    #[serde(skip)]
    pub(super) shared_deviation: f64,
}

/// Finds the jumps and their forces for a ball of this drag, 1/s.
///
/// # Errors
/// [`MeasureError`] gives the number of jumps, or states that the fit failed.
pub fn jumps(recording: &Recording, drag_per_s: f64) -> Result<Jumps, MeasureError> {
    let counts = |hold: &Hold| hold.duration_s() >= SHORTEST_S && hold.readings.len() >= FEWEST_READINGS;
    let holds: Vec<Hold> = holds(recording).into_iter().filter(counts).collect();
    if holds.len() < FEWEST {
        return Err(MeasureError::FewJumps { found: holds.len(), needed: FEWEST, shortest_s: SHORTEST_S });
    }
    let ways = |at: &[f64]| -> Vec<Way> {
        let glide = Glide::of(drag_per_s, at);
        holds.par_iter().map(|hold| glide.along(hold)).collect()
    };
    let total = |at: &[f64]| ways(at).iter().map(|way| way.nats).sum::<f64>() + Glide::prior(at);
    let (best, covariance) = maximise(total, &Glide::start()).ok_or(MeasureError::NoFit)?;
    let off = |i: usize, by: f64| {
        let mut at = best.clone();
        at[i] += by;
        ways(&at)
    };
    let sides: Vec<[Vec<Way>; 2]> = (0..Glide::NUMBERS).map(|i| [off(i, DIFFERENCE), off(i, -DIFFERENCE)]).collect();
    let shared = |jump: usize| {
        let slope = |i: usize| (sides[i][0][jump].force - sides[i][1][jump].force) / (2.0 * DIFFERENCE);
        let slopes = nalgebra::DVector::from_fn(Glide::NUMBERS, |i, _| slope(i));
        slopes.dot(&(&covariance * &slopes)).max(0.0).sqrt()
    };
    let of_logarithm = |i: usize| {
        let Estimate { value, low, high } = Estimate::normal(best[i], covariance[(i, i)].sqrt());
        Estimate { value: value.exp(), low: low.exp(), high: high.exp() }
    };
    let found = holds.iter().zip(ways(&best)).enumerate();
    let jumps = found.map(|(number, (hold, way))| jump(hold, way, shared(number), drag_per_s)).collect();
    Ok(Jumps { drag_per_s, lag_s: of_logarithm(0), jumps })
}

fn jump(hold: &Hold, way: Way, shared_deviation: f64, drag_per_s: f64) -> Jump {
    let place = |reading: Option<&(f64, f64)>| reading.map_or(0.0, |(_, mm)| *mm);
    let (from_mm, to_mm) = (place(hold.readings.first()), place(hold.readings.last()));
    let time_s = hold.duration_s();
    Jump {
        duty_percent: hold.duty_percent,
        from_mm,
        to_mm,
        time_s,
        mm_per_s2: Estimate::normal(way.force, way.deviation.hypot(shared_deviation)),
        timed_mm_per_s2: acceleration(to_mm - from_mm, time_s, drag_per_s),
        own_deviation: way.deviation,
        shared_deviation,
    }
}
