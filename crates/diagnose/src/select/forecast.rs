//! The model that forecasts best where a residual remains.
//!
//! A wrong model that maximises the likelihood of the next reading may forecast a second worse than the belief does. So
//! the belief, its refit, and the fits with the effects that were found are compared by their held-out forecast errors at
//! 1 s. A model takes the place of a simpler one where it is better in the mean of the stretches by more than chance.

use crate::filter::track::{Track, Variances};
use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::Parameter;
use crate::gap::bootstrap::is_lower;
use crate::gap::forecast_error::{Gap, Tally, tallies};
use crate::record::folds::Folds;
use crate::select::candidates::Candidate;
use crate::select::search::Search;
use crate::thresholds::{BETTER_FORECAST, LARGER};
use plant::{Entry, Model};
use rayon::prelude::*;

/// A model with its held-out forecast errors by stretch, and its held-out log-likelihood.
#[derive(Clone)]
pub(crate) struct Evaluated {
    pub(crate) fit: Fit,
    /// The models fitted without each fold.
    pub(crate) without_each_fold: Vec<Model>,
    /// With the noise that was fitted, or with the believed noise, whichever forecasts better.
    pub(crate) errors: Vec<Tally>,
    /// With the noise after a patch: the believed one, because a patch leaves it. Where that hides what the belief
    /// lacks, a patch replaces it, and these are `errors`.
    pub(crate) of_patch: Vec<Tally>,
    /// Plus the log-prior, nats.
    pub(crate) log_likelihood: f64,
}

impl Evaluated {
    pub(crate) fn of(search: &Search<'_>, fit: Fit) -> Self {
        let (without_each_fold, held_out) = search.problem.cross_validated(&fit);
        Self::with(search, fit, without_each_fold, held_out.iter().sum())
    }

    /// A fit with the models fitted without each fold, and their held-out log-likelihood.
    fn with(search: &Search<'_>, fit: Fit, without_each_fold: Vec<Model>, held_out: f64) -> Self {
        let log_likelihood = held_out + fit.log_prior;
        let [errors, of_patch] = errors_and_of_patch(search, &without_each_fold, Variances::Omitted);
        Self { fit, without_each_fold, errors, of_patch, log_likelihood }
    }

    /// The refit of the belief. Where it forecasts worse than the belief, no number of it is taken but the noise: an
    /// effect that the model lacks, such as stale readings, can bias the fit by the next reading so far.
    pub(crate) fn refit(search: &Search<'_>, refitted: &Fit, belief: &Self) -> Self {
        let refit = Self::of(search, refitted.clone());
        if refit.square() <= belief.square() {
            return refit;
        }
        let noise: Vec<Parameter> = refitted.parameters.iter().filter(|one| one.is_noise()).copied().collect();
        Self::of(search, search.problem.fit(search.problem.belief, &noise))
    }

    /// The model with one effect more, `self`, if it forecasts no worse than the model `below` without it. Else that
    /// model with the effect and the noise fitted and all other numbers kept, if that forecasts better: where something
    /// is missing, a fit with an effect of the scatter can bias the other parameters.
    pub(crate) fn or_with_numbers_kept(self, search: &Search<'_>, below: &Self, entry: &Entry) -> Self {
        let values = self.fit.model.effects.values(entry.name).filter(|_| self.square() > below.square());
        let Some(values) = values else { return self };
        let own = |parameter: &&Parameter| parameter.is_noise() || parameter.is_of(entry.name);
        let fitted: Vec<Parameter> = self.fit.parameters.iter().filter(own).copied().collect();
        let mut start = below.fit.model.clone();
        start.effects.set(entry.name, &values);
        let fit = search.problem.fit(&start, &fitted);
        let kept = |(own, below): (Model, &Model)| {
            let mut model = Model { noise: own.noise, ..below.clone() };
            model.effects.set(entry.name, &own.effects.values(entry.name).unwrap_or_default());
            model
        };
        let own = search.problem.without_each_fold(&fit);
        let without_each_fold: Vec<Model> = own.into_iter().zip(&below.without_each_fold).map(kept).collect();
        let by_fold = without_each_fold.iter().enumerate().map(|(fold, model)| search.problem.by_fold(model)[fold]);
        let held_out = by_fold.sum();
        let fit = search.problem.at(fit.model, &self.fit.parameters);
        let with = Self::with(search, fit, without_each_fold, held_out);
        if with.square() < self.square() { with } else { self }
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
        let errors = of_belief(search);
        Self { of_patch: errors.clone(), errors, without_each_fold, fit, log_likelihood }
    }

