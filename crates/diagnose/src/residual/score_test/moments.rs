//! Events at single moments that no known signal predicts: a step of the readings, or a force pulse on the ball.
//!
//! ```text
//! z(k, shape)    Σ e·r/√Σ r²        r: effect on later readings of a step or a pulse at reading k, over √S
//! nats(m)        −ln P(χ²_m > Σ z²) − ln C(n, m)            the m moments of largest z, no two within the reach
//! ```
//!
//! Source: Willsky and Jones, "A generalized likelihood ratio approach to the detection and estimation of jumps in
//! linear systems", IEEE Transactions on Automatic Control 21 (1976).

use super::bursts::bursts;
use super::sensitivities::Step;
use super::{JointScore, Omitted};
use crate::filter::ekf::Sensitivity;
use crate::stats::chi_square::ln_chance;
use plant::Stage;
use rayon::prelude::*;

/// Reach: how long after a moment its effect is evaluated, seconds.
const REACH_S: f64 = 1.2;
/// Lengths of pulses, seconds.
const PUSHES_S: [f64; 3] = [0.1, 0.35, 1.0];
/// Resolution in time: of steps, seconds, and of pulses, as a share of their length.
const OTHER_S: f64 = 0.02;
const OTHER_SHARE: f64 = 0.2;
/// Most moments in one result, and most moments that are tested.
const MOST: usize = 12;
const MOST_STARTS: usize = 20_000;

/// All shapes.
const SHAPES: [Shape; 1 + PUSHES_S.len()] =
    [Shape::Slip, Shape::Push(PUSHES_S[0]), Shape::Push(PUSHES_S[1]), Shape::Push(PUSHES_S[2])];

/// The shape of an event.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// A step: all later readings are shifted.
    Slip,
    /// A force pulse of so many seconds.
    Push(f64),
}

impl Shape {
    /// Force and shift of a unit event, so long after the moment.
    fn after(self, since_s: f64) -> (f64, f64) {
        match self {
            Self::Slip => (0.0, 1.0),
            Self::Push(length_s) => (f64::from(u8::from(since_s < length_s)), 0.0),
        }
    }

    /// Shortest time between two distinguishable events of this shape, seconds.
    fn other_s(self) -> f64 {
        match self {
            Self::Slip => OTHER_S,
            Self::Push(length_s) => OTHER_SHARE * length_s,
        }
    }

    fn stage(self) -> Stage {
        match self {
            Self::Slip => Stage::Sensor,
            Self::Push(_) => Stage::Air,
        }
    }

    fn words(self, time_s: f64) -> String {
        match self {
            Self::Slip => format!("a shift of the readings from {time_s:.1} s on"),
            Self::Push(length_s) => format!("a push of about {length_s} s at {time_s:.1} s"),
        }
    }
}

/// Scores of all shapes at all tested moments.
pub(super) struct Moments {
    /// The first step that the event affects.
    starts: Vec<usize>,
    /// The score of each shape there, standard deviations.
    scores: Vec<[f64; SHAPES.len()]>,
}

impl Moments {
    /// Scores every shape at every moment that is judged.
    pub(super) fn of(steps: &[Step]) -> Self {
        let every = steps.len() / MOST_STARTS + 1;
        let starts: Vec<usize> = (0..steps.len()).step_by(every).filter(|k| steps[*k].judged).collect();
        let scores = starts.par_iter().map(|k| SHAPES.map(|shape| score(&steps[*k..], shape))).collect();
        Self { starts, scores }
    }

    /// The events with the smallest joint probability. `weight`: weight of each reading, at most 1.
    pub(super) fn events_found(&self, steps: &[Step], weight: f64) -> JointScore {
        let rated = self.rated(weight);
        let tests = independent_tests(steps);
        let (mut times_s, mut terms, mut total, mut ways) = (Vec::<f64>::new(), Vec::new(), 0.0, 0.0);
        let mut most = (0.0, 0);
        for (k, shape, z) in rated {
            let time_s = steps[k].time_s;
            if times_s.iter().any(|other| (other - time_s).abs() < REACH_S) {
                continue;
            }
            total += z * z;
            ways += ((tests - terms.len() as f64).max(1.0) / (terms.len() as f64 + 1.0)).ln();
            times_s.push(time_s);
            terms.push(Omitted { words: shape.words(time_s), z, stage: Some(shape.stage()) });
            let nats = -ln_chance(total.max(f64::MIN_POSITIVE), terms.len()) - ways;
            if nats > most.0 {
                most = (nats, terms.len());
            }
            if terms.len() == MOST {
                break;
            }
        }
        terms.truncate(most.1);
        JointScore { nats: most.0, terms }
    }

    /// How much force comes in bursts, standard deviations: the largest value over the lengths of pulses.
    pub(super) fn bursts(&self, weight: f64) -> f64 {
        let of = |at: usize| bursts(&self.scores.iter().map(|scores| scores[at]).collect::<Vec<_>>());
        let pushes = (0..SHAPES.len()).filter(|at| matches!(SHAPES[*at], Shape::Push(_)));
        weight.sqrt() * pushes.map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The shape with the largest score at each moment, largest first.
    fn rated(&self, weight: f64) -> Vec<(usize, Shape, f64)> {
        let best = |(k, scores): (&usize, &[f64; SHAPES.len()])| {
            let rated = SHAPES.iter().zip(scores).map(|(shape, z)| (*k, *shape, weight.sqrt() * z));
            rated.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))
        };
        let mut rated: Vec<_> = self.starts.iter().zip(&self.scores).filter_map(best).collect();
        rated.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        rated
    }
}

/// Effective number of independent tests.
fn independent_tests(steps: &[Step]) -> f64 {
    let judged_s: f64 = steps.iter().filter(|step| step.judged).filter_map(|step| step.dt).sum();
    SHAPES.iter().map(|shape| judged_s / shape.other_s()).sum()
}

/// The score of a shape that begins at the first of these steps, standard deviations.
fn score(steps: &[Step], shape: Shape) -> f64 {
    let mut nudged = Sensitivity::zero();
    let (mut since_s, mut product, mut square) = (0.0, 0.0, 0.0);
    for step in steps {
        let Some(dt) = step.dt.filter(|_| since_s < REACH_S) else { break };
        let (push, shift_mm) = shape.after(since_s);
        let moved_mm = nudged.go(&step.leg, (dt, push, shift_mm), &step.innovation);
        let moved = step.root_weight() * moved_mm / step.innovation.variance_mm2.sqrt();
        if step.judged && moved.is_finite() {
            product += moved * step.innovation.standardised / step.root_weight();
            square += moved * moved;
        }
        since_s += dt;
    }
    if square > 0.0 { product / square.sqrt() } else { 0.0 }
}
