//! The diagnosis: check, which, how far and where, put together into a verdict.
//!
//! ```text
//! belief → fitted belief → + best effect → + next effect …      each step must gain on stretches that it was not fitted to
//! ```
//!
//! The first that holds: `insufficient_data`, `unexplained` (innovations still depend on what was known, or are coloured),
//! `effect`, `parameters` (only base parameters moved, and that lowers the held-out error at 1 s), `no_gap`.

use crate::check::{Finding, check, is_hopeless, without_codes};
use crate::closed::Closed;
use crate::fit::{Fit, Problem};
use crate::folds::Folds;
use crate::free::Free;
use crate::gap::{Gap, Tally, tallies};
use crate::places::{Place, places, rows};
use crate::recording::Recording;
use crate::residue::Residue;
use crate::spectrum::{Band, band, periodogram};
use crate::thin::thinned;
use crate::which::{CONTAINS, Candidate, Search, Tried};
use plant::Model;
use rayon::prelude::*;

/// Held-out gain, nats, that an effect must bring to be named: e⁵ to 1.
const NAMED: f64 = 6.0;
/// The same for each further one, and as a share of what is explained already: the form of an effect is never quite that of
/// the catalogue, and what that leaves is no further effect.
const NAMED_NEXT: f64 = 9.0;
const SHARE_OF_FORM: f64 = 0.005;
/// The same for turbulence: what the noise of the air grew by counts against it already, and what is left over is judged strictly.
const NAMED_TURBULENCE: f64 = 3.0;
/// Effects that explain the record within so many nats of the best cannot be told from it.
const TOLD_APART: f64 = 3.0;
/// The same for effects that act alike on whatever the duty does.
const TWINS_TOLD_APART: f64 = 15.0;
const TWINS: [&[&str]; 2] = [&["transport_delay", "sensor_delay"], &["fan_lag", "sensor_lag"]];
/// Nats that count as one: likelihoods take the model for right, and no model is.
const DOUBT: f64 = 2.5;
/// The effect that can follow any missing force.
const TURBULENCE: &str = "turbulence";
/// Effects at most that a record can name; if there are more, the answer is not to be trusted.
const MOST_EFFECTS: usize = 2;
/// Readings in free flight that a diagnosis needs.
const ENOUGH_READINGS: usize = 300;

/// What is wrong, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing beyond noise.
    NoGap,
    /// Only base parameters moved.
    Parameters,
    /// One or more effects.
    Effect,
    /// Something is left that no effect explains.
    Unexplained,
    /// The record cannot answer.
    InsufficientData,
}

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

/// Everything that a diagnosis says.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The answer.
    pub verdict: Verdict,
    /// What was found, in the order it was found.
    pub effects: Vec<Named>,
    /// What each effect gained that was tried, search by search.
    pub rounds: Vec<Vec<Tried>>,
    /// The belief with its base parameters refitted.
    pub refitted: Fit,
    /// The belief with refitted parameters and the effects that were found.
    pub mended: Fit,
    /// Held-out forecast errors: nominal, refitted, mended.
    pub gaps: [Gap; 3],
    /// Where the refitted belief is wrong, the most significant place first.
    pub places: Vec<Place>,
    /// The frequencies at which the refitted belief is most wrong.
    pub band: Option<Band>,
    /// What is left over.
    pub residue: Residue,
    /// How much of the gap at 1 s the mended model closes; `None` where there is too little to close.
    pub closed: Option<Closed>,
    /// What the record cannot answer.
    pub findings: Vec<Finding>,
}

/// How to search.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Effects that the search may not name, as if the catalogue did not hold them.
    pub without: Vec<String>,
}

