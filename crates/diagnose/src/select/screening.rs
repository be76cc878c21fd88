//! A first look at an effect: its starts are rated as they are, and a few steps of few numbers are made from the best, more while the slope is steep.

use crate::fit::estimate::{Fit, LogLikByFold};
use crate::fit::parameter::{Parameter, parameters_of_effect, prior};
use crate::select::initial_values::{Starts, starts};
use crate::select::search::Search;
use plant::{Changes, Entry, Model, Start as StartRule};
use rayon::prelude::*;
use std::{iter, ptr};

/// Scoring steps at least, from how many starts, and how far behind the best of them a start may be, nats.
const STEPS: usize = 2;
const STARTS: usize = 2;
const AS_GOOD: f64 = 10.0;
/// What each number of an effect beyond the first may gain by chance, nats.
const COST_OF_A_NUMBER: f64 = 1.5;
/// A look that ends so much below nothing, nats, is stuck. It is made again from these shares of its starts.
const STUCK: f64 = 10.0;
const NEARER: [f64; 5] = [0.3, 0.1, 0.03, 0.01, 0.003];
/// What moves at a first look beside the effect's own numbers.
const FIRST: [Parameter; 4] = [Parameter::Gain, Parameter::Drag, Parameter::Hover, Parameter::AirNoise];

/// A start of the search for an effect, and what each fold is worth there.
struct Start {
    /// Which of the places to start from it is.
    place: usize,
    /// Whether the belief asks for these values.
    as_believed: bool,
    model: Model,
    parameters: Vec<Parameter>,
    by_fold: LogLikByFold,
}

/// A first look at an effect.
pub(crate) struct Screened {
    pub(crate) entry: Entry,
    pub(crate) model: Model,
    pub(crate) parameters: Vec<Parameter>,
    /// Likelihood and prior gained so far, nats.
    pub(crate) gain: f64,
    /// What the choice among starts and numbers is worth by chance, nats.
    pub(crate) cost: f64,
    /// What each fold is worth at each start, the best first, where each is a top of its own.
    rivals: Vec<LogLikByFold>,
}

impl Screened {
    /// Of the starts, the one that the other folds would have chosen, where it is not the one that all choose: what it is worth on this fold.
    pub(crate) fn chosen_without(&self, fold: usize) -> Option<f64> {
        let rest = |worth: &LogLikByFold| worth.iter().sum::<f64>() - worth[fold];
        let other = self.rivals.iter().enumerate().max_by(|a, b| rest(a.1).total_cmp(&rest(b.1)))?;
        (other.0 != 0).then_some(other.1[fold])
    }
}

/// `fit` with an effect added at these values: the model and what may move. An effect that contains a simpler one takes its place.
fn added(fit: &Fit, entry: &Entry, values: &[f64]) -> Option<(Model, Vec<Parameter>)> {
    let mut model = fit.model.clone();
    if model.effects.values(entry.name).is_some() {
        return None;
    }
    let removed = entry.contains.filter(|part| model.effects.remove(part));
    model.effects.set(entry.name, values);
    model.effects.check().ok()?;
    let kept = fit.parameters.iter().filter(|parameter| !removed.is_some_and(|part| parameter.is_of(part)));
    Some((model, kept.copied().chain(parameters_of_effect(entry.name, values)).collect()))
}

/// A first look at an effect. Where readings have little noise, a start far larger than the effect is thousands of nats below nothing, and no
/// step leads back: then it is looked for again from smaller ones.
pub(crate) fn screen(search: &Search<'_>, so_far: &Fit, entry: &Entry) -> Option<Screened> {
    let usual = starts(entry, so_far, search);
    let look = screen_from(search, so_far, entry, &usual)?;
    if look.gain >= -STUCK {
        return Some(look);
    }
    let Some(nearer) = usual.nearer(entry, &so_far.model, &NEARER) else { return Some(look) };
    let small = screen_from(search, so_far, entry, &nearer);
    small.filter(|small| small.gain > look.gain).or(Some(look))
}

