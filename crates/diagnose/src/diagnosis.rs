//! The diagnosis: check, which, how far and where, put together into a verdict.
//!
//! ```text
//! belief → fitted belief → + best effect → + next effect …      each step must gain on stretches that it was not fitted to
//! ```
//!
//! The first that holds: `insufficient_data`, `unexplained` (innovations still depend on what was known, or are coloured),
//! `effect`, `parameters` (only base parameters moved, and that lowers the held-out error at 1 s), `no_gap`.

use crate::check::{Finding, check};
use crate::fit::{Fit, Free};
use crate::gap::Gap;
use crate::places::{Place, colour, places};
use crate::recording::Recording;
use crate::which::{CONTAINS, Candidate, Search};
use plant::Model;

/// Held-out gain, nats, that an effect must bring to be named: e⁵ to 1.
const NAMED: f64 = 5.0;
/// Effects that explain the record within so many nats of the best cannot be told from it.
const TOLD_APART: f64 = 4.0;
/// Effects named at most; what is left then is unexplained.
const MOST_EFFECTS: usize = 3;
/// Readings in free flight that a diagnosis needs.
const ENOUGH_READINGS: usize = 300;
/// Significance of what is left over, after all that was looked at.
const LEFT_OVER: f64 = 0.002;
/// Colour of the innovations that is no chance, in deviations.
const COLOURED: f64 = 6.0;

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

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct Named {
    /// The effect and its fit at the time it was found.
    pub candidate: Candidate,
    /// The chance that this effect, or one of those it cannot be told from, acts.
    pub probability: f64,
    /// The effects it cannot be told from.
    pub indistinguishable_from: Vec<&'static str>,
}

/// Everything that a diagnosis says.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The answer.
    pub verdict: Verdict,
    /// What was found, in the order it was found.
    pub effects: Vec<Named>,
    /// The belief with its base parameters refitted.
    pub refitted: Fit,
    /// The belief with refitted parameters and the effects that were found.
    pub mended: Fit,
    /// Held-out forecast errors: nominal, refitted, mended.
    pub gaps: [Gap; 3],
    /// Where the refitted belief is wrong, the most significant place first.
    pub places: Vec<Place>,
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
    let findings = check(recording, belief);
    let search = Search::new(belief, recording, &options.without);
    let counts = search.counts();
    let refitted = search.whole(belief, &search.free_of(belief));
    let mut mended = refitted.clone();
    let mut effects = Vec::new();
    let readings = refitted.surprises.iter().filter(|s| counts[s.row]).count();
    let hopeless = findings.iter().any(|f| matches!(f, Finding::StillDuty { .. } | Finding::StillPosition { .. }));
    let answers = readings >= ENOUGH_READINGS && !hopeless;
    while answers && effects.len() < MOST_EFFECTS {
        let Some(named) = next_effect(&search, &mended) else { break };
        mended = named.candidate.fit.clone();
        effects.push(named);
    }
    let gaps = held_out(&search, belief, [&refitted, &mended]);
    let places_before = places(&refitted.model, recording, counts);
    let left = places(&mended.model, recording, counts).first().map_or(1.0, |place| place.p_value);
    let coloured = colour(&mended.surprises, counts);
    let verdict = if !answers {
        Verdict::InsufficientData
    } else if left <= LEFT_OVER || coloured > COLOURED {
        Verdict::Unexplained
    } else if !effects.is_empty() {
        Verdict::Effect
    } else if parameters_matter(&gaps) {
        Verdict::Parameters
    } else {
        Verdict::NoGap
    };
    Diagnosis { verdict, effects, refitted, mended, gaps, places: places_before, findings }
}

/// The effect that explains most of what `so_far` leaves, if any explains enough.
fn next_effect(search: &Search<'_>, so_far: &Fit) -> Option<Named> {
    let mut all = search.candidates(so_far);
    let best = all.first().filter(|best| best.gain > NAMED)?;
    let near: Vec<&'static str> =
        all.iter().skip(1).filter(|c| is_alternative(c, best)).map(|c| c.entry.name).collect();
    // A name that contains the best one says the same: it takes nothing from the probability of the set.
    let in_set = |c: &&Candidate| near.contains(&c.entry.name) || is_or_contains(c, best);
    let weight = |c: &Candidate| (c.gain - best.gain).exp();
    let set: f64 = all.iter().filter(in_set).map(weight).sum();
    let probability = set / (all.iter().map(weight).sum::<f64>() + (-best.gain).exp());
    Some(Named { candidate: all.swap_remove(0), probability, indistinguishable_from: near })
}

/// Whether `other` explains the record about as well as `best`, and does not do so by containing it.
fn is_alternative(other: &Candidate, best: &Candidate) -> bool {
    !is_or_contains(other, best) && other.gain > 0.0 && other.gain > best.gain - TOLD_APART
}

fn is_or_contains(other: &Candidate, best: &Candidate) -> bool {
    other.entry.name == best.entry.name || CONTAINS.contains(&(other.entry.name, best.entry.name))
}

/// Held-out forecast errors of the belief and of the fits, each made anew on the other half.
fn held_out(search: &Search<'_>, belief: &Model, fits: [&Fit; 2]) -> [Gap; 3] {
    let gap_of = |fit: Option<&Fit>| {
        let halves = search.crossed(fit.map_or(belief, |fit| &fit.model), fit.map(|fit| fit.free.as_slice()));
        Gap::pooled(halves.map(|(model, scored)| Gap::measure_where(&model, search.recording(), &|row| scored[row])))
    };
    [gap_of(None), gap_of(Some(fits[0])), gap_of(Some(fits[1]))]
}

/// Moving the base parameters lowers the error at 1 s by more than 5 % of the floor and 0.5 mm.
fn parameters_matter([nominal, refitted, mended]: &[Gap; 3]) -> bool {
    match (nominal.error_mm[2], refitted.error_mm[2], mended.floor_mm[2]) {
        (Some(nominal), Some(refitted), Some(floor)) => nominal - refitted > (0.05 * floor).max(0.5),
        _ => false,
    }
}

impl Diagnosis {
    /// The share of the gap at 1 s that the mended model closes; `None` when there is too little to close.
    #[must_use]
    pub fn closed(&self) -> Option<f64> {
        let [nominal, _, mended] = &self.gaps;
        let (before, after, floor) = (nominal.error_mm[2]?, mended.error_mm[2]?, mended.floor_mm[2]?);
        let open = before * before - floor * floor;
        (before > 1.05 * floor).then(|| (before * before - after * after) / open)
    }

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
        assert!(found.closed().unwrap() > 0.8, "{:?}", found.closed());
    }

    #[test]
    fn a_gain_that_is_off_is_a_matter_of_parameters() {
        let belief = Model { gain_mm_per_s2_per_percent: 170.0, hover_duty_percent: 21.9, ..model() };
        let found = diagnose(&belief, &record(&model(), 4, 80), &Options::default());
        assert_eq!(found.verdict, Verdict::Parameters);
    }
}
