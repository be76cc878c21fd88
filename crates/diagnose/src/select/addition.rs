//! The effect to add next: the one that explains most, or another that is to be named before a random force.

use crate::fit::estimate::Fit;
use crate::select::candidates::{Candidate, candidates};
use crate::select::odds::Evidence;
use crate::select::posterior::Scored;
use crate::select::random_force::is_random_force;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect};
use crate::thresholds::{INDISTINGUISHABLE, INDISTINGUISHABLE_TWINS, RANDOM_FORCE, RANDOM_FORCE_YIELDS};

/// The effect that explains most beyond `so_far`, if it explains enough, and the scores of all effects.
pub(crate) fn best_addition(search: &Search<'_>, so_far: &Fit, needed: f64) -> (Option<NamedEffect>, Vec<Scored>) {
    let (mut all, mut scored) = candidates(search, so_far);
    select_first(&mut all, needed);
    let Some(best) = all.first() else { return (None, scored) };
    if let Some(at) = scored.iter().position(|one| one.name == best.entry.name) {
        scored[..=at].rotate_right(1);
    }
    let rivals = || all.iter().skip(1).filter(|candidate| is_indistinguishable(candidate, best));
    let near: Vec<&'static str> = rivals().map(|rival| rival.entry.name).collect();
    let models = rivals().map(|rival| rival.fit.model.clone()).collect();
    let named = NamedEffect {
        change: Change::Added,
        probability: 0.0,
        evidence: Evidence::default(),
        candidate: all.swap_remove(0),
        indistinguishable_from: near,
        rivals: models,
    };
    (Some(named), scored)
}

/// Moves the effect to be named to the front. Empties the list if none has the penalised gain `needed`.
fn select_first(all: &mut Vec<Candidate>, needed: f64) {
    let is_random = |candidate: &Candidate| is_random_force(candidate.entry);
    let Some(mut best) = all.iter().position(|candidate| candidate.penalised_gain >= needed) else {
        // The growth of the air's noise counts against a random force already, so it needs less.
        return all.retain(|candidate| is_random(candidate) && candidate.penalised_gain > RANDOM_FORCE);
    };
    if is_random(&all[best]) {
        // A random force follows any missing force. It comes first only if no other effect explains a good part of it.
        let part = RANDOM_FORCE_YIELDS * all[best].held_out_gain;
        let enough =
            |other: &Candidate| !is_random(other) && other.penalised_gain >= needed && other.held_out_gain > part;
        if let Some(other) = all.iter().position(enough) {
            let random = all.remove(best);
            all.push(Candidate { held_out_gain: 0.0, penalised_gain: 0.0, ..random });
            best = other - usize::from(other > best);
        }
    }
    all[..=best].rotate_right(1);
}

/// Whether `other` explains the record about as well as `best` and does not contain it.
pub(crate) fn is_indistinguishable(other: &Candidate, best: &Candidate) -> bool {
    let are_twins = best.entry.twins.contains(&other.entry.name);
    let within = if are_twins { INDISTINGUISHABLE_TWINS } else { INDISTINGUISHABLE };
    !is_or_contains(other, best) && other.held_out_gain > 0.0 && other.held_out_gain > best.held_out_gain - within
}

fn is_or_contains(other: &Candidate, best: &Candidate) -> bool {
    other.entry.name == best.entry.name || other.entry.contains == Some(best.entry.name)
}

#[cfg(test)]
mod tests {
    use super::select_first;
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Prior};
    use crate::record::folds::Folds;
    use crate::select::candidates::Candidate;
    use crate::tests_support::{model, record};
    use crate::thresholds::FIRST_EFFECT;
    use plant::Effects;

    /// The remaining names, the one to be named first, for candidates of given name, held-out gain and penalised gain.
    fn order(candidates: &[(&str, f64, f64)]) -> Vec<&'static str> {
        let (belief, recording) = (model(), record(&model(), 1, 12));
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let fit = problem.fit(&belief, &BASE);
        let candidate = |&(name, held_out_gain, penalised_gain): &(&str, f64, f64)| {
            let entry = Effects::built_in(name).unwrap();
            Candidate { entry, fit: fit.clone(), without_each_fold: Vec::new(), held_out_gain, penalised_gain }
        };
        let mut all: Vec<Candidate> = candidates.iter().map(candidate).collect();
        select_first(&mut all, FIRST_EFFECT);
        all.iter().map(|candidate| candidate.entry.name).collect()
    }

    #[test]
    fn what_gains_by_chance_is_an_alternative_to_what_has_evidence_and_alone_it_is_nothing() {
        let chance = ("duty_quantisation", 14.0, 4.0);
        assert_eq!(order(&[chance, ("dead_zone", 9.0, 8.0)]), ["dead_zone", "duty_quantisation"]);
        assert!(order(&[chance, ("dead_zone", 9.0, 4.9)]).is_empty());
    }

    #[test]
    fn turbulence_comes_after_what_explains_half_as_much_for_sure_and_needs_less_evidence() {
        let turbulence = ("turbulence", 30.0, 28.0);
        assert_eq!(order(&[turbulence, ("gain_drift", 16.0, 12.0)]), ["gain_drift", "turbulence"]);
        assert_eq!(order(&[turbulence, ("gain_drift", 14.0, 12.0)])[0], "turbulence");
        assert_eq!(order(&[turbulence, ("gain_drift", 16.0, 2.0)])[0], "turbulence");
        assert_eq!(order(&[("gain_drift", 4.9, 4.9), ("turbulence", 4.0, 2.0)]), ["turbulence"]);
        assert!(order(&[("turbulence", 4.0, 1.0)]).is_empty());
    }
}
