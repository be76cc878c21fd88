//! The evidence for each named effect, and its probability.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::mending::Mending;
use crate::fit::bounds::Bounds;
use crate::fit::estimate::{Fit, Problem};
use crate::residual::constancy::Constancy;
use crate::select::odds::Evidence;
use crate::select::posterior::{Scored, chances};
use crate::select::random_force::is_random_force;
use crate::select::stepwise::{Change, Selection, is_of_path};
use plant::Entry;
use std::cell::LazyCell;

/// Factor on the probability of an effect of which a number is at a bound of the search: the likelihood has no maximum
/// there, so the effect may stand for another one. Chosen so that no such name is likelier than not.
const AT_A_BOUND: f64 = 0.5;

/// Adds the evidence for each named effect, and the probability that follows from it.
pub(super) fn add_odds(problem: &Problem<'_>, found: &mut Selection, mending: &Mending, bounds: &Bounds) {
    let Mending { ladder, matched, .. } = mending;
    let Selection { effects, fit, misfit, .. } = found;
    let constancy = LazyCell::new(|| Constancy::of(problem, fit));
    // A gain by forecasts allows for the residual by the weight of a reading.
    let rest_nats = if mending.by_forecasts { 0.0 } else { misfit.joint_nats() };
    for (k, named) in effects.iter_mut().enumerate() {
        let entry = named.candidate.entry;
        let dropped = ladder.dropped.get(k).copied().unwrap_or_default();
        named.evidence = Evidence {
            held_out_gain: named.candidate.held_out_gain,
            dropped_share: dropped.share,
            dropped_deviations: dropped.deviations,
            rest_nats,
            rest_share: 1.0 - ladder.named_share.unwrap_or(0.0),
            effects: ladder.dropped.len(),
            is_scatter: !is_of_path(entry) && !is_random_force(entry),
            is_change: named.change != Change::Added,
            is_matched: matched.iter().any(|matched| matched.name == entry.name),
            variation: if is_of_path(entry) { constancy.variation(entry) } else { None },
        };
        let is_added = named.change == Change::Added;
        let factor = if is_added && is_at_a_bound(fit, entry, bounds) { AT_A_BOUND } else { 1.0 };
        named.probability = factor * named.evidence.probability();
    }
}

/// Whether a number of the effect is at a bound of the search in this fit.
fn is_at_a_bound(fit: &Fit, entry: &Entry, bounds: &Bounds) -> bool {
    let mut own = fit.parameters.iter().filter(|one| one.is_of(entry.name));
    own.any(|one| bounds.active(*one, &fit.model).is_some())
}

impl Diagnosis {
    /// The probability of each effect of a round, if at most one of them acts: in proportion to the evidence, and for
    /// the named one at most the probability of its name. `None` for those that were not fitted in full.
    #[must_use]
    pub fn chances(&self, tried: &[Scored]) -> Vec<Option<f64>> {
        let all = chances(tried);
        let named =
            self.effects.iter().find(|named| tried.first().is_some_and(|one| one.name == named.candidate.entry.name));
        let own = named.and_then(|named| Some(named.probability / all.first().copied()??));
        let factor = own.unwrap_or(1.0).min(1.0);
        all.into_iter().map(|chance| Some(factor * chance?)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{AT_A_BOUND, is_at_a_bound};
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{Prior, parameters_of_effect};
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use crate::thresholds::LIKELY;
    use plant::Effect;
    use plant::effects::TransportDelay;

    #[test]
    fn an_effect_at_a_bound_of_the_search_is_not_likelier_than_not() {
        let (belief, recording) = (model(), record(&model(), 1, 20));
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let entry = &TransportDelay::ENTRY;
        let is_at_a_bound = |delay_s: f64| {
            let mut late = belief.clone();
            late.effects.set(entry.name, &[delay_s]);
            let fit = problem.at(late, &parameters_of_effect(entry, &[delay_s]));
            is_at_a_bound(&fit, entry, &problem.bounds())
        };
        let longest_s = entry.params[0].max;
        assert!(is_at_a_bound(longest_s) && !is_at_a_bound(0.6 * longest_s));
        const { assert!(AT_A_BOUND <= LIKELY) };
    }
}
