//! The score of a set of cases: shares with their Wilson intervals, parameters, and every loss.

use crate::Case;
use crate::answer::Answer;
use crate::calibration::{Calibration, mean};
use crate::clutter::about_clutter;
use crate::intervals::{Numbers, median};
use crate::names::{named, size};
use crate::outcome::{Outcome, answered, exact, no_alarm, outcome, outcome_left_out};
use crate::proportion::Proportion;
use crate::truth::{Kind, TrueEffect};
use diagnose::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;

/// Log-likelihood gain from which an effect counts as detectable in the record, nats.
const DETECTABLE: f64 = 5.0;
/// Largest error of a claimed share of the gap that counts as right.
const CLOSE: f64 = 0.05;

/// The score of a set.
#[derive(Clone, Debug, Serialize)]
pub struct Score {
    /// Cases of each kind.
    pub cases: BTreeMap<Kind, usize>,
    /// Shares of cases, in the order of a report.
    pub shares: Vec<Share>,
    /// Mean number of different effects in an entry, indistinguishable ones counted once; leave-one-out included.
    pub mean_set_size: Option<f64>,
    /// Median difference between the claimed share of the gap that is closed and the true one.
    pub median_closed_difference: Option<f64>,
    /// Estimated parameters.
    pub numbers: Numbers,
    /// Probabilities.
    pub calibration: Calibration,
    /// The answers that were not right, case by case.
    pub losses: Vec<Loss>,
}

/// A share with a name.
#[derive(Clone, Debug, Serialize)]
pub struct Share {
    /// Its name for programs.
    pub name: &'static str,
    /// The condition that it counts.
    pub what: &'static str,
    /// The share.
    #[serde(flatten)]
    pub proportion: Proportion,
}

/// A case whose answer was not right.
#[derive(Clone, Debug, Serialize)]
pub struct Loss {
    /// Its name.
    pub case: String,
    /// Its kind.
    pub kind: Kind,
    /// Whether the true effect was left out of the search.
    pub left_out: bool,
    /// The grade of the answer.
    pub outcome: Outcome,
    /// The truth.
    pub truth: String,
    /// The answer.
    pub answer: String,
    /// Upper bound of the log-likelihood gain, nats, where known.
    pub nats: Option<f64>,
    /// Log-likelihood of the true model minus that of its best rival, nats, where known.
    pub shown: Option<f64>,
}

/// Scores the answers for a set of cases.
#[must_use]
pub fn score(cases: &[Case]) -> Score {
    let entries = cases.iter().flat_map(|case| case.answer.iter().chain(&case.left_out)).flat_map(|a| &a.effects);
    Score {
        cases: Kind::ALL.map(|kind| (kind, of_kind(cases, kind).count())).into(),
        shares: [
            about_all(cases),
            about_singles(cases),
            about_pairs(cases),
            about_rest(cases),
            about_clutter(cases),
            left_out(cases),
        ]
        .concat(),
        mean_set_size: mean(entries.map(|entry| size(entry) as f64)),
        median_closed_difference: median(cases.iter().filter_map(closed_difference)),
        numbers: Numbers::of(cases),
        calibration: Calibration::of(cases),
        losses: losses(cases),
    }
}

pub(crate) fn of_kind(cases: &[Case], kind: Kind) -> impl Iterator<Item = &Case> {
    cases.iter().filter(move |case| case.truth.kind == kind)
}

pub(crate) fn share<'a>(
    name: &'static str,
    what: &'static str,
    cases: impl IntoIterator<Item = &'a Case>,
    is_so: impl Fn(&Case) -> bool,
) -> Share {
    Share { name, what, proportion: Proportion::of(cases.into_iter().map(is_so)) }
}

/// Whether the effect is detectable in the record. `None`: no bound is known.
fn detectable(case: &Case) -> Option<bool> {
    case.nats().map(|nats| nats >= DETECTABLE)
}

/// Whether the true model has enough gain over its rivals, and so has each of its effects.
fn beats_rivals(case: &Case) -> bool {
    case.shown.is_some_and(|nats| nats >= DETECTABLE)
}

/// Whether each of the true effects is detectable in the presence of the others.
fn each_detectable(case: &Case) -> bool {
    let each = case.bounds.as_ref().map(|bounds| &bounds.each);
    each.is_some_and(|each| each.len() == case.truth.effects.len() && each.values().all(|nats| *nats >= DETECTABLE))
}

pub(crate) fn is(wanted: Outcome) -> impl Fn(&Case) -> bool {
    move |case| outcome(case) == wanted
}

pub(crate) fn says(case: &Case, verdict: Verdict) -> bool {
    case.answer.as_ref().is_some_and(|answer| answer.verdict == verdict)
}

