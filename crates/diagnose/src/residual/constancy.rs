//! Test of parameter constancy: how much the parameter of an effect varies with what was known before each reading.
//!
//! ```text
//! θ + ε·√2·cos(π·m·s)       s: share of the information on θ at lower values of a signal; m = 1 … 12
//! ε = Σ e·r/Σ r²            r = ∂ŷ/∂θ·√2·cos(π·m·s)/√S without its projection on all fitted parameters; e = ν/√S
//! σ² = max(Σ r², Σ e²·r²)/(Σ r²)²                  the second is robust to a misfit
//! variation = (|ε| − 3.76·σ)/min(|θ|, |θ − neutral|)
//! ```
//!
//! An effect that only resembles the cause fits one part of the record at the expense of another, so its parameter
//! varies. The variation is a lower confidence bound: small unmodelled effects, which are significant in a long record,
//! leave it small. It is computed as in a score test, from the derivatives at the fit, without another fit.
//!
//! Sources: Nyblom, "Testing for the constancy of parameters over time", J. Am. Stat. Assoc. 84 (1989), for time;
//! Zeileis and Hornik, "Generalized M-fluctuation tests for parameter instability", Statistica Neerlandica 61 (2007),
//! for other orders; White, "Maximum likelihood estimation of misspecified models", Econometrica 50 (1982), for the
//! robust variance.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::Parameter;
use crate::residual::location::rows;
use crate::residual::orthogonal::{Basis, LEAST_INDEPENDENT, dot};
use plant::{Entry, Neutral};
use serde::Serialize;
use std::f64::consts::{PI, SQRT_2};

/// Waves over the range of a signal. The shortest has six periods, as a disturbance of 10 s has in a minute. No other
/// number was tried.
const WAVES: u32 = 12;
/// The normal quantile that at least one of 60 independent numbers, the waves of a parameter, exceeds either way with a
/// probability of 1 %.
const QUANTILE: f64 = 3.763;

/// A variation that small unmodelled effects cause as well: of the 196 right names on the 225 practice rigs of
/// `scripts/odds` 2 varied by more, of the 55 wrong ones 11.
pub(crate) const SMALL_VARIATION: f64 = 0.1;

/// The signals with which a parameter may vary: as a key, and in words.
const SIGNALS: [(&str, &str); 5] = [
    ("duty_percent", "duty"),
    ("position_mm", "position"),
    ("velocity_mm_per_s", "velocity"),
    ("speed_mm_per_s", "speed"),
    ("time_s", "time"),
];

/// How a parameter of an effect varies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Variation {
    /// The name of the parameter.
    pub parameter: &'static str,
    /// The signal that it varies with.
    pub signal: &'static str,
    /// Lower confidence bound of the rms variation, as a share of the parameter.
    pub share: f64,
}

impl Variation {
    /// In words: what varies with what, and how much.
    #[must_use]
    pub fn in_words(&self) -> String {
        let words = SIGNALS.iter().find(|(key, _)| *key == self.signal).map_or(self.signal, |(_, words)| words);
        format!("its {} varies with the {words}, by {:.0} % or more", self.parameter, 100.0 * self.share)
    }
}

/// The sensitivities of the expected readings to the parameters of a fit.
pub(crate) struct Constancy<'a> {
    fit: &'a Fit,
    /// By parameter, then by reading, standard deviations for a step of the parameter.
    sensitivities: Vec<Vec<f64>>,
    /// Orthonormal columns of the same.
    basis: Basis,
    /// The standardised innovations without their projection on the basis.
    innovations: Vec<f64>,
    /// By signal, then by reading.
    signals: [Vec<f64>; 5],
}

impl<'a> Constancy<'a> {
    pub(crate) fn of(problem: &Problem<'_>, fit: &'a Fit) -> Self {
        let known = problem.sensitivities_of(fit, &fit.parameters);
        let rows = rows(&fit.model, problem.recording, problem.folds);
        let mut sensitivities = vec![Vec::new(); fit.parameters.len()];
        let (mut innovations, mut signals) = (Vec::new(), <[Vec<f64>; 5]>::default());
        for (k, taken) in fit.innovations.iter().enumerate().filter(|(_, taken)| !taken.repeat && taken.weight > 0.0) {
            let Ok(at) = rows.binary_search_by_key(&taken.row, |row| row.row) else { continue };
            let [duty, position, velocity, _] = rows[at].known;
            let seen = [duty, position, velocity, velocity.abs(), taken.row as f64];
            signals.iter_mut().zip(seen).for_each(|(signal, value)| signal.push(value));
            let root_weight = taken.weight.sqrt();
            innovations.push(taken.standardised / root_weight);
            for (i, column) in sensitivities.iter_mut().enumerate() {
                column.push(known.shift_mm(i, k) * root_weight / taken.variance_mm2.sqrt());
            }
        }
        let basis = Basis::of(sensitivities.iter().cloned());
        let innovations = basis.without_projection(innovations);
        Self { fit, sensitivities, basis, innovations, signals }
    }

