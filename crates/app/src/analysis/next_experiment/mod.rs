//! The next experiment: the safe flight that would decide between the models that this record leaves open.
//!
//! ```text
//! nats(A, B) = ln p(record | A) − ln p(record | B), per minute of free flight      record: in closed loop on rig A
//! score      = min over pairs of rivals of min( nats(A, B), nats(B, A) )
//! ```
//!
//! Rivals are models that explain the record equally well. Each experiment of a list ([`mod@candidates`]) is flown in
//! virtual time on each of them by the known controller ([`Desk`]). It is not safe, and dropped, if the ball reaches an
//! end of the pipe or the duty its limits under any rival. The best few are scored again with each rival's parameters
//! fitted to the record of the other, because the next diagnosis will fit them too: an effect that a gain can imitate
//! does not separate the rivals.
//! Source of the score: Box and Hill, "Discrimination among mechanistic models", Technometrics 9 (1967), which uses the
//! same expectation, a Kullback–Leibler divergence.

pub mod candidates;
mod open_questions;
mod rivals;
mod score;

#[cfg(test)]
mod tests;

use super::virtual_flight::Desk;
use crate::flight::experiment::Experiment;
use candidates::{Candidate, candidates};
use diagnose::{Diagnosis, NextExperiment, Recording};
use plant::Model;
use rayon::prelude::*;
use score::{Records, fly_all};

/// An experiment that separates by less, nats a minute, is of no use: it would have to last long for the 5 nats by
/// which the diagnosis prefers one effect to another.
const SEPARATES: f64 = 2.0;
/// Comparisons of a pair that are repeated with the parameters of each rival fitted, and the smallest number of
/// experiments among them.
const COMPARISONS: usize = 8;
const SHORT_LIST: usize = 2;

/// The name of an effect that may be missing, and the model with it.
pub type Rival = (&'static str, Model);

/// Advice on the next flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advice {
    /// The experiment, if one helps.
    pub experiment: Option<NextExperiment>,
    /// In sentences: the questions that no experiment of the list decides, and what would decide them.
    pub findings: Vec<String>,
}

/// The next flight after `found`, which is the diagnosis of `recording` with `belief`. `desk`: the controller, if it is
/// known.
#[must_use]
pub fn advise(found: &Diagnosis, recording: &Recording, desk: Option<Desk>, belief: &Model) -> Advice {
    let mut advice = next_flight(found, recording, desk, belief);
    advice.findings.extend(rivals::what_was_settled(found, recording));
    advice
}

fn next_flight(found: &Diagnosis, recording: &Recording, desk: Option<Desk>, belief: &Model) -> Advice {
    let samples = recording.samples();
    let period_s = recording.duration_s() / samples.len().max(2).saturating_sub(1) as f64;
    let Some(desk) = desk.or_else(|| Desk::gentle(belief, period_s)) else {
        return Advice::default();
    };
    let rivals = rivals::of(found);
    if !rivals.is_empty() {
        return between(&rivals, &desk, recording);
    }
    let Some(gap) = open_questions::question(found, recording, belief) else { return Advice::default() };
    let stand_ins = open_questions::stand_ins(belief);
    let experiment = choose(&stand_ins, &with_the_first(stand_ins.len()), &desk).map(|best| NextExperiment {
        reason: format!("{gap} This experiment is the one of the list that would show most of what may be missing."),
        separates: best.separates.iter().copied().filter(|name| *name != open_questions::AS_BELIEVED).collect(),
        ..best
    });
    Advice { experiment, findings: Vec::new() }
}

/// The experiment that separates models that explain the record equally well, and the questions that none decides.
#[must_use]
pub fn between(rivals: &[Rival], desk: &Desk, recording: &Recording) -> Advice {
    let apart: Vec<Rival> = rivals.iter().filter(|rival| !rivals::is_second_twin(rival, rivals)).cloned().collect();
    let best = if apart.len() > 1 { choose(&apart, &all_pairs(apart.len()), desk) } else { None };
    let told: Vec<&str> = best.as_ref().map_or_else(Vec::new, |best| best.separates.clone());
    let experiment = best.map(|best| NextExperiment {
        reason: format!(
            "This record cannot tell {} apart; of the safe experiments of the list this one separates them best, by {:.0} \
             nats a minute (5 are e⁵ to 1).",
            best.separates.join(" and "),
            best.expected_nats
        ),
        ..best
    });
    let left: Vec<&'static str> = rivals.iter().map(|(name, _)| *name).filter(|name| !told.contains(name)).collect();
    let findings = rivals::what_would_settle(&left, rivals, recording).into_iter().collect();
    Advice { experiment, findings }
}

/// All pairs of `count` rivals.
fn all_pairs(count: usize) -> Vec<(usize, usize)> {
    (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect()
}

/// The pairs of the first rival with each of the others.
fn with_the_first(count: usize) -> Vec<(usize, usize)> {
    (1..count).map(|b| (0, b)).collect()
}

/// The experiment that separates most of the `pairs` of `rivals`, and of those the one with the highest score.
fn choose(rivals: &[Rival], pairs: &[(usize, usize)], desk: &Desk) -> Option<NextExperiment> {
    let mut flown: Vec<(Candidate, Records, (usize, f64))> = candidates(desk, rivals)
        .into_par_iter()
        .filter_map(|candidate| {
            let records = fly_all(&candidate, rivals, desk)?;
            let (separated, nats) = records.rank(rivals, pairs, false);
            Some((candidate, records, (separated.len(), nats)))
        })
        .collect();
    flown.sort_by(|a, b| b.2.0.cmp(&a.2.0).then(b.2.1.total_cmp(&a.2.1)));
    flown.truncate((COMPARISONS / pairs.len().max(1)).max(SHORT_LIST));
    let ranked = flown.into_par_iter().map(|(candidate, records, _)| {
        let (separated, nats) = records.rank(rivals, pairs, true);
        (candidate, separated, nats)
    });
    let ranked: Vec<_> = ranked.collect();
    let best = ranked.into_iter().max_by(|a, b| (a.1.len().cmp(&b.1.len())).then(a.2.total_cmp(&b.2)))?;
    let (candidate, separated, expected_nats) = best;
    let separates: Vec<&'static str> = rivals
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| separated.iter().any(|(a, b)| a == name || b == name))
        .collect();
    (!separated.is_empty()).then(|| NextExperiment {
        name: candidate.name,
        reason: String::new(),
        separates,
        expected_nats: (10.0 * expected_nats).round() / 10.0,
        file: file(&candidate),
    })
}

/// The experiment as a file, with its purpose as a comment at the top.
fn file(candidate: &Candidate) -> String {
    let toml = toml::to_string(&candidate.experiment).unwrap_or_default();
    format!("# {}\n{toml}", candidate.why)
}

/// Take-off and settling before an experiment begins, seconds.
fn settle_s(experiment: &Experiment) -> f64 {
    experiment.segments.first().map_or(0.0, |first| first.duration_s)
}
