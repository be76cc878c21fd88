//! The model that forecasts best where a residual remains.
//!
//! A wrong model that maximises the likelihood of the next reading may forecast a second worse than the belief does. So
//! the belief, its refit, and the fit with the effects that were found are compared by their held-out forecast errors at
//! 1 s. A model takes the place of a simpler one where it is better in the mean of the stretches by more than chance.

use crate::answer::ladder::deviations;
use crate::fit::estimate::{Fit, Problem};
use crate::gap::forecast_error::{Gap, Tally, tallies};
use crate::select::search::Search;
use crate::thresholds::BETTER_FORECAST;
use plant::Model;
use rayon::prelude::*;

/// The best of these models, of which the first is the belief.
pub(super) fn best_forecast(search: &Search<'_>, fits: &[Fit]) -> Fit {
    let (mut least, mut best) = (of_belief(search), None);
    for fit in fits.iter().skip(1) {
        // A patch does not change the noise.
        let errors = held_out(search, fit, |model| model.noise = search.problem.belief.noise);
        if is_better(&errors, &least) {
            (least, best) = (errors, Some(fit));
        }
    }
    best.map_or_else(|| search.problem.fit(search.problem.belief, &[]), Clone::clone)
}

/// Forecast errors of the belief, by stretch of the record.
pub(super) fn of_belief(search: &Search<'_>) -> Vec<Tally> {
    let Problem { recording, folds, belief, .. } = search.problem;
    tallies(belief, recording, &|row| folds.stretch(row))
}

/// Held-out forecast errors of a fit, by stretch of the record: each under the model that was fitted without its fold,
/// changed by `change`.
pub(super) fn held_out(search: &Search<'_>, fit: &Fit, change: impl Fn(&mut Model)) -> Vec<Tally> {
    let Problem { recording, folds, .. } = search.problem;
    let mut models = search.problem.without_each_fold(fit);
    models.iter_mut().for_each(change);
    let one = |(fold, model): (usize, &Model)| {
        tallies(model, recording, &|row| folds.stretch(row).filter(|_| folds.of(row) == Some(fold)))
    };
    let parts: Vec<Vec<Tally>> = models.par_iter().enumerate().map(one).collect();
    let longest = parts.iter().map(Vec::len).max().unwrap_or_default();
    (0..longest).map(|at| Tally::sum(parts.iter().filter_map(|part| part.get(at)))).collect()
}

/// Mean square at 1 s over all stretches, mm²; 0 if the record is too short.
pub(super) fn square(errors: &[Tally]) -> f64 {
    Tally::sum(errors.iter()).squares_at_1_s().map_or(0.0, |(square, _)| square)
}

/// The errors of a fit, with those by noise alone: of the model with the noise that was fitted, or with the believed
/// noise, whichever is less, since a fitted noise takes in what the model lacks; at most the errors themselves.
pub(super) fn with_floor(search: &Search<'_>, fit: &Fit, errors: &[Tally]) -> Gap {
    let as_believed = held_out(search, fit, |model| model.noise = search.problem.belief.noise);
    Tally::sum(errors.iter()).gap().with_floor_at_most(&Tally::sum(as_believed.iter()).gap())
}

/// Whether the mean squares at 1 s are lower in the mean of the stretches by more than chance.
fn is_better(these: &[Tally], those: &[Tally]) -> bool {
    deviations(those, these) > BETTER_FORECAST
}
