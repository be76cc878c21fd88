//! Backward elimination: effects that are not needed beside the others are removed.

use crate::fit::estimate::Fit;
use crate::select::candidates::Candidate;
use crate::select::forecast::{Evaluated, deviations_at_all_horizons, forecasts_worse};
use crate::select::search::Search;
use crate::select::stepwise::NamedEffect;
use crate::thresholds::{BETTER_FORECAST, SECOND_EFFECT};

/// Removes effects that a later one replaces, but never the last one. The likelihood of the next reading may not need an
/// effect on which a forecast of a second depends, most of all beside coarse or noisy readings: such an effect stays.
pub(crate) fn backward_eliminate(search: &Search<'_>, effects: &mut Vec<NamedEffect>, fit: &mut Fit) {
    if effects.len() < 2 {
        return;
    }
    let (mut at, mut total) = (0, search.held_out_total(fit));
    while effects.len() > 1 && at < effects.len() {
        let without = search.removed(fit, effects[at].candidate.entry);
        let total_without = search.held_out_total(&without);
        if total - total_without < SECOND_EFFECT && !forecasts_worse(search, &without, fit) {
            (*fit, total) = (without, total_without);
            effects.remove(at);
        } else {
            at += 1;
        }
    }
}

/// Removes effects without which the forecasts are not worse, or no worse than by chance if they gain too little for a
/// name; the gain of each of the others becomes what it gains beside them.
pub(crate) fn eliminate_by_forecasts(search: &Search<'_>, effects: &mut Vec<NamedEffect>, fit: &mut Fit) {
    let mut with = Evaluated::of(search, fit.clone());
    for named in std::mem::take(effects).into_iter().rev() {
        let without = Evaluated::of(search, search.removed(&with.fit, named.candidate.entry));
        let held_out_gain = with.log_likelihood - without.log_likelihood;
        let worse = deviations_at_all_horizons(&without.errors, &with.errors);
        if worse > BETTER_FORECAST || (worse > 0.0 && held_out_gain >= SECOND_EFFECT) {
            effects.insert(0, NamedEffect { candidate: Candidate { held_out_gain, ..named.candidate }, ..named });
        } else {
            with = without;
        }
    }
    *fit = with.fit;
}