    /// The largest variation of a parameter of an effect; `None` where none varies significantly.
    pub(crate) fn variation(&self, entry: &Entry) -> Option<Variation> {
        let own = self.fit.parameters.iter().enumerate().filter(|(_, parameter)| parameter.is_of(entry.name));
        let of_one = |(at, parameter): (usize, &Parameter)| {
            let (scale, name) = (self.scale(*parameter)?, parameter.param()?.name);
            let of_signal = |(signal, values): (&(&'static str, &str), &Vec<f64>)| {
                let share = scale * self.lower_bound(&self.sensitivities[at], values);
                Variation { parameter: name, signal: signal.0, share }
            };
            SIGNALS.iter().zip(&self.signals).map(of_signal).max_by(|a, b| a.share.total_cmp(&b.share))
        };
        let most = own.filter_map(of_one).max_by(|a, b| a.share.total_cmp(&b.share));
        most.filter(|variation| variation.share > 0.0 && variation.share.is_finite())
    }

    /// A step of the parameter as a share of its value and of its distance from neutral, whichever is smaller. `None`
    /// for a height or another parameter that is neutral at no one value.
    fn scale(&self, parameter: Parameter) -> Option<f64> {
        let Parameter::Effect { size, .. } = parameter else { return None };
        let Neutral::At(neutral) = parameter.param()?.neutral else { return None };
        let value = parameter.value(&self.fit.model)?;
        let least = value.abs().min((value - neutral).abs());
        (least > 0.0).then_some(size / least)
    }

    /// The largest lower confidence bound of the variation with a signal, in steps of the parameter.
    fn lower_bound(&self, sensitivity: &[f64], signal: &[f64]) -> f64 {
        let mut order: Vec<usize> = (0..signal.len()).collect();
        order.sort_by(|a, b| signal[*a].total_cmp(&signal[*b]));
        let whole = dot(sensitivity, sensitivity);
        let mut angles = vec![0.0; signal.len()];
        let mut below = 0.0;
        for k in order {
            let own = sensitivity[k].powi(2);
            angles[k] = PI * (below + 0.5 * own) / whole;
            below += own;
        }
        let wave = |m: u32| {
            let column = sensitivity.iter().zip(&angles).map(|(s, angle)| s * SQRT_2 * (f64::from(m) * angle).cos());
            let column = self.basis.without_projection(column.collect());
            let square = dot(&column, &column);
            let score = dot(&column, &self.innovations);
            let robust: f64 = column.iter().zip(&self.innovations).map(|(r, e)| (r * e).powi(2)).sum();
            // NaN compares as false.
            if square > LEAST_INDEPENDENT * whole {
                (score.abs() - QUANTILE * square.max(robust).sqrt()) / square
            } else {
                0.0
            }
        };
        (1..=WAVES).map(wave).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::{Constancy, Variation};
    use crate::Recording;
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
    use crate::record::folds::Folds;
    use crate::select::tests_support::lagging;
    use crate::tests_support::model;
    use plant::Effect;
    use plant::effects::FanLag;
    use std::f64::consts::FRAC_PI_6;

    /// How the fitted lag of a record varies.
    fn variation(recording: &Recording) -> Option<Variation> {
        let (belief, lag) = (model(), &FanLag::ENTRY);
        let folds = Folds::new(&belief, recording);
        let problem = Problem { recording, belief: &belief, folds: &folds, prior: Prior::Nothing };
        let values = belief.effects.values(lag.name).unwrap();
        let parameters: Vec<Parameter> = BASE.into_iter().chain(parameters_of_effect(lag, &values)).collect();
        let fit = problem.fit(&belief, &parameters);
        Constancy::of(&problem, &fit).variation(lag)
    }

    #[test]
    fn a_constant_lag_does_not_vary() {
        for seed in 0..10 {
            assert_eq!(variation(&lagging(seed, |_, _| 0.2)), None, "seed {seed}");
        }
    }

    #[test]
    fn a_lag_that_halves_with_the_duty_varies_by_no_more_than_it_does() {
        // The duties have a standard deviation of 1.7 %, so ln τ has one of 0.35.
        for seed in 0..3 {
            let found = variation(&lagging(seed, |u, _| 0.2 * (-0.3 * u).exp2())).unwrap();
            assert_eq!(found.parameter, "time_constant_s");
            assert!((0.05..0.35).contains(&found.share), "seed {seed}: {}", found.in_words());
        }
    }

    #[test]
    fn a_lag_that_varies_periodically_varies_with_the_time() {
        // Five periods of 12 s; a sine of 0.5 has a rms of 0.35.
        let found = variation(&lagging(1, |_, time_s| 0.2 * (1.0 + 0.5 * (FRAC_PI_6 * time_s).sin()))).unwrap();
        assert_eq!((found.parameter, found.signal), ("time_constant_s", "time_s"));
        assert!(found.in_words().starts_with("its time_constant_s varies with the time, by "));
        assert!((0.1..0.35).contains(&found.share), "{}", found.in_words());
    }
}
