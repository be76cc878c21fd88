//! The scores of all effects of a round, and the probability of each by its gain alone.

use crate::thresholds::SCALE_OF_PROBABILITY;

/// A tested effect and its gains, nats.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Scored {
    /// The effect.
    pub name: &'static str,
    /// Its held-out gain. Without a full fit: the gain of the screening, at most 0.
    pub held_out_gain: f64,
    /// Its penalised gain, see [`crate::Candidate`].
    pub penalised_gain: f64,
    /// Whether it was fitted in full, with cross-validation.
    pub in_full: bool,
}

/// The probability of each effect that was fitted in full, if at most one acts: from its held-out gain, and for no
/// effect from the largest penalised gain. `None` for the others.
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
        // An effect without gain is as probable as no effect.
        assert_eq!(chances(&[tried("a", 0.0, true)]), [Some(0.5)]);
        // A held-out gain without penalised gain is no evidence.
        assert_eq!(chances(&[Scored { penalised_gain: 0.0, ..tried("a", 40.0, true) }]), [Some(0.5)]);
    }
}
