//! Screening of an effect: its initial values are rated as they are, then a few scoring steps are made from the best
//! ones. More steps follow while the gradient is steep.

use crate::fit::derivatives::{KnownSensitivities, NONE_KNOWN};
use crate::fit::estimate::Fit;
use crate::fit::held_out::LogLikByFold;
use crate::fit::parameter::{Parameter, parameters_of_effect, prior};
use crate::select::initial_values::{Starts, starts};
use crate::select::regression::regressed;
use crate::select::search::Search;
use crate::select::stepwise::is_of_path;
use crate::thresholds::{BEHIND, BEHIND_SHARE, SCREENED};
use plant::{Entry, Model, Noise, Start, is_beyond_the_noise};
use rayon::prelude::*;
use std::{iter, ptr};

/// Smallest number of scoring steps, number of initial values, and how far behind the best these may be, nats.
pub(crate) const STEPS: usize = 2;
const STARTS: usize = 2;
const AS_GOOD: f64 = 10.0;
/// Gain by chance of each parameter of an effect beyond the first, nats.
pub(crate) const COST_OF_A_NUMBER: f64 = 1.5;
/// A screening whose gain stays so far below 0, nats, is stuck. It is repeated with these shares of its initial values.
const STUCK: f64 = 10.0;
const NEARER: [f64; 5] = [0.3, 0.1, 0.03, 0.01, 0.003];
/// Parameters that the screening fits besides those of the effect.
pub(crate) fn first(search: &Search<'_>) -> [Parameter; 4] {
    let noise = if search.is_by_forecasts() { Parameter::NoiseLevel } else { Parameter::AirNoise };
    [Parameter::Gain, Parameter::Drag, Parameter::Hover, noise]
}

/// Initial values of the fit of an effect, and their log-likelihood by fold.
struct InitialPoint {
    /// Index of the initial base parameters, see [`places_to_start`].
    place: usize,
    /// Whether these values follow from the belief.
    as_believed: bool,
    /// Whether a scan over the record found these values.
    scanned: bool,
    model: Model,
    parameters: Vec<Parameter>,
    by_fold: LogLikByFold,
}

/// The result of the screening of an effect.
#[derive(Clone)]
pub(crate) struct Screened {
    pub(crate) entry: &'static Entry,
    pub(crate) model: Model,
    pub(crate) parameters: Vec<Parameter>,
    /// Gain of log-likelihood and log-prior so far, nats.
    pub(crate) gain: f64,
    /// Gain by chance from the choice among initial values and parameters, nats.
    pub(crate) cost: f64,
    /// Log-likelihood by fold at each of the initial values, the best first, if each is a separate local maximum.
    pub(crate) rivals: Vec<LogLikByFold>,
}

impl Screened {
    /// The log-likelihood of `fold` at the initial values that the other folds prefer; `None` if all folds prefer the
    /// same.
    pub(crate) fn chosen_without(&self, fold: usize) -> Option<f64> {
        let rest = |worth: &LogLikByFold| worth.iter().sum::<f64>() - worth[fold];
        let other = self.rivals.iter().enumerate().max_by(|a, b| rest(a.1).total_cmp(&rest(b.1)))?;
        (other.0 != 0).then_some(other.1[fold])
    }
}

/// The gain that a screened effect needs to be fitted in full, nats; `screened`: the best first.
pub(crate) fn promising_gain(screened: &[Screened]) -> f64 {
    let best = screened.first().map_or(0.0, |best| best.gain);
    SCREENED.max(best * (1.0 - BEHIND_SHARE) - BEHIND)
}

/// A model with an effect added at these values, and its fitted parameters. An effect that contains a simpler one
/// replaces it. `None`: the model has the effect, or cannot have it at these values.
pub(crate) fn added(
    model: &Model,
    parameters: &[Parameter],
    entry: &'static Entry,
    values: &[f64],
) -> Option<(Model, Vec<Parameter>)> {
    let mut model = model.clone();
    if model.effects.values(entry.name).is_some() {
        return None;
    }
    let removed = entry.contains.filter(|part| model.effects.remove(part));
    model.effects.set(entry.name, values);
    model.effects.check().ok()?;
    let kept = parameters.iter().filter(|parameter| !removed.is_some_and(|part| parameter.is_of(part)));
    Some((model, kept.copied().chain(parameters_of_effect(entry, values)).collect()))
}

