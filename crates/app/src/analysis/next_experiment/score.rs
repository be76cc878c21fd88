//! How well an experiment separates rivals: it is flown on each, and the likelihood of each record is computed under
//! all.

use super::candidates::Candidate;
use super::{Rival, SEPARATES, settle_s};
use crate::analysis::virtual_flight::{Desk, Flown};
use crate::log::reader::sample;
use diagnose::{Recording, in_free_flight, log_likelihood};
use plant::Model;

/// The seed of every flight: experiments are compared on the same noise.
const SEED: u64 = 1;
/// A ball nearer to an end than this share of its travel has reached it.
const AT_END: f64 = 0.02;
/// Share of cycles whose duty may be at a limit: noise causes single ones.
const AT_LIMIT: f64 = 0.01;
/// Scoring steps by which a rival's parameters are fitted to another's record: enough where both are near.
const STEPS: usize = 2;

/// A pair of names.
pub(super) type Pair = (&'static str, &'static str);

/// The records of an experiment, one per rival.
pub(super) struct Records(Vec<Recording>);

/// Flies an experiment on every rival. `None`: it is not safe on one of them.
pub(super) fn fly_all(candidate: &Candidate, rivals: &[Rival], desk: &Desk) -> Option<Records> {
    let record = |(_, model): &Rival| {
        let flown = desk.fly(model, &candidate.experiment, SEED);
        if !is_safe(&flown, model, desk, settle_s(&candidate.experiment)) {
            return None;
        }
        Recording::new(flown.cycles.iter().map(sample).collect()).ok()
    };
    rivals.iter().map(record).collect::<Option<_>>().map(Records)
}

/// Whether, after take-off, the ball kept off the ends and the duty off its limits.
fn is_safe(flown: &Flown, model: &Model, desk: &Desk, settled_s: f64) -> bool {
    let (bottom, top) = model.ends_mm();
    let margin = AT_END * (top - bottom);
    let (lowest, highest) = (desk.safety.duty_min_percent, desk.safety.duty_max_percent);
    let later: Vec<_> = flown.cycles.iter().filter(|cycle| cycle.time_s >= settled_s).collect();
    let inside = |mm: f64| mm > bottom + margin && mm < top - margin;
    let at_limit = later.iter().filter(|cycle| {
        cycle.commanded_duty_percent <= lowest + 1e-9 || cycle.commanded_duty_percent >= highest - 1e-9
    });
    flown.fault.is_none()
        && !later.is_empty()
        && later.iter().all(|cycle| cycle.position_mm.is_some_and(inside))
        && at_limit.count() as f64 <= AT_LIMIT * later.len() as f64
}

impl Records {
    /// The `pairs` that the experiment separates, and the nats a minute of the least separated of them (of all, where
    /// none is separated). `moved`: after each rival's parameters have been fitted to the record.
    pub(super) fn rank(&self, rivals: &[Rival], pairs: &[(usize, usize)], moved: bool) -> (Vec<Pair>, f64) {
        let score = |&(a, b): &(usize, usize)| {
            let there = nats_per_minute(&self.0[a], &rivals[a], &rivals[b], moved);
            let back = nats_per_minute(&self.0[b], &rivals[b], &rivals[a], moved);
            ((rivals[a].0, rivals[b].0), there.min(back))
        };
        let pairs: Vec<(Pair, f64)> = pairs.iter().map(score).collect();
        let separated: Vec<(Pair, f64)> = pairs.iter().filter(|(_, nats)| *nats >= SEPARATES).copied().collect();
        let counted = if separated.is_empty() { &pairs } else { &separated };
        let least = counted.iter().map(|(_, nats)| *nats).fold(f64::INFINITY, f64::min);
        (separated.into_iter().map(|(pair, _)| pair).collect(), least)
    }
}

/// Log-likelihood of `truth` minus that of `other` on the record of `truth`, nats per minute of free flight.
fn nats_per_minute(record: &Recording, truth: &Rival, other: &Rival, moved: bool) -> f64 {
    let refit = moved.then_some(STEPS);
    let likelihood = |rival: &Rival| log_likelihood(&rival.1, record, &truth.1, refit);
    let counts = in_free_flight(&truth.1, record);
    let rows = counts.iter().filter(|counts| **counts).count() as f64;
    let minutes = record.duration_s() / 60.0 * rows / counts.len().max(1) as f64;
    if minutes > 0.0 { (likelihood(truth) - likelihood(other)) / minutes } else { 0.0 }
}