fn about_all(cases: &[Case]) -> Vec<Share> {
    let placed = cases.iter().filter(|c| !c.truth.effects.is_empty() && stage_right(c).is_some());
    let claimed: Vec<&Case> = cases.iter().filter(|case| closed_difference(case).is_some()).collect();
    let close = |case: &Case| closed_difference(case).is_some_and(|difference| difference <= CLOSE);
    let reaching = |clutter: bool| {
        let with_interval = cases.iter().filter(|case| closed_covered(case).is_some());
        with_interval.filter(move |case| case.truth.kind.has_clutter() == clutter)
    };
    let covered = |case: &Case| closed_covered(case) == Some(true);
    vec![
        share("read", "all: the case could be read", cases, |case| case.answer.is_some()),
        share("answered", "all: an answer, not insufficient_data", cases, |case| {
            case.answer.as_ref().is_some_and(answered)
        }),
        share("stage", "effects, where a stage is blamed: the right one", placed, |case| {
            stage_right(case) == Some(true)
        }),
        share("closed", "closed share within 5 points of the true effects'", claimed, close),
        share("closed_covered", "closed share: its 90 % interval holds the true effects'", reaching(false), covered),
        share(
            "closed_covered_amid",
            "closed share amid clutter: its 90 % interval holds the true effects'",
            reaching(true),
            covered,
        ),
    ]
}

fn about_singles(cases: &[Case]) -> Vec<Share> {
    let singles = || of_kind(cases, Kind::Single);
    let shown = || singles().filter(|case| detectable(case) == Some(true));
    let unknown = singles().filter(|case| detectable(case).is_none());
    let beats = || singles().filter(|case| beats_rivals(case));
    let right = || singles().filter(|case| is(Outcome::Right)(case));
    vec![
        share("top_1", "single: the first entry names it", singles(), is(Outcome::Right)),
        share(
            "top_1_shown",
            "single, 5 nats above its best rival: the first entry names it",
            beats(),
            is(Outcome::Right),
        ),
        share(
            "alone_shown",
            "single, 5 nats above its best rival: it or its twins alone, and nothing left",
            beats(),
            |case| exact(case) && says_one_thing(case),
        ),
        share("silent_shown", "single, 5 nats above its best rival: silent", beats(), is(Outcome::Silent)),
        share("wrong_shown", "single, 5 nats above its best rival: a wrong name", beats(), is(Outcome::Wrong)),
        share("top_1_detectable", "single, 5 nats or more: the first entry names it", shown(), is(Outcome::Right)),
        share("top_1_no_bound", "single, no bound known: the first entry names it", unknown, is(Outcome::Right)),
        share("exact_single", "single: nothing else named, nothing left", singles(), exact),
        share("change", "single, named: added, retuned or removed is right", right(), change_right),
        share("silent_single", "single: silent", singles(), is(Outcome::Silent)),
        share("silent_detectable", "single, 5 nats or more: silent", shown(), is(Outcome::Silent)),
        share("unexplained_single", "single: unexplained, not named first", singles(), is(Outcome::Unexplained)),
        share("wrong_single", "single: a wrong name", singles(), is(Outcome::Wrong)),
    ]
}

fn about_pairs(cases: &[Case]) -> Vec<Share> {
    let pairs = || of_kind(cases, Kind::Pair);
    let shown = pairs().filter(|case| each_detectable(case));
    let beat = pairs().filter(|case| beats_rivals(case));
    let one_named = |case: &Case| case.answer.as_ref().is_some_and(|answer| named(answer, &case.truth.effects) > 0);
    vec![
        share("pair_both", "pair: both named", pairs(), is(Outcome::Right)),
        share("pair_both_shown", "pair, each 5 nats above its best rival: both named", beat, is(Outcome::Right)),
        share(
            "pair_both_detectable",
            "pair, each 5 nats or more beside the other: both named",
            shown,
            is(Outcome::Right),
        ),
        share("pair_one", "pair: at least one named", pairs(), one_named),
        share("exact_pair", "pair: both, no other, nothing left", pairs(), exact),
        share("wrong_pair", "pair: only wrong names", pairs(), is(Outcome::Wrong)),
    ]
}

fn about_rest(cases: &[Case]) -> Vec<Share> {
    let of = |kind| of_kind(cases, kind);
    let alarm = |case: &Case| case.answer.as_ref().is_some_and(|answer| !no_alarm(answer));
    let shown = of(Kind::Outside).filter(|case| detectable(case) == Some(true));
    let no_effect = cases.iter().filter(|case| matches!(case.truth.kind, Kind::None | Kind::Parameters));
    vec![
        share("false_alarm", "none and parameters: false alarm", no_effect, alarm),
        share("false_alarm_none", "none: false alarm", of(Kind::None), alarm),
        share("false_alarm_parameters", "parameters: false alarm", of(Kind::Parameters), alarm),
        share("none_as_parameters", "none: answered parameters (no alarm)", of(Kind::None), |case| {
            says(case, Verdict::Parameters)
        }),
        share("parameters_as_no_gap", "parameters: answered no_gap", of(Kind::Parameters), |case| {
            says(case, Verdict::NoGap)
        }),
        share("outside_unexplained", "outside: unexplained", of(Kind::Outside), is(Outcome::Right)),
        share("outside_detectable", "outside, 5 nats or more: unexplained", shown, is(Outcome::Right)),
        share("outside_wrong", "outside: a confident wrong name", of(Kind::Outside), is(Outcome::Wrong)),
        share("outside_silent", "outside: silent", of(Kind::Outside), is(Outcome::Silent)),
    ]
}

