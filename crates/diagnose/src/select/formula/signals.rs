//! The range over which a record shows each signal that a force may depend on.

use crate::fit::estimate::{Fit, Problem};
use crate::residual::score_test::FilterRun;
use crate::stats::quantile::quantile;

/// Shares of the readings between which a signal counts as seen.
const SEEN: [f64; 2] = [0.02, 0.98];

/// A signal: the middle of the values seen, and half their range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) middle: f64,
    pub(super) half: f64,
}

/// The signals of a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signals {
    /// Height, mm.
    pub(super) x: Seen,
    /// Velocity, mm/s.
    pub(super) v: Seen,
    /// Duty about hover, percent.
    pub(super) u: Seen,
    /// Time, s.
    pub(super) t: Seen,
    /// The acceleration by the duty that is farthest from hover, mm/s².
    pub(super) force: f64,
}

impl Signals {
    /// The signals as the filter of `fit` estimates them; `None` if one of them never changes.
    pub(super) fn of(problem: &Problem<'_>, fit: &Fit) -> Option<Self> {
        let run = FilterRun::of(problem, fit.clone(), &|row| problem.folds.counts(row));
        let conditions = run.before_readings(problem).into_iter().flatten().map(|before| before.conditions);
        let all: Vec<[f64; 4]> = conditions
            .map(|at| {
                [
                    at.position_mm,
                    at.velocity_mm_per_s,
                    at.commanded_mm_per_s2 / at.gain_mm_per_s2_per_percent,
                    at.time_s,
                ]
            })
            .collect();
        let seen = |signal: usize| {
            let mut values: Vec<f64> = all.iter().map(|at| at[signal]).collect();
            values.sort_by(f64::total_cmp);
            Seen::between(SEEN.map(|share| quantile(&values, share)))
        };
        let (x, v, u, t) = (seen(0)?, seen(1)?, seen(2)?, seen(3)?);
        Some(Self {
            x,
            v,
            u,
            t,
            force: rounded(fit.model.gain_mm_per_s2_per_percent.abs() * (u.middle.abs() + u.half)),
        })
    }
}

#[cfg(test)]
impl Signals {
    /// The same with another unit of length.
    pub(super) fn times(&self, scale: f64) -> Self {
        let of = |seen: Seen| Seen { middle: scale * seen.middle, half: scale * seen.half };
        Self { x: of(self.x), v: of(self.v), force: scale * self.force, ..*self }
    }
}

impl Seen {
    /// Rounded to two digits of its range, so that similar records share their shapes.
    fn between([low, high]: [f64; 2]) -> Option<Self> {
        let half = rounded(0.5 * (high - low));
        let step = step_of(half);
        let middle = (0.5 * (low + high) / step).round() * step;
        (half > 0.0 && half.is_finite() && middle.abs() < 1e6).then_some(Self { middle, half })
    }
}

/// A positive number rounded to two digits; 0 for any other.
pub(super) fn rounded(value: f64) -> f64 {
    if value > 0.0 && value.is_finite() { (value / step_of(value)).round() * step_of(value) } else { 0.0 }
}

/// The unit of the second digit of a positive number.
fn step_of(value: f64) -> f64 {
    10f64.powf(value.log10().floor() - 1.0)
}
