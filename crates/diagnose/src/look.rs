//! A first look at an effect: its starts are rated as they are, and a few steps of few numbers are made from the best, more while the slope is steep.

use crate::fit::{Fit, Worth};
use crate::free::{Free, free_of_effect, prior};
use crate::starts::{Starts, balancing, starts};
use crate::which::{CONTAINS, Search};
use plant::{Entry, Model};
use rayon::prelude::*;

/// Scoring steps at least, from how many starts, and how far behind the best of them a start may be, nats.
const STEPS: usize = 2;
const STARTS: usize = 2;
const AS_GOOD: f64 = 10.0;
/// A gain or a drag is far where the fit has moved it by more than this, ln of the ratio.
const FAR: f64 = 1.0;
/// With more starts than this the choice among them is part of what is scored.
const MANY_STARTS: usize = 4;
/// What each number of an effect beyond the first may gain by chance, nats.
const COST_OF_A_NUMBER: f64 = 1.5;
/// A look that ends so much below nothing, nats, is stuck. It is made again from these shares of its starts.
const STUCK: f64 = 10.0;
const NEARER: [f64; 5] = [0.3, 0.1, 0.03, 0.01, 0.003];
/// What moves at a first look beside the effect's own numbers.
const FIRST: [Free; 4] = [Free::Gain, Free::Drag, Free::Hover, Free::AirNoise];
/// Effects without which the noise, or all numbers, must be far from the belief to follow the record.
pub(crate) const DISTORT: [&str; 5] =
    ["turbulence", "sensor_noise", "sensor_outliers", "sensor_quantisation", "stale_samples"];

/// A start of the search for an effect, and what each fold is worth there.
struct Start {
    /// Which of the places to start from it is.
    place: usize,
    model: Model,
    free: Vec<Free>,
    by_fold: Worth,
}

/// A first look at an effect.
pub(crate) struct Look {
    pub(crate) entry: Entry,
    pub(crate) model: Model,
    pub(crate) free: Vec<Free>,
    /// Likelihood and prior gained so far, nats.
    pub(crate) gain: f64,
    /// What the choice among starts and numbers is worth by chance, nats.
    pub(crate) cost: f64,
    /// What each fold is worth at each start, the best first, where there were many.
    rivals: Vec<Worth>,
}

impl Look {
    /// Of many starts, the one that the other folds would have chosen, where it is not the one that all choose: what it is worth on this fold.
    pub(crate) fn chosen_without(&self, fold: usize) -> Option<f64> {
        let rest = |worth: &Worth| worth.iter().sum::<f64>() - worth[fold];
        let other = self.rivals.iter().enumerate().max_by(|a, b| rest(a.1).total_cmp(&rest(b.1)))?;
        (other.0 != 0).then_some(other.1[fold])
    }
}

/// `fit` with an effect added at these values: the model and what may move. An effect that contains a simpler one takes its place.
fn added(fit: &Fit, entry: &Entry, values: &[f64]) -> Option<(Model, Vec<Free>)> {
    let mut model = fit.model.clone();
    if model.effects.values(entry.name).is_some() {
        return None;
    }
    let contained = CONTAINS.iter().find(|(whole, _)| *whole == entry.name).map(|(_, part)| *part);
    let removed = contained.filter(|part| model.effects.remove(part));
    model.effects.set(entry.name, values);
    model.effects.check().ok()?;
    let kept = fit.free.iter().filter(|free| !removed.is_some_and(|part| free.is_of(part)));
    Some((model, kept.copied().chain(free_of_effect(entry.name, values)).collect()))
}

