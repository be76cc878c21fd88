//! The condition under which an entry names an effect.
//!
//! - An entry means "this effect, or one of those from which it is not distinguishable": it names every effect in that
//!   set, and no other.
//! - An indistinguishable effect that is not in the set is not named: `transport_delay` alone is wrong about a delay of
//!   the sensor, although no record separates them. `fan_lag` is wrong about `spin_asymmetry`, whose second parameter
//!   it lacks, and `spin_asymmetry` about `fan_lag`: it claims an asymmetry that does not exist.
//! - An entry names one effect at a time: two effects are both named when two entries name one each.
//! - The size of a set counts a class of indistinguishable effects once: listing one of the class is right, listing any
//!   other effect is imprecise.

use crate::answer::{Answer, NamedEffect};
use crate::truth::TrueEffect;

/// Names that a record can hardly separate, or not at all.
const CLASSES: [&[&str]; 2] = [&["transport_delay", "sensor_delay"], &["fan_lag", "sensor_lag", "spin_asymmetry"]];

/// Substitutes for an effect that is left out of the catalogue: the effect, and the names that imitate it. A symmetric
/// lag does not imitate an asymmetric one.
const STAND_INS: [(&str, &[&str]); 4] = [
    ("transport_delay", &["sensor_delay"]),
    ("sensor_delay", &["transport_delay"]),
    ("fan_lag", &["sensor_lag", "spin_asymmetry"]),
    ("sensor_lag", &["fan_lag", "spin_asymmetry"]),
];

/// All names of an entry.
pub(crate) fn set(entry: &NamedEffect) -> impl Iterator<Item = &str> {
    std::iter::once(entry.name.as_str()).chain(entry.indistinguishable_from.iter().map(String::as_str))
}

/// Whether the entry names the effect.
pub(crate) fn names(entry: &NamedEffect, effect: &str) -> bool {
    set(entry).any(|name| name == effect)
}

/// Whether the entry names an effect that imitates this one.
pub(crate) fn names_stand_in(entry: &NamedEffect, effect: &str) -> bool {
    set(entry).any(|name| imitators(effect).contains(&name))
}

/// The names that imitate an effect.
pub(crate) fn imitators(effect: &str) -> &'static [&'static str] {
    STAND_INS.iter().find(|(name, _)| *name == effect).map_or(&[], |(_, imitators)| imitators)
}

/// The number of different effects of an entry, a class of indistinguishable ones counted once.
pub(crate) fn size(entry: &NamedEffect) -> usize {
    let class = |name: &str| CLASSES.iter().find(|class| class.contains(&name)).map(|class| class[0].to_owned());
    let mut classes: Vec<String> = set(entry).map(|name| class(name).unwrap_or_else(|| name.to_owned())).collect();
    classes.sort_unstable();
    classes.dedup();
    classes.len()
}

/// The number of true effects that are named, each by an entry of its own.
pub(crate) fn named(answer: &Answer, truth: &[TrueEffect]) -> usize {
    match_up(truth, &mut vec![false; answer.effects.len()], answer)
}

/// The largest number of effects that can be matched to entries: there are only a few of either.
fn match_up(truth: &[TrueEffect], taken: &mut Vec<bool>, answer: &Answer) -> usize {
    let Some((first, rest)) = truth.split_first() else { return 0 };
    let mut best = match_up(rest, taken, answer);
    for (at, entry) in answer.effects.iter().enumerate() {
        if !taken[at] && names(entry, &first.name) {
            taken[at] = true;
            best = best.max(1 + match_up(rest, taken, answer));
            taken[at] = false;
        }
    }
    best
}
