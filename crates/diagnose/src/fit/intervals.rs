//! The 90 % intervals of the fitted parameters.
//!
//! ```text
//! reach = √( p² + (1.645·f)² )
//! p: distance, down and up, at which log-likelihood and log-prior drop by ½·(1.645·w)²
//! ```
//!
//! w: ratio of the width to that of the likelihood, which assumes that the form of an effect is exact; 1 for what is
//! read off. f: standard deviation of a delay by the unknown form of the lags.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::Parameter;
use crate::fit::profile::{OF_90_PERCENT, interval};
use crate::record::read_off::read_off;
use crate::thresholds::{WIDER, WIDER_APPROXIMATE, WIDER_IMPACTS};
use plant::{Definition, Entry, Form, Model, Start};
use rayon::prelude::*;

/// A parameter, and the distances from its estimate to the lower and upper end of its interval, in its own scale.
pub(crate) type Reach = (Parameter, [f64; 2]);

/// The intervals of a fit: for effects from the profile likelihood, which need not be a parabola, for base parameters
/// and the many coefficients of a formula from the curvature. None for a parameter that the record does not determine,
/// nor for a step of duty, where the likelihood has a maximum for each grid.
pub(crate) fn reaches(problem: &Problem<'_>, fit: &Fit, formula: &[&'static Definition]) -> Vec<Reach> {
    let deviations = fit.deviations();
    let known = problem.sensitivities_of(fit, &fit.parameters);
    let curved = |at: usize, wider: f64| [OF_90_PERCENT * wider * deviations[at]; 2];
    let of_formula = |entry: &Entry| formula.iter().any(|shape| shape.entry().name == entry.name);
    let reach = |(at, parameter): (usize, &Parameter)| match parameter {
        Parameter::Effect { entry, .. } if of_formula(entry) => Some((*parameter, curved(at, wider(entry)))),
        Parameter::Effect { entry, .. } if entry.start != Start::DutySteps => {
            let [down, up] = interval(problem, fit, &known, at, OF_90_PERCENT * wider(entry));
            Some((*parameter, [-down?, up?]))
        }
        Parameter::Effect { .. } => None,
        _ => Some((*parameter, curved(at, WIDER))),
    };
    let moved: Vec<Option<Reach>> = fit.parameters.par_iter().enumerate().map(reach).collect();
    let read_off = read_off_parameters(&fit.model, problem).into_iter();
    let read_off = read_off.map(|(parameter, deviation)| (parameter, [OF_90_PERCENT * deviation; 2]));
    let all = moved.into_iter().flatten().chain(read_off);
    all.filter(|(_, reach)| reach.iter().all(|by| by.is_finite())).collect()
}

/// The parameters of the model that were read off the readings, and their standard deviations in their own scale.
fn read_off_parameters(model: &Model, problem: &Problem<'_>) -> Vec<(Parameter, f64)> {
    let read = |entry: &'static Entry| {
        let read = read_off(entry, problem.recording, problem.belief)?;
        Some((Parameter::Effect { entry, index: 0, size: read.value }, read.sigma / read.value))
    };
    model.effects.present().into_iter().filter_map(read).collect()
}

/// Ratio of the width of an effect's intervals to that of the likelihood.
fn wider(effect: &Entry) -> f64 {
    match effect.form {
        Form::Impacts => WIDER_IMPACTS,
        Form::Approximate => WIDER_APPROXIMATE,
        Form::Usual => WIDER,
    }
}

#[cfg(test)]
mod tests {
    use super::{Reach, reaches};
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::Prior;
    use crate::fit::parameter::{BASE, parameters_of_effect};
    use crate::fit::profile::OF_90_PERCENT;
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use crate::thresholds::WIDER_APPROXIMATE;
    use crate::{Fit, Parameter};
    use plant::Effects;

    /// Fits a record of a rig whose `effect` has `values`, and calls `check` with the fit and the interval of the
    /// effect's first parameter.
    fn reach(effect: &'static str, values: &[f64], seed: u64, check: impl Fn(&Problem<'_>, &Fit, Reach)) {
        let belief = model();
        let mut rig = belief.clone();
        rig.effects.set(effect, values);
        let recording = record(&rig, seed, 60);
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let parameters: Vec<Parameter> =
            BASE.into_iter().chain(parameters_of_effect(Effects::built_in(effect).unwrap(), values)).collect();
        let fit = problem.fit(&rig, &parameters);
        let first = reaches(&problem, &fit, &[]).into_iter().find(|(parameter, _)| parameter.is_of(effect));
        check(&problem, &fit, first.unwrap());
    }

    #[test]
    fn a_number_reaches_to_where_the_record_minds() {
        for seed in 0..3 {
            reach("hysteresis", &[0.3], seed, |problem, fit, (number, [down, up])| {
                let minds = 0.5 * (OF_90_PERCENT * WIDER_APPROXIMATE).powi(2);
                for by in [-down, up] {
                    let there = problem.fit(&number.stepped(&fit.model, by), &BASE);
                    let dropped = problem.total_of(fit) - problem.total_of(&there);
                    assert!((dropped / minds - 1.0).abs() < 0.2, "seed {seed}: {by} costs {dropped} of {minds} nats");
                }
            });
        }
    }

    #[test]
    fn a_number_that_may_go_no_further_ends_there() {
        // A one-sided dead zone and a shifted hover explain the same record: either edge may be at hover.
        reach("dead_zone", &[-0.1, 0.3], 1, |_, fit, (lower, [_, up])| {
            assert_eq!(lower.value(&lower.stepped(&fit.model, up)), Some(0.0));
        });
    }
}