    /// Mean square at 1 s over all stretches, mm²; 0 if the record is too short.
    pub(crate) fn square(&self) -> f64 {
        Tally::sum(self.errors.iter()).square_at_1_s().unwrap_or(0.0)
    }

    /// Root mean squares over all stretches, without the errors by noise alone.
    pub(crate) fn gap(&self) -> Gap {
        Tally::sum(self.errors.iter()).gap()
    }

    /// The same, with the errors by noise alone: of the model with the noise that was fitted, or with the believed noise,
    /// whichever is less, since a fitted noise takes in what the model lacks; at most the errors themselves.
    pub(crate) fn gap_with_floor(&self, search: &Search<'_>) -> Gap {
        let [errors, of_patch] = errors_and_of_patch(search, &self.without_each_fold, Variances::Computed);
        Tally::sum(errors.iter()).gap().with_floor_at_most(&Tally::sum(of_patch.iter()).gap())
    }
}

/// [`Evaluated::errors`] and [`Evaluated::of_patch`] of the models fitted without each fold.
fn errors_and_of_patch(search: &Search<'_>, models: &[Model], variances: Variances) -> [Vec<Tally>; 2] {
    let believed = with_believed_noise(search, models, variances);
    // A search by forecasts fits no noise: both are the same.
    let own = if search.is_by_forecasts() { None } else { Some(with_own_noise(search, models, variances)) };
    let errors = own.map_or_else(|| believed.clone(), |own| better(own, believed.clone()));
    let of_patch = if search.noise_hides { errors.clone() } else { believed };
    [errors, of_patch]
}

/// The index of the best of these models, of which the first is the belief.
pub(crate) fn best_forecast(models: &[Evaluated]) -> usize {
    let errors = |at: usize| &models[at].of_patch;
    (1..models.len()).fold(0, |best, at| if is_lower(errors(at), errors(best)) { at } else { best })
}

/// Whether the forecasts of `this` are better than those of `that` in the mean of the stretches by more than chance.
pub(crate) fn forecasts_better(this: &Evaluated, that: &Evaluated) -> bool {
    deviations_at_all_horizons(&that.of_patch, &this.of_patch) > BETTER_FORECAST
}

/// Whether the held-out forecasts of `this` are worse than those of `that` by more than chance, each with its own noise.
pub(crate) fn forecasts_worse(search: &Search<'_>, this: &Fit, that: &Fit) -> bool {
    deviations_at_all_horizons(&errors_of(search, this), &errors_of(search, that)) > BETTER_FORECAST
}

/// Whether `this` is the better fit on held-out stretches, and forecasts no worse.
pub(crate) fn is_better(search: &Search<'_>, this: &Fit, that: &Fit) -> bool {
    search.held_out_total(this) > search.held_out_total(that) && !forecasts_worse(search, this, that)
}

/// Error of the forecasts 1 s ahead of a model as it is, in the rows that count, mm; `None`: the record is too short.
pub(crate) fn error_at_1_s(search: &Search<'_>, model: &Model) -> Option<f64> {
    let Problem { recording, folds, .. } = search.problem;
    let model = search.forecasting(model);
    let errors = tallies(&Track::with(Variances::Omitted, &model, recording), &|row| folds.of(row).map(|_| 0));
    Tally::sum(errors.iter()).gap().error_mm[2]
}

/// Held-out forecast errors of a fit, by stretch of the record, with its own noise.
fn errors_of(search: &Search<'_>, fit: &Fit) -> Vec<Tally> {
    with_own_noise(search, &search.problem.without_each_fold(fit), Variances::Omitted)
}

