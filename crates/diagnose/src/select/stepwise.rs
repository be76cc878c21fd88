//! The effects that explain a record: what is best is found first, then what is best with that known, as long as each gains enough.

use crate::fit::estimate::Fit;
use crate::fit::parameter::COARSE;
use crate::residual::misfit::{LONG, Residue};
use crate::select::candidates::{CONTAINS, Candidate, Search};
use crate::select::posterior::Tried;
use crate::select::screening::DISTORT;
use plant::Model;

/// Evidence, nats, that an effect must bring to be named.
pub(crate) const NAMED: f64 = 5.0;
/// The same for a second one, for each further, beside coarse readings, and as a share of what is explained already: the form of an effect is
/// never quite that of the catalogue, and what that leaves is no further effect.
const NAMED_SECOND: f64 = 5.5;
const NAMED_FURTHER: f64 = 16.0;
const NAMED_BESIDE_CELLS: f64 = 20.0;
const SHARE_OF_FORM: f64 = 0.005;
/// The same as a share of what the innovations ask for without it: where much more is missing than it explains, it is not what is missing.
const SHARE_OF_THE_REST: f64 = 0.25;
/// Effects that change the density of a reading by thousands of nats, and leave no such share.
const OF_THE_DENSITY: [&str; 3] = ["sensor_quantisation", "stale_samples", "sensor_outliers"];
/// The same for turbulence: what the noise of the air grew by counts against it already, and what is left over is judged strictly.
const NAMED_TURBULENCE: f64 = 1.2;
/// Nats that a believed effect must lose with the numbers that are believed of it.
const CHANGED: f64 = 6.0;
/// Effects that explain the record within so many nats of the best cannot be told from it.
const TOLD_APART: f64 = 3.0;
/// The same for effects that act alike on whatever the duty does.
const TWINS_TOLD_APART: f64 = 15.0;
const TWINS: [&[&str]; 2] = [&["transport_delay", "sensor_delay"], &["fan_lag", "sensor_lag"]];
/// Nats that count as one: likelihoods take the model for right, and no model is.
pub(crate) const DOUBT: f64 = 2.5;
/// The effect that can follow any missing force.
pub(crate) const TURBULENCE: &str = "turbulence";
/// Effects at most that a record can name; if there are more, the answer is not to be trusted.
const MOST_EFFECTS: usize = 2;
/// Searches at most: what was found may be dropped again.
const MOST_ROUNDS: usize = 5;

/// What is to be done to the belief about an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// It was not believed.
    Added,
    /// It was believed, but its numbers are off by more than a factor of 1.5.
    Retuned,
    /// It was believed, and is not there.
    Removed,
}

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct Named {
    /// What is to be done about it.
    pub change: Change,
    /// The effect and its fit at the time it was found.
    pub candidate: Candidate,
    /// The chance that this effect, or one of those it cannot be told from, acts.
    pub probability: f64,
    /// The effects it cannot be told from.
    pub indistinguishable_from: Vec<&'static str>,
    /// The models with each of those in its place, in the same order.
    pub rivals: Vec<Model>,
}

/// The effects that explain a record: those to add, the most important first, then what became of the believed.
pub(crate) struct Explanation {
    pub(crate) effects: Vec<Named>,
    pub(crate) rounds: Vec<Vec<Tried>>,
    pub(crate) fit: Fit,
    pub(crate) residue: Residue,
    /// The fits that led to it.
    on_the_way: Vec<Fit>,
}

impl Explanation {
    /// Whether something is left over, or so much was named that the answer is not to be trusted.
    pub(crate) fn leaves_something(&self) -> bool {
        let added = self.effects.iter().filter(|named| named.change == Change::Added).count();
        self.residue.is_significant() || added > MOST_EFFECTS
    }

    /// No effect at all.
    pub(crate) fn nothing(search: &Search<'_>, refitted: &Fit) -> Self {
        let residue = Residue::of(&search.problem, refitted, None);
        Self { effects: Vec::new(), rounds: Vec::new(), fit: refitted.clone(), residue, on_the_way: Vec::new() }
    }
}

