//! The log-likelihood of a record under a model, for comparisons of models outside a diagnosis.

use crate::filter::track::innovations;
use crate::fit::estimate::Problem;
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use plant::{Entry, Model};

/// Σ ln p(ν) of the readings of `flight` under `model`, nats. Readings count that are in free flight by `reference`, so
/// that several models compare on the same ones. With `refit`, the model's parameters are first moved by so many steps
/// towards where the record is most likely.
#[must_use]
pub fn log_likelihood(model: &Model, flight: &Recording, reference: &Model, refit: Option<usize>) -> f64 {
    let folds = Folds::new(reference, flight);
    let refitted = refit.map(|steps| {
        let problem = Problem { recording: flight, belief: model, folds: &folds, prior: Prior::Belief };
        problem.fit_in_steps(model, &parameters_of(model), steps)
    });
    let innovations = innovations(refitted.as_ref().unwrap_or(model), flight);
    innovations.iter().filter(|one| folds.counts(one.row)).map(|one| one.log_density).sum()
}

/// The base parameters and those of every effect that is on.
fn parameters_of(model: &Model) -> Vec<Parameter> {
    let present = model.effects.present();
    let values = |entry: &Entry| model.effects.values(entry.name).unwrap_or_default();
    let of_effects = present.iter().flat_map(|entry| parameters_of_effect(entry, &values(entry)));
    BASE.into_iter().chain(of_effects).collect()
}

#[cfg(test)]
mod tests {
    use super::log_likelihood;
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    #[test]
    fn a_right_model_is_likelier_than_one_that_lacks_its_lag_and_a_refit_makes_up_for_a_wrong_gain() {
        let (rig, recording) = (model(), record(&model(), 1, 40));
        let of = |model: &Model, refit| log_likelihood(model, &recording, &rig, refit);
        let lacking = Model { effects: Effects::default(), ..rig.clone() };
        assert!(of(&rig, None) > of(&lacking, None) + 20.0);
        let wrong = Model { gain_mm_per_s2_per_percent: 1.1 * rig.gain_mm_per_s2_per_percent, ..rig.clone() };
        assert!(of(&wrong, Some(4)) > of(&wrong, None) && of(&wrong, Some(4)) > of(&rig, None) - 2.0);
    }
}
