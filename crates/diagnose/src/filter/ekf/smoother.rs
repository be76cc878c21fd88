//! The way back: what a whole recording says of a moment, not only what came before it.
//!
//! ```text
//! G = P_k·Φᵀ·P⁻¹(k+1|k)
//! x̂_k = x_k + G·(x̂_{k+1} − x(k+1|k))              from the last reading to the first
//! P̂_k = P_k + G·(P̂_{k+1} − P(k+1|k))·Gᵀ
//! ```
//!
//! The smoother of Rauch, Tung and Striebel on the filter's own linearisation. States that follow from others, as the sensed
//! position does without a lag, are left out of the inverse.
//! Source: Rauch, Tung and Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA Journal 3 (1965).

use super::covariance::flush_tiny;
use super::{Ekf, Square, State, active_states, seen_state};
use crate::filter::innovation::Innovation;
use plant::Model;

/// What keeps an inverse from failing where two states are as good as one: a share of their variance.
const JITTER: f64 = 1e-12;

/// A state and its covariance.
type Known = (State, Square);

/// What a filter remembers for the way back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmootherMemory {
    /// Φ since the last reading.
    since: Square,
    /// Φ between the last two readings, and what was known before the last one was taken.
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

/// The way from one reading to the next, as it matters to those who follow it on.
pub(crate) struct Segment {
    /// The moment of the reading, seconds since the start of the flight.
    pub(crate) time_s: f64,
    transition: Square,
    /// How far the reading moves each state, but for its innovation over its variance.
    towards: State,
    /// Height and velocity, as they are known after the reading, mm and mm/s.
    pub(crate) known: (f64, f64),
}

/// The same as it matters to those who come back along it.
pub(crate) struct FilteredStep {
    time_s: f64,
    transition: Square,
    expected: Known,
    filtered: Known,
}

/// What a whole recording says of a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smoothed {
    /// The moment, seconds since the start of the record.
    pub(crate) time_s: f64,
    /// Position, mm.
    pub(crate) position_mm: f64,
    /// Velocity, mm/s.
    pub(crate) velocity_mm_per_s: f64,
    /// The air's push, mm/s², and its standard deviation.
    pub(crate) air_mm_per_s2: (f64, f64),
}

impl Ekf<'_> {
    /// The same filter, which remembers what the way back needs.
    pub(crate) fn remembering(self, back: Option<SmootherMemory>) -> Self {
        Self { back: back.map(Box::new), ..self }
    }

    /// The way to the reading that was taken last. `None`: this filter does not remember.
    pub(crate) fn leg(&self) -> Option<Segment> {
        let (transition, (_, expected)) = &self.back.as_ref()?.leg;
        let towards = expected.column(seen_state(self.model)).into_owned();
        Some(Segment { time_s: self.time_s, transition: *transition, towards, known: self.position_and_velocity() })
    }

    /// The same for the way back.
    pub(crate) fn trace(&self) -> Option<FilteredStep> {
        let (transition, expected) = self.back.as_ref()?.leg;
        Some(FilteredStep { time_s: self.time_s, transition, expected, filtered: (self.state, self.covariance) })
    }
}

/// How far a small push along the way, or a small shift of readings, moves what a filter expects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sensitivity(State);

impl Sensitivity {
    /// Nothing was pushed yet.
    pub(crate) fn zero() -> Self {
        Self(State::zeros())
    }

    /// Goes along `leg`, of `dt` seconds, with a constant push, mm/s², and a shift of its reading, mm: how far the reading that is expected
    /// moves, mm. Then the reading is taken as it was `taken`.
    pub(crate) fn go(
        &mut self,
        model: &Model,
        leg: &Segment,
        (dt, push, shift_mm): (f64, f64, f64),
        taken: &Innovation,
    ) -> f64 {
        let seen = seen_state(model);
        // The trapezoid of what a change of velocity has become at the end of the leg.
        let mut pushed = leg.transition.column(1) * (0.5 * dt * push);
        pushed[1] += 0.5 * dt * push;
        self.0 = leg.transition * self.0 + pushed;
        let moved_mm = self.0[seen] + shift_mm;
        self.0 -= leg.towards * (taken.weight * moved_mm / taken.variance_mm2);
        self.0.apply(|moved| *moved = flush_tiny(*moved));
        moved_mm
    }
}

/// What is known in smoothed_states at the end of each leg.
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

/// What is known of a moment, `filtered` so far, once `later` is known of the end of the leg that follows.
fn back(model: &Model, filtered: Known, next: &FilteredStep, later: Known) -> Known {
    let (state, covariance) = filtered;
    let Some(gain) = gain(model, &covariance, next) else { return filtered };
    let (expected, spread) = next.expected;
    (state + gain * (later.0 - expected), covariance + gain * (later.1 - spread) * gain.transpose())
}

/// G. `None`: the covariance has no inverse, and nothing is learnt from later.
fn gain(model: &Model, covariance: &Square, next: &FilteredStep) -> Option<Square> {
    let spread = next.expected.1;
    let own = active_states(model);
    // In units of each state's own deviation: positions and accelerations differ by orders of magnitude.
    let scale = State::from_fn(|i, _| if own[i] && spread[(i, i)] > 0.0 { spread[(i, i)].sqrt().recip() } else { 0.0 });
    let scaled = Square::from_fn(|i, j| {
        let same = if i == j { JITTER + f64::from(u8::from(scale[i] == 0.0)) } else { 0.0 };
        spread[(i, j)] * scale[i] * scale[j] + same
    });
    let across = Square::from_diagonal(&scale) * next.transition * covariance;
    let solved = scaled.cholesky()?.solve(&across);
    Some((Square::from_diagonal(&scale) * solved).transpose())
}
