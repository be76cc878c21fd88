//! Refit of the belief: its base parameters and those of its effects.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{BASE, Parameter, parameters_of_effect};
use crate::record::read_off::read_off;
use crate::select::search::Search;
use crate::thresholds::{EQUIVALENT, OTHER_NOISE};
use plant::{Entry, Model};
use rayon::prelude::*;

/// Factors on the believed noise from which a refit may start.
const AIR_ORDERS: [f64; 8] = [0.1, 1.0, 10.0, 100.0, 1e3, 1e5, 1e7, 1e9];
const SENSOR_ORDERS: [f64; 3] = [0.2, 1.0, 5.0];
/// Factors on the fitted size of a believed effect from which it is fitted again, and the smallest number of steps.
const OTHER_SIZES: [f64; 4] = [0.35, 0.6, 1.7, 2.8];
const STEPS_FROM_OTHER_SIZES: usize = 4;

/// The belief with its base parameters and the parameters of its effects fitted, because no belief is exact.
pub(crate) fn refitted(search: &Search<'_>) -> Fit {
    let belief = search.problem.belief;
    let own = belief.effects.present();
    let of_effect =
        |entry: &'static Entry| parameters_of_effect(entry, &belief.effects.values(entry.name).unwrap_or_default());
    let parameters: Vec<Parameter> = BASE.into_iter().chain(own.into_iter().flat_map(of_effect)).collect();
    let fit = search.problem.fit(&with_noise_that_fits(&search.problem, &parameters), &parameters);
    with_other_sizes(search, fit)
}

/// `fit`, or a better one from another size of a believed effect, because the likelihood may be flat between the two.
pub(crate) fn with_other_sizes(search: &Search<'_>, fit: Fit) -> Fit {
    let present = search.problem.belief.effects.present();
    let starts = present.iter().flat_map(|entry| OTHER_SIZES.map(|factor| (entry, factor)));
    let scaled = starts.collect::<Vec<_>>().into_par_iter().map(|(entry, factor)| {
        let values = fit.model.effects.values(entry.name).unwrap_or_default();
        let neutral = entry.neutral(&fit.model);
        let other: Vec<f64> =
            values.iter().zip(&neutral).map(|(v, neutral)| neutral + factor * (v - neutral)).collect();
        let noise = if search.is_by_forecasts() { fit.model.noise } else { search.problem.belief.noise };
        let mut model = Model { noise, ..fit.model.clone() };
        model.effects.set(entry.name, &other);
        search.problem.fit_briefly(&model, &fit.parameters, STEPS_FROM_OTHER_SIZES)
    });
    let best = scaled.max_by(|a, b| a.1.total_cmp(&b.1));
    match best {
        Some((model, total)) if total > search.problem.total_of(&fit) + EQUIVALENT => {
            search.problem.fit(&model, &fit.parameters)
        }
        _ => fit,
    }
}

/// The belief with the step of a coarse sensor and the period of a slow one as the readings show them.
fn as_readings_show(problem: &Problem<'_>) -> Model {
    let mut belief = problem.belief.clone();
    for entry in belief.effects.present().iter().filter(|entry| entry.start.is_read_off()) {
        let value = read_off(entry, problem.recording, problem.belief).map_or(0.0, |read| read.value);
        belief.effects.set(entry.name, &[value]);
    }
    belief
}

/// The belief, or the belief with another noise level if that is far more likely: where every reading is an outlier the
/// likelihood is flat.
pub(crate) fn with_noise_that_fits(problem: &Problem<'_>, parameters: &[Parameter]) -> Model {
    let belief = as_readings_show(problem);
    let factors = AIR_ORDERS.iter().flat_map(|air| SENSOR_ORDERS.iter().map(move |sensor| (*air, *sensor)));
    let rated = factors.collect::<Vec<_>>().into_par_iter().map(|(air, sensor): (f64, f64)| {
        let model = Parameter::SensorNoise.stepped(&Parameter::AirNoise.stepped(&belief, air.ln()), sensor.ln());
        (problem.total(&model, parameters), model)
    });
    let best = rated.max_by(|a, b| a.0.total_cmp(&b.0));
    let here = problem.total(&belief, parameters);
    best.filter(|(total, _)| *total > here + OTHER_NOISE).map_or(belief, |(_, model)| model)
}