/// A few steps of the numbers that matter most from the best of these starts; the best of them.
fn screen_from(search: &Search<'_>, so_far: &Fit, entry: &Entry, all: &Starts) -> Option<Screened> {
    let rated = rated(search, so_far, entry, all);
    let worth = |start: &Start| start.by_fold.iter().sum::<f64>();
    // A recorded speed of the fan shows the timing to a hair: its valleys are narrow, and nothing says at first sight which is near.
    let narrow = search.problem.recording.has_fan_speed();
    let as_good = |start: &&Start| narrow || worth(start) > rated.first().map_or(0.0, worth) - AS_GOOD;
    let mut from: Vec<&Start> = rated.iter().take(STARTS).filter(as_good).collect();
    // The best from another place, and what the belief asks for there, are no better at first sight, but may maximise higher.
    let elsewhere = |start: &&Start| rated.first().is_some_and(|best| best.place != start.place);
    let as_believed = |start: &&Start| start.place > 0 && start.as_believed;
    for other in [rated.iter().find(elsewhere), rated.iter().find(as_believed)].into_iter().flatten() {
        if !from.iter().any(|start| ptr::eq(*start, other)) {
            from.push(other);
        }
    }
    let screened = from.into_iter().map(|Start { place, model: start, parameters, .. }| {
        let own = parameters.iter().filter(|parameter| !so_far.parameters.contains(parameter));
        let few: Vec<Parameter> = FIRST.into_iter().chain(own.copied()).collect();
        let (model, total) = search.problem.fit_briefly(start, &few, STEPS);
        let of = |parameters: &[Parameter]| prior(parameters, &model, search.problem.belief);
        let gain = total - of(&few) + of(parameters);
        (place, Screened { entry: *entry, model, parameters: parameters.clone(), gain, cost: 0.0, rivals: Vec::new() })
    });
    let (place, best) = screened.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
    let before = search.problem.total_of(so_far);
    // From another place the same values lead to the same top: that is no choice.
    let of_place = rated.iter().filter(|start| start.place == *place && all.are_tops);
    let rivals: Vec<LogLikByFold> = of_place.map(|start| start.by_fold).collect();
    let cost = COST_OF_A_NUMBER * best.parameters.len().saturating_sub(so_far.parameters.len() + 1) as f64
        + (all.among.max(1) as f64).ln();
    Some(Screened { gain: best.gain - before, rivals, cost, ..best })
}

/// These starts of the effect, the one that explains most as it is first.
fn rated(search: &Search<'_>, so_far: &Fit, entry: &Entry, all: &Starts) -> Vec<Start> {
    let rated = all.values.par_iter().enumerate().flat_map_iter(|(at, values)| {
        let as_believed = at >= all.usual;
        let start = added(so_far, entry, values);
        let models =
            start.iter().flat_map(|(model, _)| places_to_start(search, so_far, model, entry)).collect::<Vec<_>>();
        let parameters = start.map(|(_, parameters)| parameters).unwrap_or_default();
        models.into_iter().enumerate().map(move |(place, model)| {
            let by_fold = search.problem.by_fold(&model);
            Start { place, as_believed, model, parameters: parameters.clone(), by_fold }
        })
    });
    let mut rated: Vec<Start> = rated.collect();
    rated.sort_by(|a, b| b.by_fold.iter().sum::<f64>().total_cmp(&a.by_fold.iter().sum()));
    rated
}

/// The model as it is, and with all that is believed where that is far: what the numbers had to become to follow the record without the
/// effect is no place to start from. For an effect that distorts the noise, both with the noise that is believed.
fn places_to_start(search: &Search<'_>, so_far: &Fit, model: &Model, effect: &Entry) -> Vec<Model> {
    let belief = search.problem.belief;
    if effect.acts.changes != Changes::Path {
        let quiet = Model { noise: belief.noise, ..model.clone() };
        return vec![quiet, Model { effects: model.effects.clone(), ..belief.clone() }];
    }
    let mut believed = Model { noise: model.noise, effects: model.effects.clone(), ..belief.clone() };
    for entry in model.effects.present().iter().filter(|entry| entry.name != effect.name) {
        if let Some(values) = belief.effects.values(entry.name) {
            believed.effects.set(entry.name, &values);
        }
    }
    let places = iter::once(model.clone()).chain(search.is_far(so_far).then_some(believed));
    if effect.start == StartRule::DutyOverHeight {
        return places.map(|model| balanced_where_it_flew(search, model)).collect();
    }
    places.collect()
}

/// The model, to which a lift that changes with height was added, with the hover duty that still balances it at the mean height of the record.
fn balanced_where_it_flew(search: &Search<'_>, model: Model) -> Model {
    let heights = search.problem.recording.samples().iter().filter_map(|sample| sample.position_mm);
    let (sum_mm, count) = heights.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
    let lift = model.force_at_rest(sum_mm / f64::max(count, 1.0));
    Model { hover_duty_percent: model.hover_duty_percent + lift / model.gain_mm_per_s2_per_percent, ..model }
}

#[cfg(test)]
mod tests;
