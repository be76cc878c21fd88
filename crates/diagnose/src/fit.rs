//! Fitting a model to a recording: maximum likelihood by Fisher scoring.
//!
//! ```text
//! L = Σ ln p(ν_k)                 ν_k, S_k: innovation and its variance, functions of the parameters θ
//! g = Σ w·( −ν·∂ν/S + ½·(ν²/S − 1)·∂lnS )
//! H = Σ w·(  ∂ν·∂νᵀ/S + ½·∂lnS·∂lnSᵀ )        Levenberg–Marquardt: (H + λ·diag H)·δ = g
//! ```
//!
//! An owner's belief is worth something: gain, drag and hover are held to it by a wide prior (30 %, 30 %, 0.5 %), which
//! decides only where the record cannot, along the ridge on which gain, drag and a lag trade against each other.
//!
//! Derivatives are differences of whole filter runs. θ is scaled: ratios are logarithms, the rest counts in sizes that a rig would
//! show, so that one λ serves all. The covariance of θ is H⁻¹ when the model is right.
//! Source: Gupta and Mehra, "Computational aspects of maximum likelihood estimation", IEEE TAC 19 (1974).

use crate::likelihood::{Surprise, surprises};
use crate::recording::Recording;
use nalgebra::{DMatrix, DVector};
use plant::{Effects, Model};

/// Scoring steps at most; a fit that needs more creeps along a valley that the record cannot resolve.
const MOST_STEPS: usize = 15;
/// A step that gains less than this, nats, is the last.
const GAIN_ENOUGH: f64 = 0.02;
/// Length of the differences in scaled parameters.
const DIFFERENCE: f64 = 0.01;

/// A number of the model that a fit may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Free {
    /// `gain_mm_per_s2_per_percent`, as a ratio.
    Gain,
    /// `drag_per_s`, as a ratio.
    Drag,
    /// `hover_duty_percent`.
    Hover,
    /// `noise.sensor_mm`, as a ratio.
    SensorNoise,
    /// `noise.acceleration_psd_mm2_per_s3`, as a ratio.
    AirNoise,
    /// A number of an effect that is on.
    Effect {
        /// The effect.
        name: &'static str,
        /// Which of its parameters.
        index: usize,
        /// A size that a rig would show.
        size: f64,
    },
}

/// The numbers that every model has, noise last.
pub const BASE: [Free; 5] = [Free::Gain, Free::Drag, Free::Hover, Free::SensorNoise, Free::AirNoise];

impl Free {
    /// Deviation of the owner's belief in the number's own scale; infinite where nothing is believed.
    const fn doubt(self) -> f64 {
        match self {
            Self::Gain | Self::Drag => 0.3,
            Self::Hover => 5.0,
            Self::SensorNoise | Self::AirNoise | Self::Effect { .. } => f64::INFINITY,
        }
    }

    /// How far `model` is from `belief`, in the number's own scale. Only asked where something is believed.
    fn distance(self, model: &Model, belief: &Model) -> f64 {
        match self {
            Self::Gain => (model.gain_mm_per_s2_per_percent / belief.gain_mm_per_s2_per_percent).ln(),
            Self::Drag => (model.drag_per_s.max(1e-3) / belief.drag_per_s.max(1e-3)).ln(),
            Self::Hover => (model.hover_duty_percent - belief.hover_duty_percent) / 0.1,
            Self::SensorNoise | Self::AirNoise | Self::Effect { .. } => 0.0,
        }
    }