/// Screens an effect; `known`: the derivatives by [`first`] at the fit so far. With little noise, initial values far
/// above the true ones lie thousands of nats below a gain of 0, and no step leads to the maximum. Then smaller initial
/// values are tried.
pub(crate) fn screen(
    search: &Search<'_>,
    so_far: &Fit,
    known: &KnownSensitivities,
    entry: &'static Entry,
) -> Option<Screened> {
    let usual = starts(entry, so_far, search);
    let look = screen_from(search, (so_far, known), entry, &usual)?;
    if look.gain >= -STUCK {
        return Some(look);
    }
    let Some(nearer) = usual.nearer(entry, &so_far.model, &NEARER) else { return Some(look) };
    let small = screen_from(search, (so_far, known), entry, &nearer);
    small.filter(|small| small.gain > look.gain).or(Some(look))
}

/// A few scoring steps of the most important parameters from the best of these initial values; the best result.
fn screen_from(
    search: &Search<'_>,
    (so_far, known): (&Fit, &KnownSensitivities),
    entry: &'static Entry,
    all: &Starts,
) -> Option<Screened> {
    let rated = rated(search, so_far, entry, all);
    let worth = |start: &InitialPoint| start.by_fold.iter().sum::<f64>();
    // A recorded fan speed determines the timing sharply: the maxima are narrow, and the rating cannot tell which is
    // near.
    let narrow = search.problem.recording.has_fan_speed();
    let mut from: Vec<&InitialPoint> = Vec::new();
    // What a scan found rates higher than usual values, but may end lower: its sizes are fitted already.
    for scanned in [false, true] {
        let mut own = rated.iter().filter(|start| start.scanned == scanned).take(STARTS).peekable();
        let best = own.peek().map_or(0.0, |best| worth(best));
        from.extend(own.filter(|start| narrow || worth(start) > best - AS_GOOD));
    }
    // The best of other base parameters, and the values that follow from the belief there, rate lower but may end
    // higher.
    let elsewhere = |start: &&InitialPoint| rated.first().is_some_and(|best| best.place != start.place);
    let as_believed = |start: &&InitialPoint| start.place > 0 && start.as_believed;
    for other in [rated.iter().find(elsewhere), rated.iter().find(as_believed)].into_iter().flatten() {
        if !from.iter().any(|start| ptr::eq(*start, other)) {
            from.push(other);
        }
    }
    let screened = from.into_iter().map(|InitialPoint { place, model: start, parameters, .. }| {
        let own = parameters.iter().filter(|parameter| !so_far.parameters.contains(parameter));
        let few: Vec<Parameter> = first(search).into_iter().chain(own.copied()).collect();
        // The derivatives at the fit do not hold at other base parameters.
        let known = if *place == 0 { known } else { &NONE_KNOWN };
        let (model, total) = search.problem.fit_briefly_with(known, start, &few, STEPS);
        let of = |parameters: &[Parameter]| prior(parameters, &model, search.problem.belief);
        let gain = total - of(&few) + of(parameters);
        (place, Screened { entry, model, parameters: parameters.clone(), gain, cost: 0.0, rivals: Vec::new() })
    });
    let (place, best) = screened.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
    let before = search.problem.total_of(so_far);
    // With other base parameters the same values lead to the same maximum, so that is no additional choice.
    let of_place = rated.iter().filter(|start| start.place == *place && all.are_tops);
    let rivals: Vec<LogLikByFold> = of_place.map(|start| start.by_fold).collect();
    let cost = COST_OF_A_NUMBER * best.parameters.len().saturating_sub(so_far.parameters.len() + 1) as f64
        + (all.among.max(1) as f64).ln();
    Some(Screened { gain: best.gain - before, rivals, cost, ..best })
}

