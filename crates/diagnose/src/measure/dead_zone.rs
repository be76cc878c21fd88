//! Dead zone: the duties at which the force begins, from jumps with duties near hover.
//!
//! ```text
//! F = K·max(0, u − upper)      for the jumps without a significant force downwards; the lower edge likewise
//! interval                     χ², minimised over K, within 2.71 of its least value (profile likelihood)
//! ```
//!
//! Both edges are absolute duties. The hover duty within the zone is arbitrary; the middle is used. A misfit of the
//! straight line, for example by a curved characteristic, widens the intervals. Each edge is estimated separately, so
//! that the two edges of a rig without a dead zone differ by chance only. Sources: the thesis, section 3.2.1 and figure
//! 3.2.1; Venzon & Moolgavkar, "Profile-likelihood-based confidence intervals", Applied Statistics 37 (1988).

use super::jumps::{Jump, Jumps};
use super::{Estimate, MeasureError};
use crate::stats::student::NORMAL_QUANTILE;
use serde::Serialize;

/// Largest distance of a duty from hover, percent.
const NEAR_PERCENT: f64 = 1.6;
/// Smallest number of jumps on each side with a significant force, and the limit in standard deviations.
const FEWEST: usize = 4;
const BEYOND_DOUBT: f64 = 3.0;
/// Step of the grid of edges, percent, and its extent beyond the points.
const STEP_PERCENT: f64 = 5e-4;
const BEYOND_PERCENT: f64 = 0.5;
/// χ² per degree of freedom above which the line does not fit.
const MISFIT: f64 = 1.6;

/// The edges of the dead zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeadZone {
    /// Duty below which the ball falls, percent.
    pub lower_duty_percent: Estimate,
    /// Duty above which the ball rises, percent.
    pub upper_duty_percent: Estimate,
    /// Force per percent of duty below the lower edge, mm/s² per percent.
    pub gain_below: Estimate,
    /// The same above the upper edge.
    pub gain_above: Estimate,
}

/// A duty and its force, with signs such that the force is positive beyond the edge.
#[derive(Clone, Copy)]
struct Point {
    duty: f64,
    force: f64,
    weight: f64,
}

/// The edges from the forces of jumps.
///
/// # Errors
/// [`MeasureError::OneSided`] when the jumps do not move the ball both ways.
pub fn dead_zone(found: &Jumps) -> Result<DeadZone, MeasureError> {
    let sure = |jump: &&Jump| jump.mm_per_s2.value.abs() > BEYOND_DOUBT * jump.own_deviation;
    let (up, down): (Vec<&Jump>, Vec<&Jump>) =
        found.jumps.iter().filter(sure).partition(|jump| jump.mm_per_s2.value > 0.0);
    let highest_down = down.iter().map(|jump| jump.duty_percent).fold(f64::NEG_INFINITY, f64::max);
    let lowest_up = up.iter().map(|jump| jump.duty_percent).fold(f64::INFINITY, f64::min);
    let middle = (highest_down + lowest_up) / 2.0;
    let side = |sign: f64| -> Vec<Point> {
        let points = found.jumps.iter().map(|jump| Point {
            duty: sign * (jump.duty_percent - middle),
            force: sign * jump.mm_per_s2.value,
            weight: jump.own_deviation.powi(-2),
        });
        points.filter(|point| (0.0..NEAR_PERCENT).contains(&point.duty)).collect()
    };
    let one_sided = || MeasureError::OneSided {
        below: down.len(),
        above: up.len(),
        needed: FEWEST,
        middle_percent: found.jumps.iter().map(|j| j.duty_percent).sum::<f64>() / found.jumps.len().max(1) as f64,
    };
    if !middle.is_finite() {
        return Err(one_sided());
    }
    let (upper, above) = edge(&side(1.0)).ok_or_else(one_sided)?;
    let (lower, below) = edge(&side(-1.0)).ok_or_else(one_sided)?;
    let shared = shared_share(&found.jumps);
    Ok(DeadZone {
        lower_duty_percent: lower.mapped(-1.0, middle),
        upper_duty_percent: upper.mapped(1.0, middle),
        gain_below: Estimate::normal(below.0, below.1.hypot(shared * below.0)),
        gain_above: Estimate::normal(above.0, above.1.hypot(shared * above.0)),
    })
}

/// Common relative standard deviation of all forces.
fn shared_share(jumps: &[Jump]) -> f64 {
    let (up, down) = jumps.iter().fold((0.0, 0.0), |(up, down), jump| {
        let force = jump.mm_per_s2.value.abs();
        (up + force * jump.shared_deviation, down + force * force)
    });
    if down > 0.0 { up / down } else { 0.0 }
}

/// The edge of a side, and the gain with its standard deviation; `None` for too few points.
fn edge(points: &[Point]) -> Option<(Estimate, (f64, f64))> {
    let sure = points.iter().filter(|point| point.force > BEYOND_DOUBT * point.weight.powf(-0.5)).count();
    let last = points.iter().map(|point| point.duty).fold(f64::NEG_INFINITY, f64::max);
    if sure < FEWEST {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand steps at most")]
    let steps = ((last + BEYOND_PERCENT) / STEP_PERCENT) as u32;
    let tried: Vec<(f64, Line)> = (0..steps)
        .map(|k| f64::from(k) * STEP_PERCENT - BEYOND_PERCENT)
        .map(|at| (at, Line::from(points, at)))
        .filter(|(_, line)| line.chi_square.is_finite())
        .collect();
    let (at, best) = *tried.iter().min_by(|a, b| a.1.chi_square.total_cmp(&b.1.chi_square))?;
    let per_freedom = best.chi_square / (points.len() as f64 - 2.0).max(1.0);
    let wider = if per_freedom > MISFIT { per_freedom } else { 1.0 };
    let within = || {
        tried.iter().filter(|(_, line)| line.chi_square <= best.chi_square + NORMAL_QUANTILE * NORMAL_QUANTILE * wider)
    };
    let low = within().map(|(at, _)| *at).fold(at, f64::min);
    let high = within().map(|(at, _)| *at).fold(at, f64::max);
    // The errors of edge and gain are correlated: the gains within the interval of the edge give that part of the
    // error.
    let by_edge = within().map(|(_, line)| (line.gain - best.gain).abs()).fold(0.0, f64::max) / NORMAL_QUANTILE;
    Some((Estimate { value: at, low, high }, (best.gain, by_edge.hypot(best.gain_deviation * wider.sqrt()))))
}

/// The best line for a given edge.
#[derive(Clone, Copy)]
struct Line {
    gain: f64,
    gain_deviation: f64,
    chi_square: f64,
}

impl Line {
    fn from(points: &[Point], edge: f64) -> Self {
        let beyond = |point: &Point| (point.duty - edge).max(0.0);
        let power: f64 = points.iter().map(|p| p.weight * beyond(p).powi(2)).sum();
        let gain = points.iter().map(|p| p.weight * beyond(p) * p.force).sum::<f64>() / power;
        let chi_square = points.iter().map(|p| p.weight * (p.force - gain * beyond(p)).powi(2)).sum();
        Self { gain, gain_deviation: power.powf(-0.5), chi_square }
    }
}
