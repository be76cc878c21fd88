//! The grade of an answer.
//!
//! | kind | right | partly |
//! |---|---|---|
//! | `none`, `parameters` | `no_gap` or `parameters`, no effect named | |
//! | `single` | the first entry names the effect | a later entry does |
//! | `pair` | two entries name one each | one effect is named |
//! | `outside` | `unexplained`, and no name with probability 0.5 or more | |
//! | `clutter` | not `unexplained`, no entry but of a piece that may be called so | |
//! | `amid` | the first entry names the effect | a later entry does |
//! | `several` | an entry names each | one effect is named |
//! | effect left out of the search | `unexplained`, or the first entry names what imitates the effect | |
//!
//! Names count whatever the verdict: a misfit may remain beside a right one. All other answers are wrong (a name with
//! probability 0.5 or more that is not there), `unexplained` (or names that are not likely), silent (`no_gap`,
//! `parameters`), or without an answer (`insufficient_data`, or unreadable).

use crate::Case;
use crate::answer::{Answer, NamedEffect};
use crate::names::{named, names, names_stand_in};
use crate::truth::Kind;
use diagnose::Verdict;
use serde::Serialize;

/// A name is likely from this probability on.
pub(crate) const LIKELY: f64 = 0.5;

/// The grade of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The right answer.
    Right,
    /// One of two effects, or not in the first entry.
    Partly,
    /// It reports a misfit and does not name the effect.
    Unexplained,
    /// It reports that no effect is missing.
    Silent,
    /// It names an effect that does not exist.
    Wrong,
    /// The record was not read, or has too little information.
    NoAnswer,
}

impl Outcome {
    /// Its name in reports.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Partly => "partly",
            Self::Unexplained => "unexplained",
            Self::Silent => "silent",
            Self::Wrong => "wrong",
            Self::NoAnswer => "no answer",
        }
    }
}

/// The grade of the answer for a case.
pub(crate) fn outcome(case: &Case) -> Outcome {
    let Some(answer) = &case.answer else { return Outcome::NoAnswer };
    let truth = &case.truth.effects;
    match case.truth.kind {
        Kind::None | Kind::Parameters if no_alarm(answer) && answered(answer) => Outcome::Right,
        Kind::Single | Kind::Amid if first_names(answer, case) => Outcome::Right,
        Kind::Pair | Kind::Several if named(answer, truth) == truth.len() => Outcome::Right,
        Kind::Outside if is_unexplained(answer, case) => Outcome::Right,
        Kind::Clutter if answered(answer) && answer.verdict != Verdict::Unexplained && all_there(answer, case) => {
            Outcome::Right
        }
        Kind::Single | Kind::Pair | Kind::Amid | Kind::Several if named(answer, truth) > 0 => Outcome::Partly,
        _ => short_of_right(answer, case),
    }
}

/// The grade of the answer without the true effect. `None`: it was not requested.
pub(crate) fn outcome_left_out(case: &Case) -> Option<Outcome> {
    let (answer, effect) = (case.left_out.as_ref()?, case.truth.effects.first()?);
    let stands_in = answer.effects.first().is_some_and(|entry| names_stand_in(entry, &effect.name));
    let right = stands_in || is_unexplained(answer, case);
    Some(if right { Outcome::Right } else { short_of_right(answer, case) })
}

fn short_of_right(answer: &Answer, case: &Case) -> Outcome {
    match answer.verdict {
        Verdict::InsufficientData => Outcome::NoAnswer,
        _ if is_likely_wrong(answer, case) => Outcome::Wrong,
        Verdict::Unexplained => Outcome::Unexplained,
        _ if answer.effects.is_empty() => Outcome::Silent,
        _ => Outcome::Unexplained,
    }
}

/// Whether the answer says that no effect explains the record, and means it.
fn is_unexplained(answer: &Answer, case: &Case) -> bool {
    answer.verdict == Verdict::Unexplained && !is_likely_wrong(answer, case)
}

/// Whether an entry names, with probability 0.5 or more, something that is not there.
fn is_likely_wrong(answer: &Answer, case: &Case) -> bool {
    answer.effects.iter().any(|entry| entry.probability >= LIKELY && !is_there(entry, case))
}

/// Whether the first entry names the (first) true effect.
fn first_names(answer: &Answer, case: &Case) -> bool {
    let pair = answer.effects.first().zip(case.truth.effects.first());
    pair.is_some_and(|(entry, effect)| names(entry, &effect.name))
}

/// Whether every entry names something that is there.
pub(crate) fn all_there(answer: &Answer, case: &Case) -> bool {
    answer.effects.iter().all(|entry| is_there(entry, case))
}

/// Whether an entry names something that is there.
pub(crate) fn is_there(entry: &NamedEffect, case: &Case) -> bool {
    case.truth.there().any(|name| names(entry, name))
}

/// Whether there is a verdict.
pub(crate) fn answered(answer: &Answer) -> bool {
    answer.verdict != Verdict::InsufficientData
}

/// Whether the answer has no effect, only moved base parameters at most.
pub(crate) fn no_alarm(answer: &Answer) -> bool {
    answer.effects.is_empty() && !matches!(answer.verdict, Verdict::Effect | Verdict::Unexplained)
}

/// Whether the answer names exactly the true effects, and no remaining misfit.
pub(crate) fn exact(case: &Case) -> bool {
    let truth = &case.truth.effects;
    case.answer.as_ref().is_some_and(|answer| {
        let complete = answer.effects.len() == truth.len() && named(answer, truth) == truth.len();
        complete && answer.verdict == Verdict::Effect
    })
}
