//! The 90 % intervals of the numbers that a diagnosis found.
//!
//! ```text
//! reach = √( p² + (1.645·f)² )        p: how far a number moves, down and up, until likelihood and prior drop by ½·(1.645·w)²
//! ```
//!
//! w: how much wider than the likelihood's own, which takes the form of an effect for exact, 1 of what is read off; f: what a delay may
//! stand for of the forms of the lags.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{COARSE, Free, STALE};
use crate::fit::profile::{OF_90_PERCENT, interval};
use crate::record::quantisation::coarse_step;
use crate::record::recording::Recording;
use crate::record::sample_hold::hold;
use plant::Model;
use rayon::prelude::*;

/// How much wider intervals are than those of the likelihood: where a ball bounces, and a filter takes its state for normal all the same; of
/// a thrust that bends, a play and a lag, which no rig has of the catalogue's form (a power of the duty, a spread of plays, of first order); of
/// other effects; and of the base parameters. Of withheld rigs some 90 % lie within.
const WIDER_AT_STOPS: f64 = 2.5;
const WIDER_OF_SHAPES: f64 = 1.9;
pub(crate) const WIDER: f64 = 1.25;
const WIDER_OF_BASE: f64 = 1.25;

/// How far a number reaches down and up from where it was found, in its own scale.
pub(crate) type Reach = (Free, [f64; 2]);

/// How far the numbers of a fit reach: those of effects by the profile of the likelihood, which need not be a parabola, base parameters by
/// its curvature. None of a number that the record does not determine, nor of a step of duty, where each valley is a grid of its own.
pub(crate) fn reaches(problem: &Problem<'_>, fit: &Fit) -> Vec<Reach> {
    let deviations = fit.deviations();
    let reach = |(at, free): (usize, &Free)| match free {
        Free::Effect { name: "duty_quantisation", .. } => None,
        Free::Effect { name, .. } => {
            let [down, up] = interval(problem, fit, at, OF_90_PERCENT * wider(name));
            Some((*free, [-down?, up?]))
        }
        _ => Some((*free, [OF_90_PERCENT * WIDER_OF_BASE * deviations[at]; 2])),
    };
    let moved: Vec<Option<Reach>> = fit.free.par_iter().enumerate().map(reach).collect();
    let read_off = read_off(&fit.model, problem.recording).into_iter();
    let read_off = read_off.map(|(free, deviation)| (free, [OF_90_PERCENT * deviation; 2]));
    let all = moved.into_iter().flatten().chain(read_off);
    all.filter(|(_, reach)| reach.iter().all(|by| by.is_finite())).collect()
}

/// The step of a coarse sensor and the hold of a slow one as numbers of the model, and their standard deviations in their own scale.
fn read_off(model: &Model, recording: &Recording) -> Vec<(Free, f64)> {
    let coarse = model.effects.sensor_quantisation.and_then(|_| coarse_step(recording, model));
    let stale = model.effects.stale_samples.and_then(|_| hold(recording));
    let coarse = coarse.map(|step| (Free::Effect { name: COARSE, index: 0, size: step.mm }, step.sigma_mm / step.mm));
    let stale =
        stale.map(|hold| (Free::Effect { name: STALE, index: 0, size: hold.seconds }, hold.sigma_s / hold.seconds));
    coarse.into_iter().chain(stale).collect()
}

/// How much wider the interval of a number of an effect is than that of the likelihood.
fn wider(effect: &str) -> f64 {
    match effect {
        "end_stop" => WIDER_AT_STOPS,
        "thrust_curve" | "hysteresis" | "fan_lag" | "sensor_lag" => WIDER_OF_SHAPES,
        _ => WIDER,
    }
}

#[cfg(test)]
mod tests {
    use super::{Reach, WIDER_OF_SHAPES, reaches};
    use crate::fit::parameter::{BASE, free_of_effect};
    use crate::fit::profile::OF_90_PERCENT;
    use crate::tests_support::{model, record};
    use crate::{Fit, Folds, Free, Prior, Problem};

    /// Shows `check` the model fitted to a record of a rig whose `effect` is `values`, and how far the effect's first number reaches.
    fn reach(effect: &'static str, values: &[f64], seed: u64, check: impl Fn(&Problem<'_>, &Fit, Reach)) {
        let belief = model();
        let mut rig = belief.clone();
        rig.effects.set(effect, values);
        let recording = record(&rig, seed, 60);
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let free: Vec<Free> = BASE.into_iter().chain(free_of_effect(effect, values)).collect();
        let fit = problem.fit(&rig, &free);
        let first = reaches(&problem, &fit).into_iter().find(|(free, _)| free.is_of(effect));
        check(&problem, &fit, first.unwrap());
    }

    #[test]
    fn a_number_reaches_to_where_the_record_minds() {
        for seed in 0..3 {
            reach("hysteresis", &[0.3], seed, |problem, fit, (number, [down, up])| {
                let minds = 0.5 * (OF_90_PERCENT * WIDER_OF_SHAPES).powi(2);
                for by in [-down, up] {
                    let there = problem.fit(&number.moved(&fit.model, by), &BASE);
                    let dropped = problem.total_of(fit) - problem.total_of(&there);
                    assert!((dropped / minds - 1.0).abs() < 0.2, "seed {seed}: {by} costs {dropped} of {minds} nats");
                }
            });
        }
    }

    #[test]
    fn a_number_that_may_go_no_further_ends_there() {
        // A zone of one side and a moved hover explain the same record: either edge may be at hover.
        reach("dead_zone", &[-0.1, 0.3], 1, |_, fit, (lower, [_, up])| {
            assert_eq!(lower.value(&lower.moved(&fit.model, up)), Some(0.0));
        });
    }
}
