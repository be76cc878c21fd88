//! Location of the gap along the signal path: the evidence at each stage of the plant, and the probability of as much
//! by chance.
//!
//! ```text
//! nats(stage)    gains of its effects, and scores of its residual terms
//! p(stage)       n·Q(k, 2·gain) for an effect of k parameters, one of n in the catalogue; of a residual: of its test
//! ```
//!
//! Twice the gain of k parameters without effect is χ² with k degrees of freedom; n is the Bonferroni correction.
//! Source: Wilks, "The large-sample distribution of the likelihood ratio", Annals of Mathematical Statistics 9 (1938).

use crate::answer::diagnosis::Diagnosis;
use crate::answer::verdict::Verdict;
use crate::select::stepwise::NamedEffect;
use crate::stats::chi_square::survival;
use plant::Stage;
use serde::Serialize;

/// A stage of the signal path and its share of the gap; all shares add up to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StageShare {
    /// The stage.
    pub name: &'static str,
    /// Its share of the nats.
    pub share: f64,
    /// The probability of so many nats if the model is right.
    pub p_value: f64,
}

/// Stages of the loop before the plant, in the order of the signal path.
const OF_THE_LOOP: [&str; 2] = ["controller", "timing"];

impl Diagnosis {
    /// Each stage's share of the nats: of the plant, and of the loop before it by its `deviations` from the config
    /// (stage and nats). Each deviation is one test, so its p-value is at most e^−nats (Markov).
    #[must_use]
    pub fn stage_shares(&self, deviations: &[(&'static str, f64)]) -> Vec<StageShare> {
        let of_plant = Stage::ALL.map(|stage| (stage.name(), self.nats_at(stage), self.chance_at(stage)));
        let of_loop = OF_THE_LOOP.map(|name| {
            let nats = deviations.iter().filter(|(stage, _)| *stage == name).map(|(_, nats)| nats).sum::<f64>();
            (name, nats, (-nats).exp())
        });
        shares(of_loop.into_iter().chain(of_plant).collect())
    }

    /// Held-out gains of the effects at a stage, plus the scores of the residual there, nats.
    #[must_use]
    pub fn nats_at(&self, stage: Stage) -> f64 {
        self.found_at(stage).map(|named| named.candidate.held_out_gain).sum::<f64>() + self.left_at(stage)
    }

    /// The probability of so many nats at a stage if the model is right, corrected for the number of tested effects.
    #[must_use]
    pub fn chance_at(&self, stage: Stage) -> f64 {
        let looks = self.mended.model.effects.catalogue().count() as f64;
        let of_effect =
            |named: &NamedEffect| looks * survival(named.candidate.value_count(), 2.0 * named.candidate.held_out_gain);
        let left = if self.left_at(stage) > 0.0 { (-self.misfit.omitted.max(self.misfit.events)).exp() } else { 1.0 };
        self.found_at(stage).map(of_effect).fold(left, f64::min).min(1.0)
    }

    /// The named effects of a stage, without the rejected one.
    fn found_at(&self, stage: Stage) -> impl Iterator<Item = &NamedEffect> {
        let rejected = self.misfit.rejected_effect;
        self.effects.iter().filter(move |named| {
            let entry = named.candidate.entry;
            entry.stage == stage && rejected != Some(entry.name)
        })
    }

    fn left_at(&self, stage: Stage) -> f64 {
        if self.verdict == Verdict::Unexplained { self.misfit.nats_at(stage) } else { 0.0 }
    }
}

fn shares(mut nats: Vec<(&'static str, f64, f64)>) -> Vec<StageShare> {
    nats.retain(|(_, nats, _)| *nats > 0.0);
    let total: f64 = nats.iter().map(|(_, nats, _)| nats).sum();
    nats.into_iter().map(|(name, nats, p_value)| StageShare { name, share: nats / total, p_value }).collect()
}

#[cfg(test)]
mod tests {
    use super::{StageShare, shares};

    use crate::tests_support::{model, record};
    use crate::{Options, diagnose};
    use plant::{Effects, Model, Stage};

    #[test]
    fn a_missing_lag_is_worth_what_it_gained_at_its_stage_and_chance_makes_no_such_thing() {
        let belief = Model { effects: Effects::default(), ..model() };
        let found = diagnose(&belief, &record(&model(), 4, 80), &Options::default());
        let [named] = &found.effects[..] else { panic!("{:?}", found.effects) };
        let entry = named.candidate.entry;
        assert!((found.nats_at(entry.stage) - named.candidate.held_out_gain).abs() < 1e-12);
        assert!(found.chance_at(entry.stage) < 1e-6);
        assert_eq!((found.nats_at(Stage::Ball), found.chance_at(Stage::Ball)), (0.0, 1.0));
    }

    #[test]
    fn shares_add_up_to_one_and_a_stage_without_any_is_left_out() {
        let entry = |name, share, p_value| StageShare { name, share, p_value };
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
