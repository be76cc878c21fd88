//! The shares of rigs amid clutter.

use crate::Case;
use crate::answer::NamedEffect;
use crate::names::names;
use crate::outcome::{LIKELY, Outcome, all_there, is_there};
use crate::proportion::Proportion;
use crate::score::{Share, is, of_kind, says, share};
use crate::truth::{Kind, TrueEffect};
use diagnose::Verdict;

/// The share of the gap from which on an effect counts as large, chosen by hand: twice what a small piece closes at
/// most.
const LARGE: f64 = 0.1;

/// Rigs with the small pieces that every real rig has.
pub(crate) fn about_clutter(cases: &[Case]) -> Vec<Share> {
    let of = |kind| of_kind(cases, kind);
    let entry = |case: &Case, wanted: &dyn Fn(&NamedEffect) -> bool| {
        case.answer.as_ref().and_then(|answer| answer.effects.first()).is_some_and(wanted)
    };
    let unexplained = |case: &Case| says(case, Verdict::Unexplained);
    let not_there = |case: &Case| case.answer.as_ref().is_some_and(|answer| !all_there(answer, case));
    let (effects, entries) = (effects_of_several(cases), entries_of_several(cases));
    let large = effects.iter().filter(|effect| effect.share.is_some_and(|share| share >= LARGE));
    let likely = entries.iter().filter(|(entry, _)| entry.probability >= LIKELY);
    let share_of = |name, what, all: Vec<bool>| Share { name, what, proportion: Proportion::of(all) };
    vec![
        share("amid_first", "amid: the first entry names it", of(Kind::Amid), is(Outcome::Right)),
        share("amid_likely", "amid: the first entry names it with probability 0.5 or more", of(Kind::Amid), |case| {
            is(Outcome::Right)(case) && entry(case, &|first| first.probability >= LIKELY)
        }),
        share(
            "amid_wrong",
            "amid: a first entry with probability 0.5 or more that is not there",
            of(Kind::Amid),
            |case| entry(case, &|first| first.probability >= LIKELY && !is_there(first, case)),
        ),
        share("amid_unexplained", "amid: unexplained", of(Kind::Amid), unexplained),
        share("clutter_named", "clutter: a name that is not there", of(Kind::Clutter), not_there),
        share("clutter_unexplained", "clutter: unexplained", of(Kind::Clutter), unexplained),
        share_of(
            "several_named",
            "several: of the effects, named",
            effects.iter().map(|one| one.named.is_some()).collect(),
        ),
        share_of(
            "several_likely",
            "several: of the effects, named with probability 0.5 or more",
            effects.iter().map(OneOfSeveral::is_likely).collect(),
        ),
        share_of(
            "several_large",
            "several: of the effects that close 10 % of the gap, named with probability 0.5 or more",
            large.map(OneOfSeveral::is_likely).collect(),
        ),
        share_of(
            "several_there",
            "several: of the names with probability 0.5 or more, there",
            likely.map(|(_, there)| *there).collect(),
        ),
        share("several_first", "several: the first entry is there", of(Kind::Several), |case| {
            entry(case, &|first| is_there(first, case))
        }),
    ]
}

/// A true effect of a rig with several.
struct OneOfSeveral {
    /// The probability with which it is named; `None`: it is not.
    named: Option<f64>,
    /// The share of the gap that it closes beside the others.
    share: Option<f64>,
}

impl OneOfSeveral {
    fn is_likely(&self) -> bool {
        self.named.is_some_and(|probability| probability >= LIKELY)
    }
}

/// The true effects of all rigs with several.
fn effects_of_several(cases: &[Case]) -> Vec<OneOfSeveral> {
    let of_case = |case: &Case| -> Vec<OneOfSeveral> {
        let entries = || case.answer.iter().flat_map(|answer| &answer.effects);
        let share = |name: &str| case.true_shares.as_ref().and_then(|shares| shares.each.get(name).copied());
        let one = |effect: &TrueEffect| OneOfSeveral {
            named: entries().find(|entry| names(entry, &effect.name)).map(|entry| entry.probability),
            share: share(&effect.name),
        };
        case.truth.effects.iter().map(one).collect()
    };
    of_kind(cases, Kind::Several).flat_map(of_case).collect()
}

/// The entries of the rigs with several effects, and whether what they name is there.
fn entries_of_several<'a>(cases: &'a [Case]) -> Vec<(&'a NamedEffect, bool)> {
    let entries = |case: &'a Case| case.answer.iter().flat_map(|answer| &answer.effects);
    let judged = |case: &'a Case| entries(case).map(move |entry| (entry, is_there(entry, case)));
    of_kind(cases, Kind::Several).flat_map(judged).collect()
}