    /// The model with this number moved by `by` in its own scale, within its bounds.
    fn moved(self, model: &Model, by: f64) -> Model {
        let mut model = model.clone();
        let ratio = by.clamp(-3.0, 3.0).exp();
        match self {
            Self::Gain => model.gain_mm_per_s2_per_percent *= ratio,
            Self::Drag => model.drag_per_s = (model.drag_per_s.max(1e-3) * ratio).min(1e3),
            Self::Hover => model.hover_duty_percent += 0.1 * by,
            Self::SensorNoise => model.noise.sensor_mm = model.noise.sensor_mm.max(1e-4) * ratio,
            Self::AirNoise => {
                model.noise.acceleration_psd_mm2_per_s3 = model.noise.acceleration_psd_mm2_per_s3.max(1e-4) * ratio;
            }
            Self::Effect { name, index, size } => {
                let mut values = model.effects.values(name).unwrap_or_default();
                let param =
                    Effects::CATALOGUE.iter().find(|entry| entry.name == name).and_then(|e| e.params.get(index));
                if let (Some(value), Some(param)) = (values.get_mut(index), param) {
                    *value = (*value + size * by).clamp(param.min, param.max);
                }
                model.effects.set(name, &values);
            }
        }
        model
    }
}

/// A model fitted to a recording.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model at its best.
    pub model: Model,
    /// What was moved.
    pub free: Vec<Free>,
    /// The readings as the model sees them.
    pub surprises: Vec<Surprise>,
    /// H at the best.
    information: DMatrix<f64>,
}

impl Fit {
    /// Σ ln p(ν) over the readings for which `counts` holds, nats.
    #[must_use]
    pub fn log_likelihood(&self, counts: impl Fn(usize) -> bool) -> f64 {
        self.surprises.iter().filter(|s| counts(s.row)).map(|s| s.log_density).sum()
    }

    /// Standard deviations of the moved numbers in their own scale, if the record determines them.
    #[must_use]
    pub fn deviations(&self) -> Option<Vec<f64>> {
        let covariance = self.information.clone().try_inverse()?;
        Some(covariance.diagonal().iter().map(|variance| variance.max(0.0).sqrt()).collect())
    }
}

/// What is to be fitted to what.
pub struct Problem<'a> {
    /// The rows.
    pub recording: &'a Recording,
    /// The owner's belief, which the prior holds to.
    pub belief: &'a Model,
    /// Which rows count.
    pub counts: &'a [bool],
}