/// Finds effects until none explains more. Where a turbulence was found that cannot be one, the search is made without it:
/// what it followed is missing, and better left unexplained.
pub(crate) fn explain(search: &Search<'_>, refitted: &Fit) -> Explanation {
    let mut found = explain_by(search, refitted);
    let added = found.effects.iter().filter(|named| named.change == Change::Added);
    let after = added.map(|named| named.candidate.entry.name).skip_while(|name| *name != TURBULENCE).count();
    // Nothing may come after it: what is found beside it, it would have followed as well.
    if after > 1 || (after == 1 && !found.residue.allows_turbulence()) {
        found = explain_by(&search.without_too(TURBULENCE), refitted);
    }
    search.most_important_first(&mut found.effects, &found.fit, &found.on_the_way);
    found
}

fn explain_by(search: &Search<'_>, refitted: &Fit) -> Explanation {
    let mut fit = refitted.clone();
    let (mut effects, mut rounds, mut on_the_way): (Vec<Named>, _, _) = (Vec::new(), Vec::new(), Vec::new());
    let (mut residue, mut outdone) = (None, None);
    // What so small a misfit gains on a long record needs more than chance would: nobody's form is exact.
    let long = (search.problem.recording.readings() as f64 / LONG).max(1.0).sqrt();
    while effects.len() <= MOST_EFFECTS && rounds.len() < MOST_ROUNDS {
        let (named, tried) = next_effect(search, &fit, long * needed_beside(&effects));
        rounds.push(tried);
        let Some(named) = named else { break };
        let left = Residue::of(&search.problem, &fit, explained(&effects));
        if !effects.is_empty() && named.candidate.gain < SHARE_OF_THE_REST * left.asked_in_all() {
            residue = Some(left);
            break;
        }
        outdone = left.instead_of(named.candidate.entry.name, named.candidate.gain);
        on_the_way.push(std::mem::replace(&mut fit, named.candidate.fit.clone()));
        if DISTORT.contains(&named.candidate.entry.name) {
            fit = search.with_other_sizes(fit);
        }
        effects.push(named);
        if effects.len() == 2 {
            revise_first(search, &mut effects, &mut fit);
        }
        drop_the_needless(search, &mut effects, &mut fit);
    }
    let outdone = outdone.filter(|left| effects.last().map(|named| named.candidate.entry.name) == left.instead_of);
    let residue = residue.or(outdone).unwrap_or_else(|| Residue::of(&search.problem, &fit, explained(&effects)));
    for (change, candidate, without) in search.changed(&fit) {
        if candidate.gain > CHANGED {
            fit = without.unwrap_or(fit);
            let probability = 1.0 / (1.0 + (-candidate.gain / DOUBT).exp());
            effects.push(Named {
                change,
                candidate,
                probability,
                indistinguishable_from: Vec::new(),
                rivals: Vec::new(),
            });
        }
    }
    Explanation { effects, rounds, fit, residue, on_the_way }
}

/// Nats that these effects explain by what the rig does, `None` of no effect; those that change the density of a reading explain thousands,
/// and leave no form.
fn explained(effects: &[Named]) -> Option<f64> {
    let of_form = effects.iter().filter(|named| !OF_THE_DENSITY.contains(&named.candidate.entry.name));
    (!effects.is_empty()).then(|| of_form.map(|named| named.candidate.gain).sum())
}

/// What another effect must gain beside those that were found.
fn needed_beside(effects: &[Named]) -> f64 {
    let form = SHARE_OF_FORM * explained(effects).unwrap_or(0.0);
    match effects {
        [] => NAMED,
        _ if effects.iter().any(|named| named.candidate.entry.name == COARSE) => NAMED_BESIDE_CELLS.max(form),
        [_] => NAMED_SECOND.max(form),
        _ => NAMED_FURTHER.max(form),
    }
}

/// Drops what stood in for an effect that was found after it.
fn drop_the_needless(search: &Search<'_>, effects: &mut Vec<Named>, fit: &mut Fit) {
    if effects.len() < 2 {
        return;
    }
    let (mut at, mut worth) = (0, search.worth(fit));
    while effects.len() > 1 && at < effects.len() {
        let without = search.removed(fit, effects[at].candidate.entry.name);
        let worth_without = search.worth(&without);
        if worth - worth_without < NAMED_SECOND {
            (*fit, worth) = (without, worth_without);
            effects.remove(at);
        } else {
            at += 1;
        }
    }
}

/// With the second effect known, the first is looked for again: it may have stood in for both.
fn revise_first(search: &Search<'_>, effects: &mut [Named], fit: &mut Fit) {
    let [first, _] = effects else { return };
    let without_first = search.removed(fit, first.candidate.entry.name);
    let (again, _) = next_effect(search, &without_first, NAMED_SECOND);
    if let Some(again) = again.filter(|again| search.worth(&again.candidate.fit) > search.worth(fit)) {
        *fit = again.candidate.fit.clone();
        *first = again;
    }
}

