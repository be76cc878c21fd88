//! A fit beside a coloured random force.
//!
//! A model with a white random force prefers an effect that smooths the readings, such as a lag of the sensor, wherever it
//! lacks something else: what is missing acts for a while, as a coloured force does, and a smoothed white force resembles
//! that. Beside a coloured force there is no such preference.

use crate::fit::estimate::Fit;
use crate::select::screening::added;
use crate::select::search::Search;
use plant::{Effect, effects::Turbulence};

/// Correlation times that the fit starts from, seconds, each with the share of the random force that is coloured.
const STARTS: [(f64, f64); 4] = [(0.05, 0.5), (0.2, 0.9), (0.6, 0.9), (2.0, 0.5)];
/// Scoring steps by which the starts are compared.
const STEPS: usize = 2;

/// A fit beside a coloured random force; `None`: the force explains nothing, the model has one, or the search is by
/// forecasts, whose innovations are errors of forecasts.
pub(crate) fn beside_coloured_force(search: &Search<'_>, fit: &Fit) -> Option<Fit> {
    if search.is_by_forecasts() {
        return None;
    }
    let psd = fit.model.noise.acceleration_psd_mm2_per_s3;
    let started = STARTS.into_iter().filter_map(|(correlation_s, coloured)| {
        let values = [(coloured * psd / (2.0 * correlation_s)).sqrt(), correlation_s];
        let (mut model, parameters) = added(&fit.model, &fit.parameters, &Turbulence::ENTRY, &values)?;
        model.noise.acceleration_psd_mm2_per_s3 = (1.0 - coloured) * psd;
        let (model, total) = search.problem.fit_briefly(&model, &parameters, STEPS);
        Some((model, parameters, total))
    });
    let (model, parameters, _) = started.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let beside = search.problem.fit(&model, &parameters);
    (search.held_out_total(&beside) > search.held_out_total(fit)).then_some(beside)
}

/// Held-out log-likelihood plus log-prior of a fit beside a coloured random force, nats.
pub(crate) fn held_out_beside_coloured_force(search: &Search<'_>, fit: &Fit) -> f64 {
    search.held_out_total(beside_coloured_force(search, fit).as_ref().unwrap_or(fit))
}
