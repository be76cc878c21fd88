//! Where the gap arises along the signal path: each stage's share of the nats, and the chance of so much where nothing is wrong.

use super::logs::Logs;
use crate::report::kit::words::NAMES;
use diagnose::Diagnosis;
use serde::Serialize;

/// A stage and its share; all shares add up to 1.
#[derive(Debug, PartialEq, Serialize)]
pub struct StageEntry {
    pub name: &'static str,
    pub share: f64,
    /// The chance of so much if the model were right.
    pub p_value: f64,
}

/// Each stage's share of the likelihood gained by the effects that were found, asked for by what they leave unexplained, and lost by what
/// the loop did otherwise. A loss by what a log says itself is one look at it: its chance is at most e^−nats (Markov).
pub fn stages(found: &Diagnosis, logs: &Logs<'_>) -> Vec<StageEntry> {
    let of_plant = NAMES.into_iter().map(|(stage, name)| (name, found.nats_at(stage), found.chance_at(stage)));
    let of_loop = |name| {
        let own = logs.upstream.iter().filter(|(_, stage)| stage.name == name);
        let nats = own.map(|(_, stage)| stage.nats).sum::<f64>();
        (name, nats, (-nats).exp())
    };
    shares(["controller", "timing"].map(of_loop).into_iter().chain(of_plant).collect())
}

fn shares(mut nats: Vec<(&'static str, f64, f64)>) -> Vec<StageEntry> {
    nats.retain(|(_, nats, _)| *nats > 0.0);
    let total: f64 = nats.iter().map(|(_, nats, _)| nats).sum();
    nats.into_iter().map(|(name, nats, p_value)| StageEntry { name, share: nats / total, p_value }).collect()
}

#[cfg(test)]
mod tests {
    use super::{StageEntry, shares};

    #[test]
    fn shares_add_up_to_one_and_a_stage_without_any_is_left_out() {
        let entry = |name, share, p_value| StageEntry { name, share, p_value };
        let found = shares(vec![
            ("controller", 30.0, 0.01),
            ("timing", 0.0, 1.0),
            ("actuator", 90.0, 0.001),
            ("air", -2.0, 1.0),
        ]);
        assert_eq!(found, [entry("controller", 0.25, 0.01), entry("actuator", 0.75, 0.001)]);
        assert_eq!(shares(vec![("ball", 0.0, 1.0)]), []);
    }
}
