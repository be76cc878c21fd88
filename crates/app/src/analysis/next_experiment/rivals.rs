//! Who the rivals are, which of them no flight can part, and which further signal would.
//!
//! A delay of the duty and a delay of the reading shift the same readings by the same time: exact twins on these two
//! signals. In general a recorded fan speed cuts the path between the actuator and the rest, and a second position
//! sensor cuts it before the sensor, so that two effects on different sides of a cut are told apart there.

use super::Rival;
use diagnose::{Diagnosis, Recording};
use plant::{Effects, Late, Stage};

/// Rivals that are looked at, at most; every pair of them is flown against each other.
const MOST: usize = 3;

/// The models that explain the record alike, for the first effect that could not be told from others. Empty: there is
/// none.
pub(super) fn of(found: &Diagnosis) -> Vec<Rival> {
    let Some(named) = found.effects.iter().find(|named| !named.rivals.is_empty()) else { return Vec::new() };
    let winner = (named.candidate.entry.name, found.mended.model.clone());
    let others = named.indistinguishable_from.iter().copied().zip(named.rivals.iter().cloned());
    std::iter::once(winner).chain(others.take(MOST - 1)).collect()
}

/// Which effects the recorded speed of the fan has told from their like, a sentence each.
pub(super) fn what_was_settled(found: &Diagnosis, recording: &Recording) -> Vec<String> {
    let named = found.effects.iter().filter(|_| recording.has_fan_speed());
    let settled = named.filter_map(|named| {
        let name = named.candidate.entry.name;
        let twin = named.candidate.entry.twins.first()?;
        let open = named.indistinguishable_from.contains(twin);
        (!open).then(|| {
            format!("{name} and {twin} look alike in duty and position; the recorded `fan_rpm` tells that it is {name}")
        })
    });
    settled.collect()
}

/// Effects that no flight tells from this one by duty and position: of two dead times, one shifts the same readings by
/// the same time as the other.
fn exact_twins(name: &str) -> &'static [&'static str] {
    let entry = Effects::entry(name).filter(|entry| entry.acts.late == Some(Late::DeadTime));
    entry.map_or(&[], |entry| entry.twins)
}

/// Whether this rival is a twin of one that comes before it.
pub(super) fn is_second_twin((name, _): &Rival, rivals: &[Rival]) -> bool {
    let before = rivals.iter().take_while(|(other, _)| other != name);
    before.into_iter().any(|(other, _)| exact_twins(name).contains(other))
}

/// Which further signal tells apart what no flight does, in a sentence. `left`: the names that the next experiment
/// leaves open.
pub(super) fn what_would_settle(left: &[&'static str], rivals: &[Rival], recording: &Recording) -> Option<String> {
    // A name is open as long as it has a rival that is not told from it; a twin is open with its twin.
    let twin = |name: &&'static str| exact_twins(name).iter().any(|twin| left.contains(twin));
    let names: Vec<&'static str> =
        rivals.iter().map(|(name, _)| *name).filter(|name| left.contains(name) || twin(name)).collect();
    if names.len() < 2 {
        return None;
    }
    let stage = |name: &&str| Effects::entry(name).map(|entry| entry.stage);
    let stages: Vec<Stage> = names.iter().filter_map(stage).collect();
    let cut = |side: Stage| stages.contains(&side) && stages.iter().any(|stage| *stage != side);
    let mut signals = Vec::new();
    if cut(Stage::Actuator) && !recording.has_fan_speed() {
        signals.push("`fan_rpm`, the speed of the fan by a tachometer");
    }
    if cut(Stage::Sensor) && !recording.has_second_position() {
        signals.push("`position2_mm`, the position by a second sensor");
    }
    let names = names.join(" and ");
    Some(match signals.join(" or ") {
        signals if signals.is_empty() => format!(
            "{names} look alike in every experiment of the list; a longer record of the kind at hand is the way to tell them apart"
        ),
        signals => format!(
            "{names} look alike in duty and position whatever is flown; record {signals}, which shows on which side of it the \
             effect acts"
        ),
    })
}
