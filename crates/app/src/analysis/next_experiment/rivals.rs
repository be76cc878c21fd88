//! The rivals, those that no flight can separate, and the further signal that would.
//!
//! A delay of the duty and a delay of the reading shift the same readings by the same time: they are not identifiable
//! from these two signals. In general a recorded fan speed divides the path between the actuator and the rest, and a
//! second position sensor divides it before the sensor, so that two effects on different sides become distinguishable.

use super::Rival;
use diagnose::{Diagnosis, Recording};
use plant::{Effects, Late, Stage};

/// Largest number of rivals; every pair of them is compared.
const MOST: usize = 3;

/// The models that explain the record equally well, for the first effect that is not distinguishable from others.
/// Empty: there is none.
pub(super) fn of(found: &Diagnosis) -> Vec<Rival> {
    let Some(named) = found.effects.iter().find(|named| !named.rivals.is_empty()) else { return Vec::new() };
    let winner = (named.candidate.entry.name, found.mended.model.clone());
    let others = named.indistinguishable_from.iter().copied().zip(named.rivals.iter().cloned());
    std::iter::once(winner).chain(others.take(MOST - 1)).collect()
}

/// In a sentence each: the effects that became distinguishable by the recorded speed of the fan.
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

/// Effects that are not distinguishable from this one by duty and position in any flight: of two dead times, each
/// shifts the same readings by the same time.
fn exact_twins(name: &str) -> &'static [&'static str] {
    let entry = Effects::built_in(name).filter(|entry| entry.acts.late == Some(Late::DeadTime));
    entry.map_or(&[], |entry| entry.twins)
}

/// Whether this rival is not distinguishable from one that comes before it.
pub(super) fn is_second_twin((name, _): &Rival, rivals: &[Rival]) -> bool {
    let before = rivals.iter().take_while(|(other, _)| other != name);
    before.into_iter().any(|(other, _)| exact_twins(name).contains(other))
}

/// The further signal that separates what no flight does, in a sentence. `left`: the names that the next experiment
/// leaves open.
pub(super) fn what_would_settle(left: &[&'static str], rivals: &[Rival], recording: &Recording) -> Option<String> {
    // A name is open as long as one of its rivals is not separated from it; this includes its exact twins.
    let twin = |name: &&'static str| exact_twins(name).iter().any(|twin| left.contains(twin));
    let names: Vec<&'static str> =
        rivals.iter().map(|(name, _)| *name).filter(|name| left.contains(name) || twin(name)).collect();
    if names.len() < 2 {
        return None;
    }
    let stage = |name: &&str| Effects::built_in(name).map(|entry| entry.stage);
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