/// Held-out forecast errors of the models fitted without each fold, by stretch of the record, each with its own noise.
fn with_own_noise(search: &Search<'_>, models: &[Model], variances: Variances) -> Vec<Tally> {
    held_out(search, models, variances, |model| search.forecasting(model))
}

/// Whether a fit loses track: at a horizon the mean square of its held-out forecasts is larger than without its last
/// effect. A likelihood of the next reading can gain by that, where readings are coarse or most of them show a rest.
pub(crate) fn loses_track(search: &Search<'_>, with: &Candidate, without: &Fit) -> bool {
    let squares = |errors: &[Tally]| Tally::sum(errors.iter()).squares();
    let with = with_own_noise(search, &with.without_each_fold, Variances::Omitted);
    let pairs = squares(&with).zip(squares(&errors_of(search, without)));
    pairs.is_some_and(|(with, without)| with.iter().zip(without).any(|(with, without)| *with > LARGER * without))
}

/// The errors with the noise that was fitted, or with the believed noise, whichever are less: a fitted noise takes in
/// what the model lacks, and then the filter weighs the readings wrongly.
fn better(own: Vec<Tally>, with_believed_noise: Vec<Tally>) -> Vec<Tally> {
    let square = |errors: &[Tally]| Tally::sum(errors.iter()).square_at_1_s().unwrap_or(f64::INFINITY);
    if square(&with_believed_noise) < square(&own) { with_believed_noise } else { own }
}

/// Held-out forecast errors of the models fitted without each fold, by stretch of the record, with the noise that a
/// patch leaves.
pub(crate) fn of_patch(search: &Search<'_>, models: &[Model]) -> Vec<Tally> {
    let believed = with_believed_noise(search, models, Variances::Omitted);
    if search.noise_hides { better(with_own_noise(search, models, Variances::Omitted), believed) } else { believed }
}

/// Held-out forecast errors of the models fitted without each fold, by stretch of the record, with the noise of the
/// belief.
fn with_believed_noise(search: &Search<'_>, models: &[Model], variances: Variances) -> Vec<Tally> {
    held_out(search, models, variances, |model| Model { noise: search.problem.belief.noise, ..model.clone() })
}

/// Forecast errors of the belief, by stretch of the record.
fn of_belief(search: &Search<'_>) -> Vec<Tally> {
    let Problem { recording, folds, belief, .. } = search.problem;
    tallies(&Track::with(Variances::Omitted, belief, recording), &|row| folds.stretch(row))
}

/// Held-out forecast errors by stretch of the record: each under the model that was fitted without its fold, as `change`
/// makes it.
fn held_out(
    search: &Search<'_>,
    models: &[Model],
    variances: Variances,
    change: impl Fn(&Model) -> Model + Sync,
) -> Vec<Tally> {
    let Problem { recording, folds, .. } = search.problem;
    let one = |(fold, model): (usize, &Model)| {
        let model = change(model);
        tallies(&Track::with(variances, &model, recording), &|row| {
            folds.stretch(row).filter(|_| folds.of(row) == Some(fold))
        })
    };
    let parts: Vec<Vec<Tally>> = models.par_iter().enumerate().map(one).collect();
    let longest = parts.iter().map(Vec::len).max().unwrap_or_default();
    (0..longest).map(|at| Tally::sum(parts.iter().filter_map(|part| part.get(at)))).collect()
}

/// By how many standard errors over the stretches the mean square at 1 s is larger in `these`; 0 where that cannot be
/// told.
pub(crate) fn deviations(these: &[Tally], those: &[Tally]) -> f64 {
    let rise = |(this, that): (&Tally, &Tally)| Some(this.square_at_1_s()? - that.square_at_1_s()?);
    standard_errors(these.iter().zip(those).filter_map(rise))
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
pub(crate) fn standard_errors(numbers: impl Iterator<Item = f64>) -> f64 {
    let numbers: Vec<f64> = numbers.collect();
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let variance = numbers.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let errors = mean / (variance / count).sqrt();
    if errors.is_finite() { errors } else { 0.0 }
}
