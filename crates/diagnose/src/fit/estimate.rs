//! Fitting a model to a recording: maximum a posteriori estimation by Fisher scoring.
//!
//! ```text
//! L = Σ ln p(ν_k) + ln prior(θ)   ν_k = y_k − ŷ_k, S_k: innovation and its variance, functions of the parameters θ
//! g = Σ w·( ν·∂ŷ/S + ½·(ν²/S − 1)·∂lnS )
//! H = Σ w·( ∂ŷ·∂ŷᵀ/S + ½·∂lnS·∂lnSᵀ )          Levenberg–Marquardt: (H + λ·diag H)·δ = g
//! ```
//!
//! Parameters of p itself, such as the share of outliers, add their scores: g = Σ ∂ln p, H = Σ ∂ln p·∂ln pᵀ.
//! Derivatives are differences of whole filter runs, in the scales of [`Parameter`], so that one λ suits all. After
//! each step further ones are tried with the same derivatives, which take a single run each (the chord method).
//! Gradient and information are kept by fold, so that a fit without a fold takes one step. The covariance of θ is H⁻¹
//! when the model is right.
//! Source: Gupta and Mehra, "Computational aspects of maximum likelihood estimation", IEEE TAC 19 (1974).

use crate::filter::innovation::Innovation;
use crate::filter::track::innovations;
use crate::fit::bounds::Bounds;
use crate::fit::derivatives::{Derivatives, KnownSensitivities, NONE_KNOWN, Sensitivities};
use crate::fit::held_out::or_impossible;
use crate::fit::parameter::{Parameter, Prior, prior};
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::thresholds::LONG;
use nalgebra::{DMatrix, DVector};
use plant::Model;

/// Most scoring steps; a fit that needs more moves along a ridge of the likelihood that the record does not determine.
const STEPS: usize = 15;
/// The same while the slope is steep: from a believed noise far too large, a step reduces it by a factor of e at most.
const MOST_STEPS: usize = 60;
/// The fit ends after a step that gains less than this, nats.
pub(crate) const GAIN_ENOUGH: f64 = 0.05;
/// A step that gains more than this, nats on a record of usual length, is on a steep slope, and the fit continues.
const STEEP: f64 = 20.0;
/// Information below which the record does not determine a parameter.
const NOTHING_TOLD: f64 = 1e-6;
/// A step is shortened this many times, and further while it is predicted to gain this many nats.
pub(crate) const SHORTER: usize = 6;
const PROMISING: f64 = 1.0;
const SHORTEST: usize = 14;

/// Most steps with the derivatives of an earlier point, each of which must gain. No other number was tried.
const CHORDS: usize = 3;
/// Step of the numerical derivative of a number of the model by a parameter, in the scale of the parameter.
const SLIGHTLY: f64 = 1e-3;

/// A model fitted to a recording.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model at the maximum.
    pub model: Model,
    /// The fitted parameters.
    pub parameters: Vec<Parameter>,
    /// The innovations of the readings under the model.
    pub innovations: Vec<Innovation>,
    /// ln prior at the maximum, up to a constant.
    pub log_prior: f64,
    pub(crate) slope: Derivatives,
}

impl Fit {
    /// Σ ln p(ν) over the readings for which `counts` holds, nats.
    #[must_use]
    pub fn log_likelihood(&self, counts: impl Fn(usize) -> bool) -> f64 {
        self.innovations.iter().filter(|s| counts(s.row)).map(|s| s.log_density).sum()
    }

    /// Standard deviations of the fitted parameters in their own scale; infinite where the record does not determine a
    /// parameter.
    #[must_use]
    pub fn deviations(&self) -> Vec<f64> {
        let deviation = |variance: &f64| if *variance > 0.0 { variance.sqrt() } else { f64::INFINITY };
        self.covariance().diagonal().iter().map(deviation).collect()
    }

    /// Standard deviation of a number of the model, from the covariance of the fitted parameters. What the record does
    /// not determine is left out.
    #[must_use]
    pub fn deviation_of(&self, number: impl Fn(&Model) -> f64) -> f64 {
        let covariance = self.covariance().map(|entry| if entry.is_finite() { entry } else { 0.0 });
        let slope = self.parameters.iter().map(|parameter| {
            let by = |step: f64| number(&parameter.stepped(&self.model, step));
            (by(SLIGHTLY) - by(-SLIGHTLY)) / (2.0 * SLIGHTLY)
        });
        let slope = DVector::from_iterator(self.parameters.len(), slope);
        slope.dot(&(&covariance * &slope)).max(0.0).sqrt()
    }