/// The initial values of the effect, rated by log-likelihood, the best first.
fn rated(search: &Search<'_>, so_far: &Fit, entry: &'static Entry, all: &Starts) -> Vec<InitialPoint> {
    let rated = all.values.par_iter().enumerate().flat_map_iter(|(at, values)| {
        let (scanned, as_believed) =
            ((all.usual..all.usual + all.scanned).contains(&at), at >= all.usual + all.scanned);
        let start = added(&so_far.model, &so_far.parameters, entry, values);
        let models =
            start.iter().flat_map(|(model, _)| places_to_start(search, so_far, model, entry)).collect::<Vec<_>>();
        let parameters = start.map(|(_, parameters)| parameters).unwrap_or_default();
        models.into_iter().enumerate().map(move |(place, model)| {
            let by_fold = search.problem.by_fold(&model);
            InitialPoint { place, as_believed, scanned, model, parameters: parameters.clone(), by_fold }
        })
    });
    let mut rated: Vec<InitialPoint> = rated.collect();
    rated.sort_by(|a, b| b.by_fold.iter().sum::<f64>().total_cmp(&a.by_fold.iter().sum()));
    rated
}

/// Initial base parameters: those of the model, and those of the belief if the fit is far from it. A fit that followed
/// the record without the effect may be a bad start. For an effect that distorts the noise both have the believed
/// noise; and the model also with the noise of the air that was fitted, since a filter with the believed one loses the
/// ball where a force is missing, and with the larger noise of the readings, since they may be noisier than believed.
fn places_to_start(search: &Search<'_>, so_far: &Fit, model: &Model, effect: &Entry) -> Vec<Model> {
    let belief = search.problem.belief;
    if !is_of_path(effect) {
        let quiet = Model { noise: belief.noise, ..model.clone() };
        let believed = Model { effects: model.effects.clone(), ..belief.clone() };
        let noise = Noise { sensor_mm: model.noise.sensor_mm.max(belief.noise.sensor_mm), ..model.noise };
        let fitted = (!is_within_noise(effect, model, belief)).then(|| Model { noise, ..model.clone() });
        return [quiet, believed].into_iter().chain(fitted).collect();
    }
    let mut believed = search.with_believed_base(model);
    for entry in model.effects.present().iter().filter(|entry| entry.name != effect.name) {
        if let Some(values) = belief.effects.values(entry.name) {
            believed.effects.set(entry.name, &values);
        }
    }
    let places = iter::once(model.clone()).chain(search.is_far(so_far).then_some(believed));
    let is_pendulum = effect.start == Start::DutyOverHeight && model.turn_mm.is_some();
    if is_pendulum || matches!(effect.start, Start::AgainstMotion(_)) {
        let own = model.effects.values(effect.name).unwrap_or_default();
        // A regression finds the simple form.
        let is_own = |found: &Model| found.effects.values(effect.name).is_some_and(|values| own.starts_with(&values));
        let with_own = |mut found: Model| {
            found.effects.set(effect.name, &own);
            found
        };
        let found = regressed(effect, model, belief, search.problem.recording).into_iter();
        return places.chain(found.filter(is_own).map(with_own)).collect();
    }
    if effect.start == Start::DutyOverHeight {
        return places.map(|model| balanced_where_it_flew(search, model)).collect();
    }
    places.collect()
}

/// Whether steps this small lie within the noise of the readings, so that a filter with the believed noise follows
/// them: the largest error of a step is half of it.
fn is_within_noise(effect: &Entry, model: &Model, belief: &Model) -> bool {
    let steps_mm = model.effects.values(effect.name).filter(|_| effect.start == Start::ReadingStep);
    steps_mm.is_some_and(|mm| !mm.iter().any(|mm| is_beyond_the_noise(mm / 2.0, belief.noise.sensor_mm)))
}

/// The model, after a lift that depends on height was added, with the hover duty that balances it at the mean height.
fn balanced_where_it_flew(search: &Search<'_>, model: Model) -> Model {
    let heights = search.problem.recording.samples().iter().filter_map(|sample| sample.position_mm);
    let (sum_mm, count) = heights.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
    let lift = model.force_at_rest(sum_mm / f64::max(count, 1.0));
    Model { hover_duty_percent: model.hover_duty_percent + lift / model.gain_mm_per_s2_per_percent, ..model }
}

#[cfg(test)]
mod tests;
