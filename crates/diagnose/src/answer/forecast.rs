//! The model that forecasts best where a residual remains.
//!
//! A wrong model that maximises the likelihood of the next reading may forecast a second worse than the belief does. So
//! the belief, its refit, and the fit with the effects that were found are compared by their held-out forecast errors at
//! 1 s. A model takes the place of a simpler one where it is better in the mean of the stretches by more than chance.

use crate::fit::estimate::{Fit, Problem};
use crate::gap::forecast_error::{Tally, tallies};
use crate::select::search::Search;
use crate::thresholds::BETTER_FORECAST;
use plant::Model;
use rayon::prelude::*;

/// The best of the belief and the fits.
pub(super) fn best_forecast(search: &Search<'_>, refitted: &Fit, with_effects: &Fit) -> Fit {
    let (mut least, mut best) = (of_belief(search), None);
    for fit in [refitted, with_effects] {
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

/// Whether the mean squares at 1 s are lower in the mean of the stretches by more than chance.
fn is_better(these: &[Tally], those: &[Tally]) -> bool {
    let square = |tally: &Tally| tally.squares_at_1_s().map(|(square, _)| square);
    let gains: Vec<f64> =
        these.iter().zip(those).filter_map(|(this, that)| Some(square(that)? - square(this)?)).collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean > BETTER_FORECAST * (variance / count).sqrt()
}
