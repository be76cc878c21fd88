//! Moments at which something happened that no function of what was known foresees: the readings slipped, or the ball was pushed.
//!
//! ```text
//! z(k, shape)    Σ e·r/√Σ r²        r: what a slip, or a push of some length, from reading k on does to those that follow, over √S
//! nats(m)        −ln P(χ²_m > Σ z²) − ln C(n, m)            the m moments that say most, none within another's reach
//! ```
//!
//! Source: Willsky and Jones, "A generalized likelihood ratio approach to the detection and estimation of jumps in linear systems",
//! IEEE Transactions on Automatic Control 21 (1976).

use super::bursts::bursts;
use super::sensitivities::Step;
use super::{Omitted, Question};
use crate::filter::ekf::Sensitivity;
use crate::stats::chi_square::ln_chance;
use plant::{Model, Stage};
use rayon::prelude::*;

/// How long after a moment its trace is looked for, seconds.
const REACH_S: f64 = 1.2;
/// Lengths of pushes, seconds.
const PUSHES_S: [f64; 3] = [0.1, 0.35, 1.0];
/// A slip that comes so much later is another, seconds, and so is a push by this share of its length.
const OTHER_S: f64 = 0.02;
const OTHER_SHARE: f64 = 0.2;
/// Moments at most that count together, and at which something is looked for.
const MOST: usize = 12;
const MOST_STARTS: usize = 20_000;

/// What may have events_found.
const SHAPES: [Shape; 1 + PUSHES_S.len()] =
    [Shape::Slip, Shape::Push(PUSHES_S[0]), Shape::Push(PUSHES_S[1]), Shape::Push(PUSHES_S[2])];

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Readings are off from then on.
    Slip,
    /// A push for so many seconds.
    Push(f64),
}

impl Shape {
    /// Push and shift, both of 1, so long after the moment.
    fn after(self, since_s: f64) -> (f64, f64) {
        match self {
            Self::Slip => (0.0, 1.0),
            Self::Push(length_s) => (f64::from(u8::from(since_s < length_s)), 0.0),
        }
    }

    /// How much later the same shape is another, seconds.
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
            Self::Slip => format!("readings that slipped at {time_s:.1} s"),
            Self::Push(length_s) => format!("a push of about {length_s} s at {time_s:.1} s"),
        }
    }
}

/// What is looked for at every moment, and what was found.
pub(super) struct Moments {
    /// Where it would begin: the first step that it moves.
    starts: Vec<usize>,
    /// The scores of each shape there, deviations.
    scores: Vec<[f64; SHAPES.len()]>,
}

impl Moments {
    /// Looks for every shape at every moment that is judged.
    pub(super) fn of(model: &Model, steps: &[Step]) -> Self {
        let every = steps.len() / MOST_STARTS + 1;
        let starts: Vec<usize> = (0..steps.len()).step_by(every).filter(|k| steps[*k].judged).collect();
        let scores = starts.par_iter().map(|k| SHAPES.map(|shape| score(model, &steps[*k..], shape))).collect();
        Self { starts, scores }
    }

    /// What happened at the moments that together are least by chance. A `weight` below 1 counts each reading for less.
    pub(super) fn events_found(&self, steps: &[Step], weight: f64) -> Question {
        let rated = self.rated(weight);
        let looks = looks(steps);
        let (mut times_s, mut terms, mut total, mut ways) = (Vec::<f64>::new(), Vec::new(), 0.0, 0.0);
        let mut most = (0.0, 0);
        for (k, shape, z) in rated {
            let time_s = steps[k].time_s;
            if times_s.iter().any(|other| (other - time_s).abs() < REACH_S) {
                continue;
            }
            total += z * z;
            ways += ((looks - terms.len() as f64).max(1.0) / (terms.len() as f64 + 1.0)).ln();
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
        Question { nats: most.0, terms }
    }

    /// How much the pushes come in bursts, deviations: the most of any length.
    pub(super) fn bursts(&self, weight: f64) -> f64 {
        let of = |at: usize| bursts(&self.scores.iter().map(|scores| scores[at]).collect::<Vec<_>>());
        let pushes = (0..SHAPES.len()).filter(|at| matches!(SHAPES[*at], Shape::Push(_)));
        weight.sqrt() * pushes.map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// By each moment the shape that says most there; the most first.
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

/// How many looks there are that are not the same as another.
fn looks(steps: &[Step]) -> f64 {
    let judged_s: f64 = steps.iter().filter(|step| step.judged).filter_map(|step| step.dt).sum();
    SHAPES.iter().map(|shape| judged_s / shape.other_s()).sum()
}

/// The score of a shape that begins with the first of these steps, deviations.
fn score(model: &Model, steps: &[Step], shape: Shape) -> f64 {
    let mut nudged = Sensitivity::zero();
    let (mut since_s, mut product, mut square) = (0.0, 0.0, 0.0);
    for step in steps {
        let Some(dt) = step.dt.filter(|_| since_s < REACH_S) else { break };
        let (push, shift_mm) = shape.after(since_s);
        let moved_mm = nudged.go(model, &step.leg, (dt, push, shift_mm), &step.innovation);
        let moved = step.says() * moved_mm / step.innovation.variance_mm2.sqrt();
        if step.judged && moved.is_finite() {
            product += moved * step.innovation.standardised / step.says();
            square += moved * moved;
        }
        since_s += dt;
    }
    if square > 0.0 { product / square.sqrt() } else { 0.0 }
}