fn left_out(cases: &[Case]) -> Vec<Share> {
    let asked: Vec<&Case> = cases.iter().filter(|case| outcome_left_out(case).is_some()).collect();
    let shown = asked.iter().copied().filter(|case| detectable(case) == Some(true));
    let is = |wanted: Outcome| move |case: &Case| outcome_left_out(case) == Some(wanted);
    let stage = |case: &Case| {
        let effect = case.truth.effects.first().map(|effect| effect.stage.as_str());
        case.left_out.as_ref().and_then(Answer::stage) == effect
    };
    vec![
        share("left_out", "left out: unexplained, or a twin", asked.iter().copied(), is(Outcome::Right)),
        share("left_out_detectable", "left out, 5 nats or more: unexplained, or a twin", shown, is(Outcome::Right)),
        share("left_out_wrong", "left out: a confident wrong name", asked.iter().copied(), is(Outcome::Wrong)),
        share("left_out_stage", "left out: the right stage is blamed", asked.iter().copied(), stage),
    ]
}

/// Whether the stage with the largest share is that of a true effect. `None`: the answer has no stage.
fn stage_right(case: &Case) -> Option<bool> {
    let blamed = case.answer.as_ref()?.stage()?;
    Some(case.truth.effects.iter().any(|effect| effect.stage == blamed))
}

/// Whether the first entry has one effect, indistinguishable ones counted once.
fn says_one_thing(case: &Case) -> bool {
    case.answer.as_ref().and_then(|answer| answer.effects.first()).is_some_and(|entry| size(entry) == 1)
}

/// Whether the entry that names the effect has the right change.
fn change_right(case: &Case) -> bool {
    let entry = case.answer.as_ref().and_then(|answer| answer.effects.first());
    entry.zip(case.truth.effects.first()).is_some_and(|(entry, effect)| entry.change == effect.change)
}

/// Whether the interval of the closed share contains that of the true effects. `None`: there is no interval, or no
/// share.
fn closed_covered(case: &Case) -> Option<bool> {
    let claimed = case.answer.as_ref()?.gap.closed?;
    Some((claimed.low?..=claimed.high?).contains(&case.true_shares.as_ref()?.all))
}

fn closed_difference(case: &Case) -> Option<f64> {
    let claimed = case.answer.as_ref()?.gap.closed?.value;
    Some((claimed - case.true_shares.as_ref()?.all).abs())
}

fn losses(cases: &[Case]) -> Vec<Loss> {
    let mut all = Vec::new();
    for case in cases {
        let both = [(false, Some(outcome(case)), &case.answer), (true, outcome_left_out(case), &case.left_out)];
        for (left_out, outcome, answer) in both {
            let Some(outcome) = outcome.filter(|outcome| *outcome != Outcome::Right) else { continue };
            all.push(Loss {
                case: case.truth.case.clone(),
                kind: case.truth.kind,
                left_out,
                outcome,
                truth: truth_in_words(case),
                answer: answer.as_ref().map_or_else(|| "not read".to_owned(), answer_in_words),
                nats: case.nats(),
                shown: case.shown,
            });
        }
    }
    all.sort_by_key(|loss| (loss.left_out, loss.kind));
    all
}

fn truth_in_words(case: &Case) -> String {
    let effect = |effect: &TrueEffect| {
        let values: Vec<String> = effect.parameters.iter().map(|(key, value)| format!("{key} {value:.3}")).collect();
        format!("{} {} {}", effect.name, effect.change, values.join(" ")).trim_end().to_owned()
    };
    let effects = case.truth.effects.iter().map(effect);
    effects.chain(case.truth.moved.iter().cloned()).collect::<Vec<_>>().join(", ")
}

fn answer_in_words(answer: &Answer) -> String {
    let entry = |entry: &crate::answer::NamedEffect| {
        let names = [std::slice::from_ref(&entry.name), &entry.indistinguishable_from].concat().join("/");
        format!("{names} {:.2}", entry.probability)
    };
    let entries: Vec<String> = answer.effects.iter().map(entry).collect();
    format!("{} {}", answer.word(), entries.join(", ")).trim_end().to_owned()
}