    /// Covariance of the fitted parameters in their own scale; a variance is infinite where the record does not
    /// determine a parameter.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        let information = self.slope.total(None).1;
        let told: Vec<usize> = (0..self.parameters.len()).filter(|i| information[(*i, *i)] > NOTHING_TOLD).collect();
        let mut covariance =
            DMatrix::from_diagonal_element(self.parameters.len(), self.parameters.len(), f64::INFINITY);
        if let Some(known) = information.select_rows(&told).select_columns(&told).try_inverse() {
            for (i, row) in told.iter().enumerate() {
                for (j, column) in told.iter().enumerate() {
                    covariance[(*row, *column)] = known[(i, j)];
                }
            }
        }
        covariance
    }
}

/// A fitting problem.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// The rows.
    pub recording: &'a Recording,
    /// The owner's belief, the centre of the prior.
    pub belief: &'a Model,
    /// Which rows count, and in which fold.
    pub folds: &'a Folds,
    /// The prior.
    pub prior: Prior,
}

/// Limits of the number of steps.
#[derive(Clone, Copy)]
struct StepLimits {
    /// Steps.
    steps: usize,
    /// Further steps after each on a steep slope.
    more: usize,
    /// Most steps in total.
    most: usize,
}

/// A model during a fit, with its innovations and its log-posterior.
pub(super) struct Point {
    pub(super) model: Model,
    pub(super) innovations: Vec<Innovation>,
    total: f64,
}

