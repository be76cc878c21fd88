//! From the position to the reading: what the sensor does after its lag.
//!
//! ```text
//! s → + what written effects add → at t − delay → + σ·n → ± size, now and then → nearest step
//!   → held until the next refresh
//! ```
//!
//! Where the ball was is interpolated linearly between integration steps of at most 1 ms, which is exact to
//! a·dt²/8, 1e-4 mm at 1000 mm/s². Before time 0 it was where it was at time 0.
//! Source: the order of the signal path inside a digital range sensor.

use crate::model::Model;
use crate::motion::{Input, Motion};
use crate::normal::Normal;
use crate::rounding::rounded;
use std::collections::VecDeque;

/// Stream numbers of the sensor's random numbers: one each, so that one effect leaves another's numbers alone.
const NOISE_STREAM: u64 = 1;
const OUTLIER_STREAM: u64 = 3;

/// The state of the sensor. Its parameters are in the [`Model`], which every call takes.
#[derive(Clone, Debug)]
pub(crate) struct Sensor {
    /// Time, and what the sensor shows without delay and noise, as far back as a reading may reach.
    past: VecDeque<(f64, f64)>,
    /// The last reading and when it was taken.
    held: Option<(f64, f64)>,
    noise: Normal,
    outliers: Normal,
}

impl Sensor {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            past: VecDeque::new(),
            held: None,
            noise: Normal::new(seed, NOISE_STREAM),
            outliers: Normal::new(seed, OUTLIER_STREAM),
        }
    }

    /// Remembers what the sensor shows, once at time 0 and then after every step.
    #[inline]
    pub(crate) fn follow(&mut self, model: &Model, motion: &Motion, input: Input) {
        let reach = reach_s(model);
        if reach > 0.0 {
            self.past.push_back((input.time_s, model.seen_mm(motion, input)));
            while self.past.get(1).is_some_and(|(second_s, _)| *second_s <= input.time_s - reach) {
                self.past.pop_front();
            }
        }
    }

    /// The reading at `time_s`, mm, where the sensor shows `seen_mm` without delay and noise.
    pub(crate) fn reading(&mut self, model: &Model, time_s: f64, seen_mm: f64) -> f64 {
        let Some(stale) = model.effects.hold().filter(|stale| stale.hold_s > 0.0) else {
            return self.measure(model, time_s, seen_mm);
        };
        let refreshed_s = stale.refreshed_at(time_s);
        // Whichever of two instants within one refresh was asked first, it is the same refresh.
        if let Some((_, reading)) = self.held.filter(|(taken_s, _)| refreshed_s - taken_s < stale.hold_s / 2.0) {
            return reading;
        }
        let reading = self.measure(model, refreshed_s, seen_mm);
        self.held = Some((refreshed_s, reading));
        reading
    }

    /// A fresh measurement at `time_s`.
    fn measure(&mut self, model: &Model, time_s: f64, seen_mm: f64) -> f64 {
        let effects = &model.effects;
        let seen_at = time_s - effects.reading_delay_s();
        let sigma = effects.reading_sigma_mm(model.noise.sensor_mm);
        let mut reading = self.seen(seen_at).unwrap_or(seen_mm) + sigma * self.noise.draw();
        if let Some(outliers) = effects.outliers() {
            reading += outliers.offset_mm(self.outliers.uniform());
        }
        effects.reading_step_mm().map_or(reading, |step_mm| rounded(step_mm, reading))
    }

    /// What the sensor showed at `time_s`. `None`: nothing is remembered, because nothing needs it.
    fn seen(&self, time_s: f64) -> Option<f64> {
        let next = self.past.partition_point(|(at_s, _)| *at_s < time_s);
        let after = self.past.get(next).or(self.past.back())?;
        let before = self.past.get(next.checked_sub(1).unwrap_or(next)).unwrap_or(after);
        let span = after.0 - before.0;
        let part = if span > 0.0 { ((time_s - before.0) / span).clamp(0.0, 1.0) } else { 1.0 };
        Some(before.1 + (after.1 - before.1) * part)
    }
}

/// How far back a reading may reach, seconds.
fn reach_s(model: &Model) -> f64 {
    model.effects.reading_delay_s() + model.effects.hold().map_or(0.0, |stale| stale.hold_s)
}

#[cfg(test)]
mod tests;
