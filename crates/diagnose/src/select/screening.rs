//! A first look at an effect: its starts are rated as they are, and a few steps of few numbers are made from the best, more while the slope is steep.

use crate::fit::estimate::{Fit, Worth};
use crate::fit::parameter::{Free, free_of_effect, prior};
use crate::select::candidates::{CONTAINS, Search};
use crate::select::initial_values::{Starts, starts};
use plant::{Entry, Model};
use rayon::prelude::*;
use std::{iter, ptr};

/// Scoring steps at least, from how many starts, and how far behind the best of them a start may be, nats.
const STEPS: usize = 2;
const STARTS: usize = 2;
const AS_GOOD: f64 = 10.0;
/// The fit so far is far from the belief where what it moved of it costs more than this, nats.
const FAR: f64 = 3.0;
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
    /// Whether the belief asks for these values.
    as_believed: bool,
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
    /// What each fold is worth at each start, the best first, where each is a top of its own.
    rivals: Vec<Worth>,
}

impl Look {
    /// Of the starts, the one that the other folds would have chosen, where it is not the one that all choose: what it is worth on this fold.
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
        let usual = starts(entry, so_far, self);
        let look = self.look_from(so_far, entry, &usual)?;
        if look.gain >= -STUCK {
            return Some(look);
        }
        let Some(nearer) = usual.nearer(entry, &so_far.model, &NEARER) else { return Some(look) };
        let small = self.look_from(so_far, entry, &nearer);
        small.filter(|small| small.gain > look.gain).or(Some(look))
    }

    /// A few steps of the numbers that matter most from the best of these starts; the best of them.
    fn look_from(&self, so_far: &Fit, entry: &Entry, all: &Starts) -> Option<Look> {
        let rated = self.rated(so_far, entry, all);
        let worth = |start: &Start| start.by_fold.iter().sum::<f64>();
        // A recorded speed of the fan shows the timing to a hair: its valleys are narrow, and nothing says at first sight which is near.
        let narrow = self.problem.recording.has_fan_speed();
        let as_good = |start: &&Start| narrow || worth(start) > rated.first().map_or(0.0, worth) - AS_GOOD;
        let mut from: Vec<&Start> = rated.iter().take(STARTS).filter(as_good).collect();
        // The best from another place, and what the belief asks for there, are no better at first sight, but may climb higher.
        let elsewhere = |start: &&Start| rated.first().is_some_and(|best| best.place != start.place);
        let as_believed = |start: &&Start| start.place > 0 && start.as_believed;
        for other in [rated.iter().find(elsewhere), rated.iter().find(as_believed)].into_iter().flatten() {
            if !from.iter().any(|start| ptr::eq(*start, other)) {
                from.push(other);
            }
        }
        let looks = from.into_iter().map(|Start { place, model: start, free, .. }| {
            let own = free.iter().filter(|free| !so_far.free.contains(free));
            let few: Vec<Free> = FIRST.into_iter().chain(own.copied()).collect();
            let (model, total) = self.problem.look(start, &few, STEPS);
            let of = |free: &[Free]| prior(free, &model, self.problem.belief);
            let gain = total - of(&few) + of(free);
            (place, Look { entry: *entry, model, free: free.clone(), gain, cost: 0.0, rivals: Vec::new() })
        });
        let (place, best) = looks.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
        let before = self.problem.total_of(so_far);
        // From another place the same values lead to the same top: that is no choice.
        let of_place = rated.iter().filter(|start| start.place == *place && all.are_tops);
        let rivals: Vec<Worth> = of_place.map(|start| start.by_fold).collect();
        let cost = COST_OF_A_NUMBER * best.free.len().saturating_sub(so_far.free.len() + 1) as f64
            + (all.among.max(1) as f64).ln();
        Some(Look { gain: best.gain - before, rivals, cost, ..best })
    }

    /// These starts of the effect, the one that explains most as it is first.
    fn rated(&self, so_far: &Fit, entry: &Entry, all: &Starts) -> Vec<Start> {
        let rated = all.values.par_iter().enumerate().flat_map_iter(|(at, values)| {
            let as_believed = at >= all.usual;
            let start = added(so_far, entry, values);
            let models =
                start.iter().flat_map(|(model, _)| self.places_to_start(so_far, model, entry.name)).collect::<Vec<_>>();
            let free = start.map(|(_, free)| free).unwrap_or_default();
            models.into_iter().enumerate().map(move |(place, model)| {
                let by_fold = self.problem.by_fold(&model);
                Start { place, as_believed, model, free: free.clone(), by_fold }
            })
        });
        let mut rated: Vec<Start> = rated.collect();
        rated.sort_by(|a, b| b.by_fold.iter().sum::<f64>().total_cmp(&a.by_fold.iter().sum()));
        rated
    }

    /// Whether the fit so far has moved what is believed further than an owner is usually wrong.
    pub(crate) fn is_far(&self, so_far: &Fit) -> bool {
        let noise = [Free::SensorNoise, Free::AirNoise];
        let moved: Vec<Free> = so_far.free.iter().filter(|free| !noise.contains(free)).copied().collect();
        prior(&moved, &so_far.model, self.problem.belief) < -FAR
    }

    /// The model as it is, and with all that is believed where that is far: what the numbers had to become to follow the record without the
    /// effect is no place to start from. For an effect that distorts the noise, both with the noise that is believed.
    fn places_to_start(&self, so_far: &Fit, model: &Model, name: &str) -> Vec<Model> {
        let belief = self.problem.belief;
        if DISTORT.contains(&name) {
            let quiet = Model { noise: belief.noise, ..model.clone() };
            return vec![quiet, Model { effects: model.effects.clone(), ..belief.clone() }];
        }
        let mut believed = Model { noise: model.noise, effects: model.effects.clone(), ..belief.clone() };
        for entry in model.effects.present().iter().filter(|entry| entry.name != name) {
            if let Some(values) = belief.effects.values(entry.name) {
                believed.effects.set(entry.name, &values);
            }
        }
        let places = iter::once(model.clone()).chain(self.is_far(so_far).then_some(believed));
        if name == "height_dependent_flow" {
            return places.map(|model| self.balanced_where_it_flew(model)).collect();
        }
        places.collect()
    }

    /// The model, to which a lift that changes with height was added, with the hover duty that still balances it at the mean height of the record.
    fn balanced_where_it_flew(&self, model: Model) -> Model {
        let Some(flow) = model.effects.height_dependent_flow else { return model };
        let heights = self.problem.recording.samples().iter().filter_map(|sample| sample.position_mm);
        let (sum_mm, count) = heights.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
        let lift = flow.lift(sum_mm / f64::max(count, 1.0), model.pipe_length_mm);
        Model { hover_duty_percent: model.hover_duty_percent + lift / model.gain_mm_per_s2_per_percent, ..model }
    }
}

#[cfg(test)]
mod tests;
