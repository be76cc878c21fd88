//! Where the gap arises along the signal path: each stage's share of the nats.

use crate::report::logs::Logs;
use diagnose::{Diagnosis, Verdict};
use plant::Stage;
use serde::Serialize;

/// A stage and its share; all shares add up to 1.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct StageEntry {
    pub(super) name: &'static str,
    pub(super) share: f64,
}

/// The stages of the plant, with their names.
pub(super) const NAMES: [(Stage, &str); 4] =
    [(Stage::Actuator, "actuator"), (Stage::Air, "air"), (Stage::Ball, "ball"), (Stage::Sensor, "sensor")];

/// Each stage's share of the likelihood gained by the effects that were found, asked for by what they leave unexplained, and lost by what
/// the loop did otherwise.
pub(super) fn stages(found: &Diagnosis, logs: &Logs<'_>) -> Vec<StageEntry> {
    let gain = |stage| {
        let doubted = |name| found.residue.instead_of == Some(name);
        let own = found.effects.iter().map(|named| &named.candidate);
        let own = own.filter(|candidate| candidate.entry.stage == stage && !doubted(candidate.entry.name));
        let left = if found.verdict == Verdict::Unexplained { found.residue.nats_at(stage) } else { 0.0 };
        own.map(|candidate| candidate.gain).sum::<f64>() + left
    };
    let of_plant = NAMES.into_iter().map(|(stage, name)| (name, gain(stage)));
    let of_loop = |name| {
        let own = logs.upstream.iter().filter(|(_, stage)| stage.name == name);
        (name, own.map(|(_, stage)| stage.nats).sum::<f64>())
    };
    shares(["controller", "timing"].map(of_loop).into_iter().chain(of_plant).collect())
}

fn shares(mut nats: Vec<(&'static str, f64)>) -> Vec<StageEntry> {
    nats.retain(|(_, nats)| *nats > 0.0);
    let total: f64 = nats.iter().map(|(_, nats)| nats).sum();
    nats.into_iter().map(|(name, nats)| StageEntry { name, share: nats / total }).collect()
}

#[cfg(test)]
mod tests {
    use super::{StageEntry, shares};

    #[test]
    fn shares_add_up_to_one_and_a_stage_without_any_is_left_out() {
        let entry = |name, share| StageEntry { name, share };
        let found = shares(vec![("controller", 30.0), ("timing", 0.0), ("actuator", 90.0), ("air", -2.0)]);
        assert_eq!(found, [entry("controller", 0.25), entry("actuator", 0.75)]);
        assert_eq!(shares(vec![("ball", 0.0)]), []);
    }
}
