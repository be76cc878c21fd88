//! The model that forecasts best where a residual remains.
//!
//! A wrong model that maximises the likelihood of the next reading may forecast a second worse than the belief does. So
//! the belief, its refit, and the fits with the effects that were found are compared by their held-out forecast errors at
//! 1 s. A model takes the place of a simpler one where it is better in the mean of the stretches by more than chance.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::Parameter;
use crate::gap::forecast_error::{Gap, Tally, tallies};
use crate::record::folds::Folds;
use crate::select::candidates::Candidate;
use crate::select::search::Search;
use crate::thresholds::{BETTER_FORECAST, LARGER};
use plant::Model;
use rayon::prelude::*;

/// A model with its held-out forecast errors by stretch, and its held-out log-likelihood.
pub(crate) struct Evaluated {
    pub(crate) fit: Fit,
    /// The models fitted without each fold.
    pub(crate) without_each_fold: Vec<Model>,
    pub(crate) errors: Vec<Tally>,
    /// Plus the log-prior, nats.
    pub(crate) log_likelihood: f64,
}

impl Evaluated {
    pub(crate) fn of(search: &Search<'_>, fit: Fit) -> Self {
        let without_each_fold = search.problem.without_each_fold(&fit);
        let errors = with_own_noise(search, &without_each_fold);
        let log_likelihood = search.held_out_total(&fit);
        Self { fit, without_each_fold, errors, log_likelihood }
    }

    /// The belief, of which nothing is fitted.
    pub(crate) fn belief(search: &Search<'_>) -> Self {
        let belief = search.problem.belief;
        let fit = match search.slow_noise() {
            Some(noise) => search.problem.fit(&Model { noise, ..belief.clone() }, &[Parameter::NoiseLevel]),
            None => search.problem.fit(belief, &[]),
        };
        let log_likelihood = search.held_out_total(&fit);
        let without_each_fold = vec![belief.clone(); Folds::COUNT];
        Self { errors: of_belief(search), without_each_fold, fit, log_likelihood }
    }

    /// Mean square at 1 s over all stretches, mm²; 0 if the record is too short.
    pub(crate) fn square(&self) -> f64 {
        Tally::sum(self.errors.iter()).squares_at_1_s().map_or(0.0, |(square, _)| square)
    }

    /// Root mean squares over all stretches.
    pub(crate) fn gap(&self) -> Gap {
        Tally::sum(self.errors.iter()).gap()
    }

    /// The same, with the errors by noise alone: of the model with the noise that was fitted, or with the believed noise,
    /// whichever is less, since a fitted noise takes in what the model lacks; at most the errors themselves.
    pub(crate) fn gap_with_floor(&self, search: &Search<'_>) -> Gap {
        let as_believed = with_believed_noise(search, &self.without_each_fold);
        self.gap().with_floor_at_most(&Tally::sum(as_believed.iter()).gap())
    }
}

/// The index of the best of these models, of which the first is the belief.
pub(crate) fn best_forecast(search: &Search<'_>, models: &[Evaluated]) -> usize {
    let (mut least, mut best) = (models[0].errors.clone(), 0);
    for (at, model) in models.iter().enumerate().skip(1) {
        // A patch does not change the noise.
        let errors = with_believed_noise(search, &model.without_each_fold);
        if deviations(&least, &errors) > BETTER_FORECAST {
            (least, best) = (errors, at);
        }
    }
    best
}

/// Whether `these` forecasts are better than `those` in the mean of the stretches by more than chance.
pub(crate) fn forecasts_better(search: &Search<'_>, this: &Evaluated, that: &Evaluated) -> bool {
    let errors = |of: &Evaluated| with_believed_noise(search, &of.without_each_fold);
    deviations_at_all_horizons(&errors(that), &errors(this)) > BETTER_FORECAST
}

/// Whether the held-out forecasts of `this` are worse than those of `that` by more than chance, each with its own noise.
pub(crate) fn forecasts_worse(search: &Search<'_>, this: &Fit, that: &Fit) -> bool {
    deviations_at_all_horizons(&errors_of(search, this), &errors_of(search, that)) > BETTER_FORECAST
}

/// Whether `this` is the better fit on held-out stretches, and forecasts no worse.
pub(crate) fn is_better(search: &Search<'_>, this: &Fit, that: &Fit) -> bool {
    search.held_out_total(this) > search.held_out_total(that) && !forecasts_worse(search, this, that)
}