/// The effect that explains most of what `so_far` leaves, if any explains enough; and what each that was tried gained.
fn next_effect(search: &Search<'_>, so_far: &Fit, needed: f64) -> (Option<Named>, Vec<Tried>) {
    let (mut all, mut tried) = search.candidates(so_far);
    put_first(&mut all, needed);
    let Some(best) = all.first() else { return (None, tried) };
    if let Some(at) = tried.iter().position(|one| one.name == best.entry.name) {
        tried[..=at].rotate_right(1);
    }
    let rivals = || all.iter().skip(1).filter(|candidate| is_alternative(candidate, best));
    let near: Vec<&'static str> = rivals().map(|rival| rival.entry.name).collect();
    let models = rivals().map(|rival| rival.fit.model.clone()).collect();
    // A name that contains the best one says the same: it takes nothing from the probability of the set.
    let in_set = |c: &&Candidate| near.contains(&c.entry.name) || is_or_contains(c, best);
    // Shares of the largest, which no gain by chance can make overflow.
    let most = all.iter().map(|candidate| candidate.gain).fold(best.gain, f64::max);
    let weight = |c: &Candidate| ((c.gain - most) / DOUBT).exp();
    let set: f64 = all.iter().filter(in_set).map(weight).sum();
    let none = ((best.gain - most - best.evidence) / DOUBT).exp();
    let probability = set / (all.iter().map(weight).sum::<f64>() + none);
    (
        Some(Named {
            change: Change::Added,
            candidate: all.swap_remove(0),
            probability,
            indistinguishable_from: near,
            rivals: models,
        }),
        tried,
    )
}

/// Puts the one that is to be named before those that gain more by chance; leaves none where none has the evidence `needed`.
fn put_first(all: &mut Vec<Candidate>, needed: f64) {
    let is_turbulence = |candidate: &Candidate| candidate.entry.name == TURBULENCE;
    let Some(mut best) = all.iter().position(|candidate| candidate.evidence >= needed) else {
        // What the noise of the air had to grow by needs a name less than other effects do.
        return all.retain(|candidate| is_turbulence(candidate) && candidate.evidence > NAMED_TURBULENCE);
    };
    if is_turbulence(&all[best]) {
        // A coloured force follows any missing force: it comes first only where nothing else explains half as much.
        let half = all[best].gain / 2.0;
        let enough = |other: &Candidate| !is_turbulence(other) && other.evidence >= needed && other.gain > half;
        if let Some(other) = all.iter().position(enough) {
            let turbulence = all.remove(best);
            all.push(Candidate { gain: 0.0, evidence: 0.0, ..turbulence });
            best = other - usize::from(other > best);
        }
    }
    all[..=best].rotate_right(1);
}

/// Whether `other` explains the record about as well as `best`, and does not do so by containing it. Twins differ by the
/// colour of noise alone, which is worth less than what the duty says: they are told apart by much.
fn is_alternative(other: &Candidate, best: &Candidate) -> bool {
    let twins = TWINS.iter().any(|class| class.contains(&other.entry.name) && class.contains(&best.entry.name));
    let apart = if twins { TWINS_TOLD_APART } else { TOLD_APART };
    !is_or_contains(other, best) && other.gain > 0.0 && other.gain > best.gain - apart
}

fn is_or_contains(other: &Candidate, best: &Candidate) -> bool {
    other.entry.name == best.entry.name || CONTAINS.contains(&(other.entry.name, best.entry.name))
}

#[cfg(test)]
mod tests {
    use super::{NAMED, put_first};
    use crate::select::candidates::Candidate;
    use crate::tests_support::{model, record};
    use crate::{BASE, Folds, Prior, Problem};
    use plant::Effects;

    /// The names that are left, the one to be named first, of made-up candidates: name, gain, evidence.
    fn order(candidates: &[(&str, f64, f64)]) -> Vec<&'static str> {
        let (belief, recording) = (model(), record(&model(), 1, 12));
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let fit = problem.fit(&belief, &BASE);
        let candidate = |&(name, gain, evidence): &(&str, f64, f64)| {
            let entry = *Effects::entry(name).unwrap();
            Candidate { entry, fit: fit.clone(), gain, evidence }
        };
        let mut all: Vec<Candidate> = candidates.iter().map(candidate).collect();
        put_first(&mut all, NAMED);
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
