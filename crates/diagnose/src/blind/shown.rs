//! How much a record shows of what its owner does not know of, by the densities of the diagnosis.
//!
//! ```text
//! shown = ln p(record | true model) − max over rivals of ln p(record | rival)
//! ```
//!
//! The true model has the rig's own numbers; only the two noises are fitted, as those of the rivals are. Rivals, fitted whole to the record
//! with no prior: the belief, its other effects refitted and that one left as believed, and the same with each effect of the
//! catalogue that is neither the true one nor a twin of it. Of two effects, each is so left out while the other is there. A perfect
//! diagnosis names what is shown by some nats; what a chance of the noise hides is not shown, whatever the Cramér–Rao bound expects.

use super::closed::true_model;
use super::names::imitators;
use super::truth::{CaseTruth, TrueEffect};
use crate::fit::estimate::Problem;
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::record::folds::Folds;
use crate::record::prepare::prepared;
use crate::record::recording::Recording;
use crate::select::candidates::candidates;
use crate::select::refit::with_noise_that_fits;
use crate::select::search::Search;
use plant::Model;

/// Nats by which the true model beats its best rival; of two effects, those of the one that shows less. `None`: no effect, or none that
/// the catalogue can write.
#[must_use]
pub fn shown(belief: &Model, truth: &CaseTruth, recording: &Recording) -> Option<f64> {
    if truth.effects.is_empty() {
        return None;
    }
    let model = true_model(belief, truth)?;
    let (_, recording) = prepared(std::slice::from_ref(recording), belief);
    let folds = Folds::new(belief, &recording);
    let problem = Problem { recording: &recording, belief, folds: &folds, prior: Prior::Nothing };
    let truly = problem.total_of(&problem.fit(&model, &[Parameter::SensorNoise, Parameter::AirNoise]));
    let above = |effect: &TrueEffect| truly - best_rival(problem, &model, truth, &effect.name);
    truth.effects.iter().map(above).reduce(f64::min)
}

/// ln p of the best model in which effect `name` is as believed, and any other departure as it is.
fn best_rival(problem: Problem<'_>, model: &Model, truth: &CaseTruth, name: &str) -> f64 {
    let mut start = problem.belief.clone();
    for other in truth.effects.iter().filter(|other| other.name != name) {
        match model.effects.values(&other.name) {
            Some(values) => start.effects.set(&other.name, &values),
            None => start.effects.remove(&other.name),
        };
    }
    let others = start.effects.present().into_iter().filter(|entry| entry.name != name);
    let of_effect = |name| parameters_of_effect(name, &start.effects.values(name).unwrap_or_default());
    let free: Vec<Parameter> = BASE.into_iter().chain(others.flat_map(|entry| of_effect(entry.name))).collect();
    let search = Search::of(problem).without(|entry| entry.name == name || imitators(name).contains(&entry.name));
    start.noise = with_noise_that_fits(&problem, &free).noise;
    let as_believed = problem.fit(&start, &free);
    let rivals = candidates(&search, &as_believed).0;
    let rivals = rivals.iter().map(|rival| problem.total_of(&rival.fit));
    rivals.fold(problem.total_of(&as_believed), f64::max)
}

#[cfg(test)]
mod tests {
    use super::shown;
    use crate::blind::truth::tests::lag_of_a_rig;
    use crate::tests_support::{model, shaken};
    use plant::{Effects, Model};

    #[test]
    fn a_lag_is_shown_by_a_record_of_a_rig_that_has_it_and_the_more_the_longer_it_is() {
        let belief = Model { effects: Effects::default(), ..model() };
        let of = |seconds| shown(&belief, &lag_of_a_rig("fan_lag"), &shaken(&model(), 3, seconds)).unwrap();
        let (short, long) = (of(20), of(80));
        assert!(short > 5.0 && (2.5..6.0).contains(&(long / short)), "{short} and {long} nats");
    }

    #[test]
    fn what_does_not_act_is_not_shown_and_what_the_catalogue_cannot_write_has_no_number() {
        let rig = Model { effects: Effects::default(), ..model() };
        let recording = shaken(&rig, 3, 40);
        assert!(shown(&rig, &lag_of_a_rig("fan_lag"), &recording).unwrap() < -5.0);
        assert_eq!(shown(&rig, &lag_of_a_rig("gusts"), &recording), None);
    }
}