/// Held-out forecast errors of a fit, by stretch of the record, with its own noise.
fn errors_of(search: &Search<'_>, fit: &Fit) -> Vec<Tally> {
    with_own_noise(search, &search.problem.without_each_fold(fit))
}

/// Held-out forecast errors of the models fitted without each fold, by stretch of the record, each with its own noise.
pub(crate) fn with_own_noise(search: &Search<'_>, models: &[Model]) -> Vec<Tally> {
    held_out(search, models, |model| search.forecasting(model))
}

/// Whether a fit loses track: at a horizon the mean square of its held-out forecasts is larger than without its last
/// effect. A likelihood of the next reading can gain by that, where readings are coarse or most of them show a rest.
pub(crate) fn loses_track(search: &Search<'_>, with: &Candidate, without: &Fit) -> bool {
    let squares = |errors: &[Tally]| Tally::sum(errors.iter()).squares();
    let with = with_own_noise(search, &with.without_each_fold);
    let pairs = squares(&with).zip(squares(&errors_of(search, without)));
    pairs.is_some_and(|(with, without)| with.iter().zip(without).any(|(with, without)| *with > LARGER * without))
}

/// Held-out forecast errors of the models fitted without each fold, by stretch of the record, with the noise of the
/// belief.
pub(crate) fn with_believed_noise(search: &Search<'_>, models: &[Model]) -> Vec<Tally> {
    held_out(search, models, |model| Model { noise: search.problem.belief.noise, ..model.clone() })
}

/// Forecast errors of the belief, by stretch of the record.
fn of_belief(search: &Search<'_>) -> Vec<Tally> {
    let Problem { recording, folds, belief, .. } = search.problem;
    tallies(belief, recording, &|row| folds.stretch(row))
}

/// Held-out forecast errors by stretch of the record: each under the model that was fitted without its fold, as `change`
/// makes it.
fn held_out(search: &Search<'_>, models: &[Model], change: impl Fn(&Model) -> Model + Sync) -> Vec<Tally> {
    let Problem { recording, folds, .. } = search.problem;
    let one = |(fold, model): (usize, &Model)| {
        tallies(&change(model), recording, &|row| folds.stretch(row).filter(|_| folds.of(row) == Some(fold)))
    };
    let parts: Vec<Vec<Tally>> = models.par_iter().enumerate().map(one).collect();
    let longest = parts.iter().map(Vec::len).max().unwrap_or_default();
    (0..longest).map(|at| Tally::sum(parts.iter().filter_map(|part| part.get(at)))).collect()
}

/// By how many standard errors over the stretches the mean square at 1 s is larger in `these`; 0 where that cannot be
/// told.
pub(crate) fn deviations(these: &[Tally], those: &[Tally]) -> f64 {
    let square = |tally: &Tally| tally.squares_at_1_s().map(|(square, _)| square);
    standard_errors(these.iter().zip(those).filter_map(|(this, that)| Some(square(this)? - square(that)?)))
}

/// The same of the mean square of free runs.
pub(crate) fn deviations_of_free_runs(these: &[Tally], those: &[Tally]) -> f64 {
    let fall = |(this, that): (&Tally, &Tally)| Some(this.square_of_free_runs()? - that.square_of_free_runs()?);
    standard_errors(these.iter().zip(those).filter_map(fall))
}

/// The same of the mean squares at all horizons, each as a share of that of `these` in all stretches.
pub(crate) fn deviations_at_all_horizons(these: &[Tally], those: &[Tally]) -> f64 {
    let Some(whole) = Tally::sum(these.iter()).squares() else { return 0.0 };
    let fall = |(this, that): (&Tally, &Tally)| {
        let (this, that) = (this.squares()?, that.squares()?);
        Some((0..whole.len()).map(|at| (this[at] - that[at]) / whole[at]).sum())
    };
    standard_errors(these.iter().zip(those).filter_map(fall))
}

/// The mean of some numbers over its standard error; 0 where that is no number.
fn standard_errors(numbers: impl Iterator<Item = f64>) -> f64 {
    let numbers: Vec<f64> = numbers.collect();
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let variance = numbers.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let errors = mean / (variance / count).sqrt();
    if errors.is_finite() { errors } else { 0.0 }
}