impl Problem<'_> {
    /// Moves `parameters` of `start` to the maximum of the posterior of the readings that count.
    #[must_use]
    pub fn fit(&self, start: &Model, parameters: &[Parameter]) -> Fit {
        let limits = StepLimits { steps: STEPS, more: STEPS, most: MOST_STEPS };
        let (best, slope) = self.maximise(start, parameters, limits, &NONE_KNOWN);
        self.fit_of(best, parameters, slope)
    }

    /// A model as it is, with the derivatives by `parameters` there.
    pub(crate) fn at(&self, model: Model, parameters: &[Parameter]) -> Fit {
        self.fit_of(self.point(model, parameters), parameters, None)
    }

    /// The fit that ends at `point`; `slope`: the derivatives there, if they are computed already.
    fn fit_of(&self, point: Point, parameters: &[Parameter], slope: Option<Derivatives>) -> Fit {
        let slope = slope.unwrap_or_else(|| self.slope(&point, parameters));
        let log_prior = self.log_prior(parameters, &point.model);
        Fit { model: point.model, parameters: parameters.to_vec(), innovations: point.innovations, log_prior, slope }
    }

    /// The model after at most this many steps.
    #[must_use]
    pub fn fit_in_steps(&self, start: &Model, parameters: &[Parameter], most_steps: usize) -> Model {
        let limits = StepLimits { steps: most_steps, more: 0, most: most_steps };
        self.maximise(start, parameters, limits, &NONE_KNOWN).0.model
    }

    /// A short fit, for screening: the model after `steps` steps, and more while the slope is steep; with its
    /// log-likelihood and log-prior in total, nats.
    pub(crate) fn fit_briefly(&self, start: &Model, parameters: &[Parameter], steps: usize) -> (Model, f64) {
        self.fit_briefly_with(&NONE_KNOWN, start, parameters, steps)
    }

    /// The same with derivatives that are known, which cost no runs; the others are computed at each step.
    pub(crate) fn fit_briefly_with(
        &self,
        known: &KnownSensitivities,
        start: &Model,
        parameters: &[Parameter],
        steps: usize,
    ) -> (Model, f64) {
        let (best, _) = self.maximise(start, parameters, StepLimits { steps, more: 1, most: STEPS }, known);
        (best.model, best.total)
    }

    /// The bounds of each parameter on this record.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.belief, self.recording)
    }

    /// The model with every parameter moved along `direction`, within its bounds.
    pub(crate) fn moved(&self, model: &Model, parameters: &[Parameter], direction: &DVector<f64>) -> Model {
        let step = |model: Model, (parameter, by): (&Parameter, &f64)| parameter.stepped(&model, *by);
        let moved = parameters.iter().zip(direction.iter()).fold(model.clone(), step);
        self.bounds().clamped(moved, parameters)
    }

    /// Log-likelihood and log-prior of a fit in total, nats.
    pub(crate) fn total_of(&self, fit: &Fit) -> f64 {
        fit.log_likelihood(|row| self.folds.counts(row)) + fit.log_prior
    }

    /// Log-likelihood and log-prior of `model` in total, without a fit, nats.
    pub(crate) fn total(&self, model: &Model, parameters: &[Parameter]) -> f64 {
        self.point(model.clone(), parameters).total
    }

    /// Maximises from `start`. The derivatives are those before the last step, if that step gained almost nothing.
    fn maximise(
        &self,
        start: &Model,
        parameters: &[Parameter],
        patience: StepLimits,
        known: &KnownSensitivities,
    ) -> (Point, Option<Derivatives>) {
        // A noise of 0 has no slope: each parameter starts within its bounds.
        let mut best = self.point(self.moved(start, parameters, &DVector::zeros(parameters.len())), parameters);
        let steep = STEEP * (self.recording.readings() as f64 / LONG).max(1.0);
        let (mut damping, mut end) = (1e-3, patience.steps);
        for taken in 1..=patience.most {
            if taken > end {
                break;
            }
            let before = best.total;
            let sensitivities = self.sensitivities(&best.model, &best.innovations, parameters, known);
            let slope = self.derivatives(&best, parameters, &sensitivities);
            let Some(next) = self.step(&best, parameters, &slope.total(None), &mut damping) else {
                return (best, Some(slope));
            };
            best = next;
            if best.total - before < GAIN_ENOUGH {
                return (best, Some(slope));
            }
            for _ in 0..CHORDS {
                let Some(next) = self.chord(&best, parameters, &sensitivities, damping) else { break };
                best = next;
            }
            if best.total - before >= steep {
                end = end.max(taken + patience.more);
            }
        }
        (best, None)
    }

    /// ln prior of `parameters` in `model`, up to a constant; 0 without a prior.
    pub(crate) fn log_prior(&self, parameters: &[Parameter], model: &Model) -> f64 {
        if self.prior == Prior::Belief { prior(parameters, model, self.belief) } else { 0.0 }
    }

    /// The innovations of the readings under `model`, weighted.
    pub(super) fn innovations(&self, model: &Model) -> Vec<Innovation> {
        let mut all = innovations(model, self.recording);
        let weight = self.folds.weight();
        if weight < 1.0 {
            all.iter_mut().for_each(|one| one.weigh(weight));
        }
        all
    }

    fn point(&self, model: Model, parameters: &[Parameter]) -> Point {
        let innovations = self.innovations(&model);
        let likelihood: f64 =
            innovations.iter().filter(|s| self.folds.of(s.row).is_some()).map(|s| s.log_density).sum();
        let total = or_impossible(likelihood + self.log_prior(parameters, &model));
        Point { model, innovations, total }
    }

    /// One damped scoring step to a better point. `None`: none was found.
    fn step(
        &self,
        best: &Point,
        parameters: &[Parameter],
        (gradient, information): &(DVector<f64>, DMatrix<f64>),
        damping: &mut f64,
    ) -> Option<Point> {
        for shortened in 0..SHORTEST {
            let direction = damped(information.clone(), *damping).cholesky()?.solve(gradient);
            if shortened >= SHORTER && 0.5 * gradient.dot(&direction) < PROMISING {
                return None;
            }
            let there = self.point(self.moved(&best.model, parameters, &direction), parameters);
            if there.total > best.total {
                *damping = (*damping * 0.2).max(1e-6);
                return Some(there);
            }
            *damping *= 8.0;
        }
        None
    }

    /// A full scoring step with the derivatives of an earlier point. `None`: it gains too little.
    fn chord(
        &self,
        best: &Point,
        parameters: &[Parameter],
        sensitivities: &Sensitivities,
        damping: f64,
    ) -> Option<Point> {
        if parameters.iter().any(|parameter| parameter.is_of_the_density()) {
            return None;
        }
        let (gradient, information) = self.derivatives(best, parameters, sensitivities).total(None);
        let direction = damped(information, damping).cholesky()?.solve(&gradient);
        if gradient.dot(&direction) < GAIN_ENOUGH {
            return None;
        }
        let there = self.point(self.moved(&best.model, parameters, &direction), parameters);
        (there.total > best.total + GAIN_ENOUGH).then_some(there)
    }
}

/// Information with a share of its diagonal added.
fn damped(mut information: DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    for i in 0..information.nrows() {
        information[(i, i)] = information[(i, i)] * (1.0 + damping) + 1e-9;
    }
    information
}

#[cfg(test)]
mod tests;
