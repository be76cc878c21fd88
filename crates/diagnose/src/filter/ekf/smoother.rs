//! The smoother: the state at each reading, given all readings before and after it.
//!
//! ```text
//! G = P_k·Φᵀ·P⁻¹(k+1|k)
//! x̂_k = x_k + G·(x̂_{k+1} − x(k+1|k))              from the last reading to the first
//! P̂_k = P_k + G·(P̂_{k+1} − P(k+1|k))·Gᵀ
//! ```
//!
//! The smoother of Rauch, Tung and Striebel on the filter's own linearisation. States that follow from others, such as
//! the sensed position without a lag, are left out of the inverse.
//! Source: Rauch, Tung and Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA Journal 3 (1965).

use super::active::Active;
use super::covariance::motion_of;
use super::measurement::Measured;
use super::{Ekf, Square, State};
use crate::filter::innovation::Innovation;
use plant::{Model, Motion};

/// Added to the diagonal as a share of the variance, so that the inverse exists where two states are fully correlated.
const JITTER: f64 = 1e-12;

/// A state and its covariance.
type Known = (State, Square);

/// What a filter keeps for the smoother.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmootherMemory {
    /// Φ since the last reading.
    since: Square,
    /// Φ between the last two readings, and the predicted state before the last one.
    leg: (Square, Known),
}

impl Default for SmootherMemory {
    fn default() -> Self {
        Self { since: Square::identity(), leg: (Square::identity(), (State::zeros(), Square::zeros())) }
    }
}

impl SmootherMemory {
    pub(super) fn go(&mut self, transition: &Square) {
        self.since = transition * self.since;
    }

    pub(super) fn arrive(&mut self, state: State, covariance: Square) {
        self.leg = (self.since, (state, covariance));
        self.since = Square::identity();
    }
}

/// The segment from one reading to the next, as forward sensitivities need it.
pub(crate) struct Segment {
    /// The time of the reading, seconds since the start of the flight.
    pub(crate) time_s: f64,
    transition: Square,
    /// Covariance of the states with the reading: the gain times the innovation's variance.
    towards: State,
    /// The states that the model has.
    active: Active,
    /// What the reading measures of the state.
    measured: Measured,
    /// Filtered position and velocity after the reading, mm and mm/s.
    pub(crate) known: (f64, f64),
    /// The filtered state after the reading.
    pub(crate) motion: Motion,
}

/// The same segment, as the smoother needs it.
pub(crate) struct FilteredStep {
    time_s: f64,
    transition: Square,
    expected: Known,
    filtered: Known,
}

/// The smoothed estimate at a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smoothed {
    /// The time, seconds since the start of the flight.
    pub(crate) time_s: f64,
    /// Position, mm.
    pub(crate) position_mm: f64,
    /// Velocity, mm/s.
    pub(crate) velocity_mm_per_s: f64,
    /// The acceleration by turbulence, mm/s², and its standard deviation.
    pub(crate) air_mm_per_s2: (f64, f64),
}

impl Ekf<'_> {
    /// The same filter, which keeps what the smoother needs.
    pub(crate) fn remembering(self, back: Option<SmootherMemory>) -> Self {
        Self { back: back.map(Box::new), ..self }
    }

    /// The segment up to the last reading. `None`: this filter keeps no memory for the smoother.
    pub(crate) fn leg(&self) -> Option<Segment> {
        let (transition, (state, covariance)) = &self.back.as_ref()?.leg;
        let measured = self.measured(state);
        let (towards, known) = (measured.towards(covariance), self.position_and_velocity());
        let (time_s, transition, active) = (self.time_s, *transition, self.active);
        Some(Segment { time_s, transition, towards, active, measured, known, motion: motion_of(&self.state) })
    }

    /// The same for the smoother.
    pub(crate) fn trace(&self) -> Option<FilteredStep> {
        let (transition, expected) = self.back.as_ref()?.leg;
        Some(FilteredStep { time_s: self.time_s, transition, expected, filtered: (self.state, self.covariance) })
    }
}

/// Sensitivity of the filter's expected state to a small force, or to a small shift of readings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sensitivity(State);

impl Sensitivity {
    /// The sensitivity before any force.
    pub(crate) fn zero() -> Self {
        Self(State::zeros())
    }

    /// Propagates over `leg`, `dt` seconds long, with a constant force, mm/s², and a shift of its reading, mm. Returns
    /// the change of the expected reading, mm, then applies the update with the weight of `taken`.
    pub(crate) fn go(&mut self, leg: &Segment, (dt, push, shift_mm): (f64, f64, f64), taken: &Innovation) -> f64 {
        // Trapezoidal rule for the effect of the changed velocity at the end of the segment.
        leg.active.transfer(&leg.transition, &mut self.0, 0.5 * dt * push);
        let moved_mm = leg.measured.change(&self.0) + shift_mm;
        let share = taken.weight * moved_mm / taken.variance_mm2;
        leg.active.correct(&mut self.0, &leg.towards, share);
        moved_mm
    }
}

/// The smoothed estimates at the end of each segment.
pub(crate) fn smoothed(model: &Model, traces: &[FilteredStep]) -> Vec<Smoothed> {
    let mut all = Vec::with_capacity(traces.len());
    let mut later: Option<(Known, &FilteredStep)> = None;
    for trace in traces.iter().rev() {
        let known = later.map_or(trace.filtered, |(known, next)| back(model, trace.filtered, next, known));
        let (state, covariance) = known;
        all.push(Smoothed {
            time_s: trace.time_s,
            position_mm: state[0],
            velocity_mm_per_s: state[1],
            air_mm_per_s2: (state[3], covariance[(3, 3)].max(0.0).sqrt()),
        });
        later = Some((known, trace));
    }
    all.reverse();
    all
}

/// The smoothed state at a reading, from its `filtered` state and the smoothed state `later` at the end of the next
/// segment.
fn back(model: &Model, filtered: Known, next: &FilteredStep, later: Known) -> Known {
    let (state, covariance) = filtered;
    let Some(gain) = gain(model, &covariance, next) else { return filtered };
    let (expected, spread) = next.expected;
    (state + gain * (later.0 - expected), covariance + gain * (later.1 - spread) * gain.transpose())
}

/// The smoother's gain G. `None`: the covariance has no inverse, and later readings add nothing.
fn gain(model: &Model, covariance: &Square, next: &FilteredStep) -> Option<Square> {
    let spread = next.expected.1;
    let active = Active::of(model);
    // In units of each state's own standard deviation: positions and accelerations differ by orders of magnitude.
    let scale = State::from_fn(|i, _| {
        if active.indices().contains(&i) && spread[(i, i)] > 0.0 { spread[(i, i)].sqrt().recip() } else { 0.0 }
    });
    let scaled = Square::from_fn(|i, j| {
        let same = if i == j { JITTER + f64::from(u8::from(scale[i] == 0.0)) } else { 0.0 };
        spread[(i, j)] * scale[i] * scale[j] + same
    });
    let across = Square::from_diagonal(&scale) * next.transition * covariance;
    let solved = scaled.cholesky()?.solve(&across);
    Some((Square::from_diagonal(&scale) * solved).transpose())
}
