//! The model that forecasts best where no effect explains the record.
//!
//! A wrong model that maximises the likelihood of the next reading may forecast a second worse than the belief does. So
//! the belief, its refit, the fit with the effects that were found, and the forms that go with each are compared by
//! their held-out forecast errors at 1 s. A model takes the place of a simpler one where it is better in the mean of the
//! stretches by more than chance.

use crate::answer::diagnosis::held_out;
use crate::fit::estimate::Fit;
use crate::form::{Form, form};
use crate::gap::forecast_error::Tally;
use crate::select::search::Search;
use crate::thresholds::BETTER_FORECAST;
use rayon::prelude::*;

/// A model that is compared.
struct Rival {
    fit: Fit,
    form: Option<Form>,
    errors: Vec<Tally>,
}

/// The best of the belief, the fits, and their forms.
pub(super) fn best_forecast(search: &Search<'_>, refitted: &Fit, with_effects: &Fit) -> (Fit, Option<Form>) {
    let belief = search.problem.fit(search.problem.belief, &[]);
    // A form may go with what was found, and with the belief where the refit has followed the force that is missing.
    let near = if search.is_far(refitted) { &belief } else { refitted };
    let effects = (with_effects.parameters.len() > refitted.parameters.len()).then_some(with_effects);
    let bases: Vec<&Fit> = std::iter::once(near).chain(effects).collect();
    let forms: Vec<_> = bases.par_iter().filter_map(|base| form(search, &base.model)).collect();
    let plain = [belief.clone(), refitted.clone(), with_effects.clone()].into_iter().map(|fit| (fit, None));
    let rivals = plain.chain(forms.into_iter().map(|(form, fit)| (fit, Some(form)))).collect::<Vec<_>>();
    let rivals = rivals.into_par_iter().map(|(fit, form)| {
        // A patch does not change the noise.
        let errors = held_out(search, &fit, |model| model.noise = search.problem.belief.noise);
        Rival { fit, form, errors }
    });
    let best = rivals
        .collect::<Vec<_>>()
        .into_iter()
        .reduce(|best, next| if is_better(&next.errors, &best.errors) { next } else { best });
    best.map_or_else(|| (refitted.clone(), None), |best| (best.fit, best.form))
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