impl Search<'_> {
    /// A first look at an effect. Where readings have little noise, a start far larger than the effect is thousands of nats below nothing, and no
    /// step leads back: then it is looked for again from smaller ones.
    pub(crate) fn look(&self, so_far: &Fit, entry: &Entry) -> Option<Look> {
        let usual = starts(entry, so_far, &self.problem);
        let look = self.look_from(so_far, entry, &usual)?;
        if look.gain >= -STUCK {
            return Some(look);
        }
        let Some(nearer) = usual.nearer(entry, &so_far.model, &NEARER) else { return Some(look) };
        // Sizes of one effect share a valley: the choice among them is none that other folds would make otherwise.
        let small = self.look_from(so_far, entry, &nearer).map(|small| Look { rivals: Vec::new(), ..small });
        small.filter(|small| small.gain > look.gain).or(Some(look))
    }

    /// A few steps of the numbers that matter most from the best of these starts; the best of them.
    fn look_from(&self, so_far: &Fit, entry: &Entry, all: &Starts) -> Option<Look> {
        let (rated, among) = self.rated(so_far, entry, all);
        let worth = |start: &Start| start.by_fold.iter().sum::<f64>();
        // A recorded speed of the fan shows the timing to a hair: its valleys are narrow, and nothing says at first sight which is near.
        let narrow = self.problem.recording.has_fan_speed();
        let as_good = |start: &&Start| narrow || worth(start) > rated.first().map_or(0.0, worth) - AS_GOOD;
        // The best from another place is no better at first sight, but may climb higher.
        let elsewhere = |start: &Start| rated.first().is_some_and(|best| best.place != start.place);
        let other = rated.iter().enumerate().find(|(_, start)| elsewhere(start));
        let other = other.filter(|(at, start)| *at >= STARTS || !as_good(start)).map(|(_, start)| start);
        let balanced = self.balanced_start(so_far, entry);
        let from = rated.iter().take(STARTS).filter(as_good).chain(other).map(|start| (&start.model, &start.free));
        let looks = from.chain(balanced.iter().map(|(model, free)| (model, free))).map(|(start, free)| {
            let own = free.iter().filter(|free| !so_far.free.contains(free));
            let few: Vec<Free> = FIRST.into_iter().chain(own.copied()).collect();
            let (model, total) = self.problem.look(start, &few, STEPS);
            let of = |free: &[Free]| prior(free, &model, self.problem.belief);
            let gain = total - of(&few) + of(free);
            Look { entry: *entry, model, free: free.clone(), gain, cost: 0.0, rivals: Vec::new() }
        });
        let best = looks.max_by(|a, b| a.gain.total_cmp(&b.gain))?;
        let before = self.problem.total_of(so_far);
        let rivals =
            if rated.len() > MANY_STARTS { rated.iter().map(|start| start.by_fold).collect() } else { Vec::new() };
        let cost = COST_OF_A_NUMBER * best.free.len().saturating_sub(so_far.free.len() + 1) as f64
            + (rated.len().max(among) as f64).ln();
        Some(Look { gain: best.gain - before, rivals, cost, ..best })
    }

    /// These starts of the effect, the one that explains most as it is first, and among how many they were chosen.
    fn rated(&self, so_far: &Fit, entry: &Entry, all: &Starts) -> (Vec<Start>, usize) {
        let rated = all.values.par_iter().flat_map_iter(|values| {
            let start = added(so_far, entry, values);
            let models =
                start.iter().flat_map(|(model, _)| self.places_to_start(model, entry.name)).collect::<Vec<_>>();
            let free = start.map(|(_, free)| free).unwrap_or_default();
            models.into_iter().enumerate().map(move |(place, model)| {
                let by_fold = self.problem.by_fold(&model);
                Start { place, model, free: free.clone(), by_fold }
            })
        });
        let mut rated: Vec<Start> = rated.collect();
        rated.sort_by(|a, b| b.by_fold.iter().sum::<f64>().total_cmp(&a.by_fold.iter().sum()));
        (rated, all.among)
    }

    /// The effect as it would balance the duty at the believed gain, drag and hover, where the fit so far has gone far from those: what they
    /// became to follow the record without the effect is no place to start from. All else is as it was fitted so far.
    fn balanced_start(&self, so_far: &Fit, entry: &Entry) -> Option<(Model, Vec<Free>)> {
        let belief = self.problem.belief;
        let is_far = |free: Free| free.distance(&so_far.model, belief).abs() > FAR;
        let values = balancing(entry, &self.problem).filter(|_| is_far(Free::Gain) || is_far(Free::Drag))?;
        let (model, free) = added(so_far, entry, &values)?;
        Some((Model { noise: model.noise, effects: model.effects, ..belief.clone() }, free))
    }

    /// The model as it is; or, for an effect that distorts what is fitted without it, with the noise that is believed, and with all
    /// that is believed: what the other numbers had to become is no place to start from.
    fn places_to_start(&self, model: &Model, name: &str) -> Vec<Model> {
        if !DISTORT.contains(&name) {
            return vec![model.clone()];
        }
        let belief = self.problem.belief;
        let quiet = Model { noise: belief.noise, ..model.clone() };
        vec![quiet, Model { effects: model.effects.clone(), ..belief.clone() }]
    }
}
