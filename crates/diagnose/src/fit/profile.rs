//! The interval of one parameter by its profile likelihood: how far it can move, all others refitted, until the
//! likelihood drops.
//!
//! ```text
//! L(θ̂) − max over the others of L(θ_i = x, others) = ½·z²
//! z = 1.645 for 90 %: z² = 2.706, the quantile of χ² with one degree of freedom
//! ```
//!
//! Where the likelihood is no parabola, as between a drag and a lag that nearly form a double pole, or is rough, as
//! that of hysteresis, an interval from the curvature is too short; this one is not.
//! Source: Venzon and Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", Applied
//! Statistics 37 (1988).

use crate::fit::derivatives::KnownSensitivities;
use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::Parameter;

/// Tolerance of the drop, as a share of it; and the largest drop that the search uses, in multiples of it.
const NEAR: f64 = 0.04;
const FAR: f64 = 100.0;
/// Half-width of the 90 % interval of a normal distribution, in standard deviations.
pub(crate) const OF_90_PERCENT: f64 = 1.645;
/// Most evaluations to find an end, and fitting steps of the other parameters in each.
const TRIES: usize = 8;
const STEPS: usize = 4;
/// There is no end further than this many standard deviations and than one unit of the parameter's own scale.
const TOO_FAR: f64 = 12.0;
const UNIT: f64 = 1.0;
/// Least standard deviation to start from, in the parameter's own scale: a rough likelihood may have a spurious
/// curvature at its maximum.
const LEAST_DEVIATION: f64 = 0.02;

/// The distances from the estimate of parameter `at` to the lower (negative) and upper end of its interval, in its own
/// scale: `z` standard deviations where the likelihood is a parabola. `known`: the derivatives at the fit, which serve
/// to refit the others. `None`: neither the record nor the parameter's bounds set an end there.
pub(crate) fn interval(
    problem: &Problem<'_>,
    fit: &Fit,
    known: &KnownSensitivities,
    at: usize,
    z: f64,
) -> [Option<f64>; 2] {
    let deviation = fit.deviations().get(at).copied().unwrap_or(f64::INFINITY);
    if !deviation.is_finite() {
        return [None, None];
    }
    let deviation = deviation.max(LEAST_DEVIATION);
    [-deviation, deviation].map(|towards| end(problem, fit, known, at, towards, z))
}

/// The distance at which the likelihood has dropped enough on the side of `deviation`, or at which the parameter
/// reaches its bound.
fn end(problem: &Problem<'_>, fit: &Fit, known: &KnownSensitivities, at: usize, deviation: f64, z: f64) -> Option<f64> {
    let (top, enough) = (problem.total_of(fit), 0.5 * z * z);
    let number: Parameter = fit.parameters[at];
    let others: Vec<Parameter> =
        fit.parameters.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, parameter)| *parameter).collect();
    let room = number.room(&fit.model, deviation, &problem.bounds());
    let furthest = room.min((TOO_FAR * deviation.abs()).max(UNIT));
    // The square root of the drop is nearly a straight line through 0.
    let (mut inside, mut beyond): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
    let mut here = (z * deviation.abs()).min(furthest);
    for left in (0..TRIES).rev() {
        if left == 0 && beyond.is_none() {
            here = furthest;
        }
        let by = here.copysign(deviation);
        let (model, total) = problem.fit_briefly_with(known, &number.stepped(&fit.model, by), &others, STEPS);
        let drop = top - total - problem.log_prior(&[number], &model);
        // A model without finite likelihood is far beyond the end.
        let drop = if drop.is_finite() { drop.clamp(0.0, FAR * enough) } else { FAR * enough };
        if (drop - enough).abs() < NEAR * enough {
            return Some(by);
        }
        if drop < enough && here >= furthest {
            return (furthest == room).then_some(by);
        }
        let root = (here, drop.sqrt());
        if drop < enough {
            inside = root
        } else {
            beyond = Some(root)
        }
        let straight = |a: (f64, f64), b: (f64, f64)| a.0 + (b.0 - a.0) * (enough.sqrt() - a.1) / (b.1 - a.1);
        here = match beyond {
            Some(beyond) => straight(inside, beyond),
            None => (here * (enough.sqrt() / root.1.max(0.2)).clamp(1.2, 2.5)).min(furthest),
        };
    }
    beyond.map(|(far, _)| far.copysign(deviation))
}
