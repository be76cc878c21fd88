//! The numbers of a first belief by forecasts, where they forecast better than those of the greatest likelihood.
//!
//! A linear plant is never exact, and the likelihood of the next reading then takes what it lacks for noise of the air:
//! the filter corrects the model within a few readings, and the numbers hardly count. See
//! [`mod@crate::select::by_forecasts`], whose criterion this is.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{Parameter, Prior};
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::select::by_forecasts::{HORIZONS_S, slow_fit, slow_noise};
use crate::select::forecast::{deviations_at_all_horizons, of_patch};
use crate::select::search::Search;
use crate::thresholds::BETTER_FORECAST;
use plant::Model;

/// The model that is fitted by forecasts, with noise that is fitted to what remains. `None`: its held-out forecasts are
/// not better than those of `likely`, the fit by likelihood, by more than chance.
pub(super) fn by_forecasts(likely: &Fit, recording: &Recording) -> Option<Model> {
    let folds = Folds::new(&likely.model, recording);
    let problem = Problem { recording, belief: &likely.model, folds: &folds, prior: Prior::Nothing };
    let search = Search::of(problem);
    let errors = of_patch(&search, &problem.without_each_fold(likely));
    let found = HORIZONS_S.iter().find_map(|horizon_s| {
        let noise = slow_noise(&search, likely, *horizon_s);
        let slow = search.by_forecasts(&folds, noise);
        let fit = slow_fit(&slow, likely, noise);
        let its_errors = of_patch(&slow, &slow.problem.without_each_fold(&fit));
        (deviations_at_all_horizons(&errors, &its_errors) > BETTER_FORECAST).then_some(fit.model)
    })?;
    let found = Model { noise: likely.model.noise, ..found };
    Some(problem.fit(&found, &[Parameter::SensorNoise, Parameter::AirNoise]).model)
}
