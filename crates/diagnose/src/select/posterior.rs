//! From gains to probabilities: how each effect of a search scored, and the probability that it acts.

use crate::select::candidates::Candidate;
use crate::thresholds::SCALE_OF_PROBABILITY;

/// An effect that was tried, and its gain, nats.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Scored {
    /// The effect.
    pub name: &'static str,
    /// Its held-out gain; of one that was not fitted in full, that of the screening, 0 at most.
    pub held_out_gain: f64,
    /// What of that names it, see [`crate::Candidate`].
    pub penalised_gain: f64,
    /// Whether it was fitted in full, on each part of the record without the rest.
    pub in_full: bool,
}

/// The probability that one of a set of candidates, which `best` leads, acts, if one of all acts or none.
pub(crate) fn probability(all: &[Candidate], best: &Candidate, in_set: impl Fn(&Candidate) -> bool) -> f64 {
    // Relative to the largest, so that no gain by chance makes the exponentials overflow.
    let most = all.iter().map(|candidate| candidate.held_out_gain).fold(best.held_out_gain, f64::max);
    let weight = |candidate: &Candidate| ((candidate.held_out_gain - most) / SCALE_OF_PROBABILITY).exp();
    let set: f64 = all.iter().filter(|candidate| in_set(candidate)).map(weight).sum();
    let none = ((best.held_out_gain - most - best.penalised_gain) / SCALE_OF_PROBABILITY).exp();
    set / (all.iter().map(weight).sum::<f64>() + none)
}

/// The probability that each of those that were tried together acts, if one of them does or none: each from its held-out gain, none
/// from the penalised gain of any, of those that were fitted in full. `None` of the others.
#[must_use]
pub(crate) fn chances(scored: &[Scored]) -> Vec<Option<f64>> {
    let in_full = || scored.iter().filter(|one| one.in_full);
    let best = in_full().map(|one| one.held_out_gain).fold(0.0, f64::max);
    let penalised = in_full().map(|one| one.penalised_gain).fold(0.0, f64::max);
    let weight = |gain: f64| ((gain - best) / SCALE_OF_PROBABILITY).exp();
    let all = (-penalised / SCALE_OF_PROBABILITY).exp() + in_full().map(|one| weight(one.held_out_gain)).sum::<f64>();
    scored.iter().map(|one| one.in_full.then(|| weight(one.held_out_gain) / all)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Scored, chances};

    #[test]
    fn chances_of_those_fitted_in_full_and_of_none_add_up_to_one_and_two_alike_share() {
        let tried =
            |name, held_out_gain, in_full| Scored { name, held_out_gain, penalised_gain: held_out_gain, in_full };
        let all = [tried("a", 40.0, true), tried("b", 40.0, true), tried("c", -3.0, false)];
        assert_eq!(chances(&all)[2], None);
        assert!(chances(&all)[..2].iter().all(|chance| (chance.unwrap() - 0.5).abs() < 1e-6));
        // One that gains nothing is as likely as none at all.
        assert_eq!(chances(&[tried("a", 0.0, true)]), [Some(0.5)]);
        // Nor is a held_out_gain that is no penalised_gain a sign of anything.
        assert_eq!(chances(&[Scored { penalised_gain: 0.0, ..tried("a", 40.0, true) }]), [Some(0.5)]);
    }
}
