//! The 90 % interval of one number by its profile likelihood: as far as it can move, all others following, until the record minds.
//!
//! ```text
//! 2·( L(θ̂) − max over the others of L(θ_i = x, others) ) = 2.706        the 90 % quantile of χ² with one degree of freedom
//! ```
//!
//! Where the likelihood is no parabola, as between a drag and a lag that are nearly one double pole, an interval from its curvature is too
//! short; this one is not.
//! Source: Venzon and Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", Applied Statistics 37 (1988).

use crate::fit::{Fit, Problem};
use crate::free::Free;
use plant::Model;

/// Half of the quantile, nats.
const DROP: f64 = 2.706 / 2.0;
/// Near enough to it, nats.
const NEAR: f64 = 0.05;
/// Deviations on either side that hold 90 % of a normal distribution.
pub(crate) const OF_90_PERCENT: f64 = 1.645;
/// Tries at most to find an end, and steps of the others each time.
const TRIES: usize = 8;
const STEPS: usize = 4;
/// An end further than so many deviations is none.
const TOO_FAR: f64 = 12.0;

/// The models at the lower and the upper end of the interval of number `at` of the fit. `None`: the record sets no end there.
pub(crate) fn interval(problem: &Problem<'_>, fit: &Fit, at: usize) -> [Option<Model>; 2] {
    let deviation = fit.deviations().get(at).copied().unwrap_or(f64::INFINITY);
    if !deviation.is_finite() || deviation <= 0.0 {
        return [None, None];
    }
    [-deviation, deviation].map(|towards| end(problem, fit, at, towards))
}

/// The model where the likelihood has dropped enough, on the side of `deviation`.
fn end(problem: &Problem<'_>, fit: &Fit, at: usize, deviation: f64) -> Option<Model> {
    let top = problem.total_of(fit);
    let moved: Free = fit.free[at];
    let others: Vec<Free> = fit.free.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, free)| *free).collect();
    // The root of the drop is nearly a straight line through 0.
    let (mut inside, mut beyond): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
    let mut here = OF_90_PERCENT;
    for _ in 0..TRIES {
        let start = moved.moved(&fit.model, here * deviation);
        let (model, total) = problem.look(&start, &others, STEPS);
        let drop = (top - total).max(0.0);
        if (drop - DROP).abs() < NEAR {
            return Some(model);
        }
        let root = (here, drop.sqrt());
        if drop < DROP {
            inside = root
        } else {
            beyond = Some(root)
        }
        let straight = |a: (f64, f64), b: (f64, f64)| a.0 + (b.0 - a.0) * (DROP.sqrt() - a.1) / (b.1 - a.1);
        here = match beyond {
            Some(beyond) => straight(inside, beyond),
            None => (here * (DROP.sqrt() / root.1.max(0.2)).clamp(1.2, 2.5)).min(TOO_FAR),
        };
        if beyond.is_none() && inside.0 >= TOO_FAR {
            return None;
        }
    }
    beyond.map(|(far, _)| moved.moved(&fit.model, far * deviation))
}
