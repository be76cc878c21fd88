//! The evidence for each named effect, and its probability.

use crate::answer::diagnosis::Diagnosis;
use crate::answer::mending::Mending;
use crate::select::odds::Evidence;
use crate::select::posterior::{Scored, chances};
use crate::select::random_force::is_random_force;
use crate::select::stepwise::{Change, Selection, is_of_path};

/// Adds the evidence for each named effect, and the probability that follows from it.
pub(super) fn add_odds(found: &mut Selection, mending: &Mending) {
    let Mending { ladder, matched, .. } = mending;
    // A gain by forecasts allows for the residual by the weight of a reading.
    let rest_nats = if mending.by_forecasts { 0.0 } else { found.misfit.joint_nats() };
    for (k, named) in found.effects.iter_mut().enumerate() {
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
        };
        named.probability = named.evidence.probability();
    }
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
