//! Where along the signal path a gap arises: what is worth a word at each stage of the plant, and the chance of as much where nothing is wrong.
//!
//! ```text
//! nats(stage)    what its effects gained, and what is left over there asks for
//! p(stage)       n·Q(k, 2·gain) of an effect of k numbers, one of the n of the catalogue; of what is left over, the chance of its test
//! ```
//!
//! Twice the gain of k numbers that do nothing is χ² with k degrees of freedom. Source: Wilks, "The large-sample distribution of the likelihood
//! ratio", Annals of Mathematical Statistics 9 (1938); n by Bonferroni.

use crate::answer::diagnosis::{Diagnosis, Verdict};
use crate::select::stepwise::NamedEffect;
use crate::stats::chi_square::survival;
use plant::{Effects, Stage};

impl Diagnosis {
    /// Likelihood gained at a stage by the effects that were found, and asked for there by what they leave unexplained, nats.
    #[must_use]
    pub fn nats_at(&self, stage: Stage) -> f64 {
        self.found_at(stage).map(|named| named.candidate.held_out_gain).sum::<f64>() + self.left_at(stage)
    }

    /// The chance of so much at that stage if the model were right, all effects that were tried taken into account.
    #[must_use]
    pub fn chance_at(&self, stage: Stage) -> f64 {
        let looks = Effects::CATALOGUE.len() as f64;
        let of_effect = |named: &NamedEffect| {
            looks * survival(named.candidate.entry.params.len(), 2.0 * named.candidate.held_out_gain)
        };
        let left = if self.left_at(stage) > 0.0 { (-self.misfit.omitted.max(self.misfit.events)).exp() } else { 1.0 };
        self.found_at(stage).map(of_effect).fold(left, f64::min).min(1.0)
    }

    /// The effects of a stage that are not doubted.
    fn found_at(&self, stage: Stage) -> impl Iterator<Item = &NamedEffect> {
        let doubted = self.misfit.outdone_effect;
        self.effects.iter().filter(move |named| {
            let entry = named.candidate.entry;
            entry.stage == stage && doubted != Some(entry.name)
        })
    }

    fn left_at(&self, stage: Stage) -> f64 {
        if self.verdict == Verdict::Unexplained { self.misfit.nats_at(stage) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
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
}
