//! What was tried: every effect of a search with its gain, and what that says of its chance.

use crate::select::stepwise::DOUBT;

/// An effect that was tried, and what it gained, nats.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Tried {
    /// The effect.
    pub name: &'static str,
    /// Its gain; of one that was not fitted in full, at the first look.
    pub gain: f64,
    /// What of that names it, see [`crate::Candidate`].
    pub evidence: f64,
    /// Whether it was fitted in full, on each part of the record without the rest.
    pub in_full: bool,
}

/// The chance that each of those that were tried together is the one that acts, if one of them does or none: each from its gain, none
/// from the evidence for any, of those that were fitted in full, as in the verdict. `None` of the others.
#[must_use]
pub(crate) fn chances(tried: &[Tried]) -> Vec<Option<f64>> {
    let in_full = || tried.iter().filter(|one| one.in_full);
    let best = in_full().map(|one| one.gain).fold(0.0, f64::max);
    let evidence = in_full().map(|one| one.evidence).fold(0.0, f64::max);
    let weight = |gain: f64| ((gain - best) / DOUBT).exp();
    let all = (-evidence / DOUBT).exp() + in_full().map(|one| weight(one.gain)).sum::<f64>();
    tried.iter().map(|one| one.in_full.then(|| weight(one.gain) / all)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Tried, chances};

    #[test]
    fn chances_of_those_fitted_in_full_and_of_none_add_up_to_one_and_two_alike_share() {
        let tried = |name, gain, in_full| Tried { name, gain, evidence: gain, in_full };
        let all = [tried("a", 40.0, true), tried("b", 40.0, true), tried("c", -3.0, false)];
        assert_eq!(chances(&all)[2], None);
        assert!(chances(&all)[..2].iter().all(|chance| (chance.unwrap() - 0.5).abs() < 1e-6));
        // One that gains nothing is as likely as none at all.
        assert_eq!(chances(&[tried("a", 0.0, true)]), [Some(0.5)]);
        // Nor is a gain that is no evidence a sign of anything.
        assert_eq!(chances(&[Tried { evidence: 0.0, ..tried("a", 40.0, true) }]), [Some(0.5)]);
    }
}
