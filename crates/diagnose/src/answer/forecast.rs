//! The model that forecasts best where a residual remains.
//!
//! A wrong model that maximises the likelihood of the next reading may forecast a second worse than the belief does. So
//! the belief, its refit, and the fit with the effects that were found are compared by their held-out forecast errors at
//! 1 s. A model takes the place of a simpler one where it is better in the mean of the stretches by more than chance.

use crate::answer::diagnosis::held_out;
use crate::fit::estimate::Fit;
use crate::gap::forecast_error::Tally;
use crate::select::search::Search;
use crate::thresholds::BETTER_FORECAST;

/// The best of the belief and the fits.
pub(super) fn best_forecast(search: &Search<'_>, refitted: &Fit, with_effects: &Fit) -> Fit {
    let belief = search.problem.fit(search.problem.belief, &[]);
    // A patch does not change the noise.
    let errors = |fit: &Fit| held_out(search, fit, |model| model.noise = search.problem.belief.noise);
    let mut best = (errors(&belief), &belief);
    for next in [refitted, with_effects] {
        let errors = errors(next);
        if is_better(&errors, &best.0) {
            best = (errors, next);
        }
    }
    best.1.clone()
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