/// Compares `belief` with `recording` and says what separates them.
#[must_use]
pub fn diagnose(belief: &Model, recording: &Recording, options: &Options) -> Diagnosis {
    let mut findings = check(recording, belief);
    let decoded = without_codes(&findings, recording);
    let recording = decoded.as_ref().unwrap_or(recording);
    let thinned = thinned(recording);
    findings.extend(thinned.as_ref().map(|(merged, _)| Finding::Thinned { merged: *merged }));
    let recording = thinned.as_ref().map_or(recording, |(_, recording)| recording);
    let folds = Folds::new(belief, recording);
    let search = Search::new(belief, recording, &folds, &options.without);
    let refitted = search.refitted();
    let readings = refitted.surprises.iter().filter(|s| folds.counts(s.row)).count();
    let answers = readings >= ENOUGH_READINGS && !is_hopeless(&findings, recording, belief);
    let found = if answers { explain(&search, &refitted) } else { Explanation::nothing(&search, &refitted) };
    let stretches = held_out(&search, belief, [&refitted, &found.fit]);
    let gaps = stretches.each_ref().map(|stretches| Tally::sum(stretches.iter()).gap());
    let closed = Closed::of(&stretches[0], &stretches[2]);
    let verdict = if !answers {
        Verdict::InsufficientData
    } else if found.residue.is_significant() || found.added() > MOST_EFFECTS {
        Verdict::Unexplained
    } else if !found.effects.is_empty() {
        Verdict::Effect
    } else if parameters_matter(&gaps) {
        Verdict::Parameters
    } else {
        Verdict::NoGap
    };
    let places = places(&refitted.model, recording, &folds);
    let band = band(&periodogram(&rows(&refitted.model, recording, &folds)));
    let Explanation { effects, rounds, fit: mended, residue } = found;
    Diagnosis { verdict, effects, rounds, refitted, mended, gaps, places, band, residue, closed, findings }
}

/// The effects that explain a record, one after another.
struct Explanation {
    effects: Vec<Named>,
    rounds: Vec<Vec<Tried>>,
    fit: Fit,
    residue: Residue,
}

impl Explanation {
    fn added(&self) -> usize {
        self.effects.iter().filter(|named| named.change == Change::Added).count()
    }

    fn nothing(search: &Search<'_>, refitted: &Fit) -> Self {
        let residue = Residue::of(search.problem(), refitted);
        Self { effects: Vec::new(), rounds: Vec::new(), fit: refitted.clone(), residue }
    }
}

/// Finds effects until none explains more. Where a turbulence was found that cannot be one, the search is made without it:
/// what it followed is missing, and better left unexplained.
fn explain(search: &Search<'_>, refitted: &Fit) -> Explanation {
    let found = explain_by(search, refitted);
    let turbulent = found.effects.iter().any(|named| named.candidate.entry.name == TURBULENCE);
    if turbulent && !found.residue.allows_turbulence() {
        explain_by(&search.without_too(TURBULENCE), refitted)
    } else {
        found
    }
}

