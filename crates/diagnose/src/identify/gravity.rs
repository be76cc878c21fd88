//! Gravity on a rig whose position is an angle, in the place of a force that is linear in it.
//!
//! It is tried without such a force too: over a full turn gravity has no linear part.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::select::forecast::forecasts_worse;
use crate::select::regression::regressed;
use crate::select::search::Search;
use plant::effects::{FanLag, HeightDependentFlow};
use plant::{Effect, Model};

/// Steps of the fits of which the best is continued: few, since a regression gives their initial values.
const FIRST_LOOK: usize = 2;

/// A fitted linear model with gravity, fitted to the recording. `None`: the position is no angle, or no such pendulum
/// is possible.
pub(super) fn gravity(linear: &Model, turn_mm: Option<f64>, recording: &Recording) -> Option<Model> {
    let entry = &HeightDependentFlow::ENTRY;
    let mut bare = Model { turn_mm: Some(turn_mm?), ..linear.clone() };
    bare.effects.remove(entry.name);
    let folds = Folds::new(&bare, recording);
    let problem = Problem { recording, belief: &bare, folds: &folds, prior: Prior::Nothing };
    let with_parameters = |model: Model| -> (Model, Vec<Parameter>) {
        let mut parameters = BASE.to_vec();
        for entry in [entry, &FanLag::ENTRY] {
            let values = model.effects.values(entry.name);
            parameters.extend(values.map_or_else(Vec::new, |values| parameters_of_effect(entry, &values)));
        }
        (model, parameters)
    };
    let looks = regressed(entry, &bare, &bare, recording).into_iter().map(with_parameters);
    let looks = looks.map(|(model, parameters)| problem.fit_briefly(&model, &parameters, FIRST_LOOK));
    let (best, _) = looks.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (best, parameters) = with_parameters(best);
    Some(problem.fit(&best, &parameters).model)
}

/// Whether gravity is seen: as a force linear in the position, or by forecasts that are better by more than chance. A
/// sine over the position may stand for a little of any misfit, and raise the likelihood of the next reading.
pub(super) fn is_seen(linear: &Fit, gravity: &Fit, recording: &Recording) -> bool {
    let folds = Folds::new(&linear.model, recording);
    let problem = Problem { recording, belief: &linear.model, folds: &folds, prior: Prior::Nothing };
    linear.model.effects.values(HeightDependentFlow::ENTRY.name).is_some()
        || forecasts_worse(&Search::of(problem), linear, gravity)
}