impl Problem<'_> {
    /// Moves the numbers `free` of `start` to where the readings that count are most likely.
    #[must_use]
    pub fn fit(&self, start: &Model, free: &[Free]) -> Fit {
        self.fit_in_steps(start, free, MOST_STEPS)
    }

    /// The same in so many steps at most.
    #[must_use]
    pub fn fit_in_steps(&self, start: &Model, free: &[Free], most_steps: usize) -> Fit {
        let mut best = start.clone();
        let mut seen = surprises(&best, self.recording);
        let mut damping = 1e-3;
        let (mut gradient, mut information) = self.slope(&best, free, &seen);
        for _ in 0..most_steps {
            let found = self.step(&best, free, &seen, (&gradient, &information), &mut damping);
            let Some((model, there, gain)) = found else { break };
            (best, seen) = (model, there);
            (gradient, information) = self.slope(&best, free, &seen);
            if gain < GAIN_ENOUGH {
                break;
            }
        }
        Fit { model: best, free: free.to_vec(), surprises: seen, information }
    }

    /// Log-likelihood of the readings that count, and the prior.
    fn total(&self, model: &Model, free: &[Free], seen: &[Surprise]) -> f64 {
        let likelihood: f64 = seen.iter().filter(|s| self.counts[s.row]).map(|s| s.log_density).sum();
        let prior: f64 = free.iter().map(|free| (free.distance(model, self.belief) / free.doubt()).powi(2)).sum();
        likelihood - prior / 2.0
    }

    /// One damped scoring step: the better model, its readings and its gain in nats. `None`: none was found.
    fn step(
        &self,
        best: &Model,
        free: &[Free],
        seen: &[Surprise],
        (gradient, information): (&DVector<f64>, &DMatrix<f64>),
        damping: &mut f64,
    ) -> Option<(Model, Vec<Surprise>, f64)> {
        let before = self.total(best, free, seen);
        for _ in 0..6 {
            let mut damped = information.clone();
            for i in 0..free.len() {
                damped[(i, i)] = damped[(i, i)] * (1.0 + *damping) + 1e-9;
            }
            let direction = damped.cholesky().map(|factor| factor.solve(gradient))?;
            let model =
                free.iter().zip(direction.iter()).fold(best.clone(), |model, (free, by)| free.moved(&model, *by));
            let there = surprises(&model, self.recording);
            let gain = self.total(&model, free, &there) - before;
            if gain > 0.0 {
                *damping = (*damping * 0.2).max(1e-6);
                return Some((model, there, gain));
            }
            *damping *= 8.0;
        }
        None
    }

    /// Gradient and information of the likelihood and the prior at `model`.
    fn slope(&self, model: &Model, free: &[Free], seen: &[Surprise]) -> (DVector<f64>, DMatrix<f64>) {
        let nudged: Vec<Vec<Surprise>> =
            free.iter().map(|free| surprises(&free.moved(model, DIFFERENCE), self.recording)).collect();
        let (mut gradient, mut information) = (DVector::zeros(free.len()), DMatrix::zeros(free.len(), free.len()));
        for (k, s) in seen.iter().enumerate().filter(|(_, s)| self.counts[s.row]) {
            let deviation = s.variance_mm2.sqrt();
            let residual = |i: usize| (nudged[i][k].residual_mm - s.residual_mm) / DIFFERENCE / deviation;
            let spread = |i: usize| (nudged[i][k].variance_mm2 / s.variance_mm2).ln() / DIFFERENCE;
            let by: Vec<(f64, f64)> = (0..free.len()).map(|i| (residual(i), spread(i))).collect();
            let e = s.standardised();
            for (i, (residual, spread)) in by.iter().enumerate() {
                gradient[i] += s.weight * (-e * residual + 0.5 * (e * e - 1.0) * spread);
                for (j, (residual_j, spread_j)) in by.iter().enumerate() {
                    information[(i, j)] += s.weight * (residual * residual_j + 0.5 * spread * spread_j);
                }
            }
        }
        for (i, free) in free.iter().enumerate() {
            gradient[i] -= free.distance(model, self.belief) / free.doubt().powi(2);
            information[(i, i)] += 1.0 / free.doubt().powi(2);
        }
        (gradient, information)
    }
}

#[cfg(test)]
mod tests {
    use super::{BASE, Free, Problem};
    use crate::likelihood::in_free_flight;
    use crate::tests_support::{model, record};
    use plant::Model;

    #[test]
    fn a_fit_recovers_the_numbers_of_the_rig_within_their_own_deviations() {
        let rig = model();
        let wrong =
            Model { gain_mm_per_s2_per_percent: 200.0, drag_per_s: 2.5, hover_duty_percent: 21.6, ..rig.clone() };
        let free = [&BASE[..], &[Free::Effect { name: "fan_lag", index: 0, size: 0.1 }]].concat();
        let (mut inside, mut all) = (0, 0);
        for seed in 0..8 {
            let recording = record(&rig, seed, 60);
            let counts = in_free_flight(&rig, &recording);
            let problem = Problem { recording: &recording, belief: &rig, counts: &counts };
            let fitted = problem.fit(&wrong, &free);
            let deviations = fitted.deviations().unwrap();
            let off = [
                (fitted.model.gain_mm_per_s2_per_percent / rig.gain_mm_per_s2_per_percent).ln() / deviations[0],
                (fitted.model.drag_per_s / rig.drag_per_s).ln() / deviations[1],
                (fitted.model.hover_duty_percent - rig.hover_duty_percent) / 0.1 / deviations[2],
                (fitted.model.effects.fan_lag.unwrap().time_constant_s - 0.2) / 0.1 / deviations[5],
            ];
            assert!(off.iter().all(|off| off.abs() < 4.5), "seed {seed}: {off:?}");
            inside += off.iter().filter(|off| off.abs() < 1.645).count();
            all += off.len();
        }
        // 90 % of 32 is 28.8; fewer than 24 has a chance of 1 %.
        assert!(inside >= 24, "{inside} of {all} within their 90 % intervals");
    }
}