fn explain_by(search: &Search<'_>, refitted: &Fit) -> Explanation {
    let mut fit = refitted.clone();
    let (mut effects, mut rounds): (Vec<Named>, _) = (Vec::new(), Vec::new());
    while effects.len() <= MOST_EFFECTS {
        let explained: f64 = effects.iter().map(|named| named.candidate.gain).sum();
        let needed = if effects.is_empty() { NAMED } else { NAMED_NEXT.max(SHARE_OF_FORM * explained) };
        let (named, tried) = next_effect(search, &fit, needed);
        rounds.push(tried);
        let Some(named) = named else { break };
        fit = named.candidate.fit.clone();
        effects.push(named);
        if effects.len() == 2 {
            revise_first(search, &mut effects, &mut fit);
        }
    }
    let residue = Residue::of(search.problem(), &fit);
    for (change, candidate, without) in search.changed(&fit) {
        if candidate.gain > NAMED {
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
    Explanation { effects, rounds, fit, residue }
}

/// With the second effect known, the first is looked for again: it may have stood in for both.
fn revise_first(search: &Search<'_>, effects: &mut [Named], fit: &mut Fit) {
    let [first, _] = effects else { return };
    let without_first = search.removed(fit, first.candidate.entry.name);
    if let (Some(again), _) = next_effect(search, &without_first, NAMED_NEXT) {
        *fit = again.candidate.fit.clone();
        *first = again;
    }
}

/// The effect that explains most of what `so_far` leaves, if any explains enough; and what each that was tried gained.
fn next_effect(search: &Search<'_>, so_far: &Fit, needed: f64) -> (Option<Named>, Vec<Tried>) {
    let (mut all, tried) = search.candidates(so_far);
    // A coloured force follows any missing force: it comes first only where nothing else explains half as much.
    let turbulence = all.first().filter(|best| best.entry.name == TURBULENCE).map_or(f64::INFINITY, |best| best.gain);
    if all.get(1).is_some_and(|second| second.gain > needed.max(turbulence / 2.0)) {
        let turbulence = all.remove(0);
        all.push(Candidate { gain: 0.0, ..turbulence });
    }
    if all.first().is_some_and(|best| best.gain < needed) {
        // What the noise of the air had to grow by needs a name less than other effects do.
        all.retain(|candidate| candidate.entry.name == TURBULENCE && candidate.gain > NAMED_TURBULENCE);
    }
    let Some(best) = all.first() else { return (None, tried) };
    let rivals = || all.iter().skip(1).filter(|candidate| is_alternative(candidate, best));
    let near: Vec<&'static str> = rivals().map(|rival| rival.entry.name).collect();
    let models = rivals().map(|rival| rival.fit.model.clone()).collect();
    // A name that contains the best one says the same: it takes nothing from the probability of the set.
    let in_set = |c: &&Candidate| near.contains(&c.entry.name) || is_or_contains(c, best);
    let weight = |c: &Candidate| ((c.gain - best.gain) / DOUBT).exp();
    let set: f64 = all.iter().filter(in_set).map(weight).sum();
    let probability = set / (all.iter().map(weight).sum::<f64>() + (-best.gain / DOUBT).exp());
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

/// Held-out forecast errors of the belief and of the fits, each made anew without each fold; stretch by stretch.
fn held_out(search: &Search<'_>, belief: &Model, fits: [&Fit; 2]) -> [Vec<Tally>; 3] {
    let Problem { recording, folds, .. } = *search.problem();
    let of = |models: Vec<Model>| {
        let one = |(fold, model): (usize, &Model)| {
            tallies(model, recording, &|row| folds.stretch(row).filter(|_| folds.of(row) == Some(fold)))
        };
        let parts: Vec<Vec<Tally>> = models.par_iter().enumerate().map(one).collect();
        let longest = parts.iter().map(Vec::len).max().unwrap_or_default();
        (0..longest).map(|at| Tally::sum(parts.iter().filter_map(|part| part.get(at)))).collect()
    };
    let [refitted, mended] = fits.map(|fit| of(search.problem().without_each_fold(fit)));
    [tallies(belief, recording, &|row| folds.stretch(row)), refitted, mended]
}

/// Moving the base parameters lowers the error at 1 s by more than 5 % of the floor and 0.5 mm.
fn parameters_matter([nominal, refitted, mended]: &[Gap; 3]) -> bool {
    match (nominal.error_mm[2], refitted.error_mm[2], mended.floor_mm[2]) {
        (Some(nominal), Some(refitted), Some(floor)) => nominal - refitted > (0.05 * floor).max(0.5),
        _ => false,
    }
}

impl Diagnosis {
    /// The 90 % intervals of the numbers that the mended model moved: what was moved, and half of the interval in its own scale.
    #[must_use]
    pub fn half_intervals(&self) -> Option<Vec<(Free, f64)>> {
        let deviations = self.mended.deviations()?;
        Some(self.mended.free.iter().copied().zip(deviations.into_iter().map(|d| 1.645 * d)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::{Options, Verdict, diagnose};
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    #[test]
    fn a_rig_as_believed_has_no_gap() {
        for seed in 20..26 {
            let found = diagnose(&model(), &record(&model(), seed, 60), &Options::default());
            assert_eq!(found.verdict, Verdict::NoGap, "seed {seed}: {:?}", found.places.first());
        }
    }

    #[test]
    fn a_missing_lag_is_named_and_the_mended_model_closes_the_gap() {
        let belief = Model { effects: Effects::default(), ..model() };
        let found = diagnose(&belief, &record(&model(), 4, 80), &Options::default());
        assert_eq!(found.verdict, Verdict::Effect);
        // A lag of the sensor differs from one of the fan by the colour of the noise alone.
        let named = &found.effects[0];
        assert!([&[named.candidate.entry.name], &named.indistinguishable_from[..]].concat().contains(&"fan_lag"));
        assert!(found.effects[0].probability > 0.9);
        assert!(found.closed.unwrap().value > 0.8, "{:?}", found.closed);
    }

    #[test]
    fn a_gain_that_is_off_is_a_matter_of_parameters() {
        let belief = Model { gain_mm_per_s2_per_percent: 170.0, hover_duty_percent: 21.9, ..model() };
        let found = diagnose(&belief, &record(&model(), 4, 80), &Options::default());
        assert_eq!(found.verdict, Verdict::Parameters);
    }
}
