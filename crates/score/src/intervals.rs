//! Coverage of the 90 % intervals, their width compared with the bound, and the errors of the values.
//!
//! ```text
//! bound = 2 · 1.645 σ          σ: Cramér–Rao deviation, all other true parameters being free
//! error = |value − truth| / |truth|
//! ```
//!
//! - Gain, drag and hover are scored where the answered model has the effects of the true one: without a missing effect
//!   their true values have another meaning.
//! - Parameters of an effect are scored where an entry has its name, even if the rest of the answer is wrong.
//! - A parameter without an effect in the rig cannot be estimated: an end stop at an end of the pipe, any value of 0.
//! - An asymmetric dead zone is a symmetric one at another hover: the error of its edges is that of the width. Hover
//!   has no relative error here, because 0 % is no natural origin for it.
//! - A parameter whose interval has no ends is not identifiable: it is counted and not scored.

use crate::Case;
use crate::answer::Interval;
use crate::names::named;
use crate::outcome::{exact, no_alarm};
use crate::proportion::Proportion;
use crate::truth::{Kind, TrueEffect};
use plant::Effects;
use serde::Serialize;
use std::collections::BTreeMap;

/// Width of a 90 % interval in standard deviations.
const WIDTH_90: f64 = 3.29;
/// With a bound beyond this, the parameter is not identifiable from the record.
const UNDETERMINED: f64 = 1e9;

/// An estimated parameter.
#[derive(Clone, Debug)]
struct Estimate {
    /// `fan_lag.time_constant_s`, or a base parameter.
    parameter: String,
    truth: f64,
    interval: Interval,
    sigma: Option<f64>,
}

/// The accuracy of the estimated parameters.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Numbers {
    /// Gain, drag and hover.
    pub base: ParameterScore,
    /// Parameters of effects.
    pub effects: ParameterScore,
    /// Each parameter separately.
    pub parameters: BTreeMap<String, ParameterScore>,
}

/// The accuracy of one or several parameters.
#[derive(Clone, Debug, Serialize)]
pub struct ParameterScore {
    /// Intervals that contain the truth.
    pub covered: Proportion,
    /// Estimates without an interval.
    pub without_interval: usize,
    /// Median width; `None` where the parameters have different units.
    pub median_width: Option<f64>,
    /// Median of the bound.
    pub median_bound: Option<f64>,
    /// Median of width over bound.
    pub median_width_over_bound: Option<f64>,
    /// Median of the relative error.
    pub median_relative_error: Option<f64>,
}

impl Default for ParameterScore {
    fn default() -> Self {
        Self::of(&[], false)
    }
}

impl Numbers {
    /// Scores the parameters of all cases.
    pub(crate) fn of(cases: &[Case]) -> Self {
        let base: Vec<Estimate> = cases.iter().flat_map(base_estimates).collect();
        let effects: Vec<Estimate> = cases.iter().flat_map(effect_estimates).collect();
        let mut each: BTreeMap<String, Vec<Estimate>> = BTreeMap::new();
        for estimate in base.iter().chain(&effects) {
            each.entry(estimate.parameter.clone()).or_default().push(estimate.clone());
        }
        let mut errors = ParameterScore::of(&effects, false);
        errors.median_relative_error = median(cases.iter().flat_map(effect_errors));
        Self {
            base: ParameterScore::of(&base, false),
            effects: errors,
            parameters: each.into_iter().map(|(name, own)| (name, ParameterScore::of(&own, true))).collect(),
        }
    }
}

impl ParameterScore {
    fn of(estimates: &[Estimate], one_unit: bool) -> Self {
        let ends = |e: &Estimate| e.interval.low.zip(e.interval.high);
        let covered = estimates.iter().filter_map(|e| ends(e).map(|(low, high)| (low..=high).contains(&e.truth)));
        let width = |e: &Estimate| ends(e).map(|(low, high)| high - low);
        let bound = |e: &Estimate| e.sigma.filter(|sigma| *sigma < UNDETERMINED).map(|sigma| WIDTH_90 * sigma);
        let ratio = |e: &Estimate| width(e).zip(bound(e)).map(|(width, bound)| width / bound);
        let relative = estimates.iter().filter(|e| e.parameter != "hover_duty_percent");
        Self {
            covered: Proportion::of(covered),
            without_interval: estimates.iter().filter(|e| ends(e).is_none()).count(),
            median_width: median(estimates.iter().filter_map(width).filter(|_| one_unit)),
            median_bound: median(estimates.iter().filter_map(bound).filter(|_| one_unit)),
            median_width_over_bound: median(estimates.iter().filter_map(ratio)),
            median_relative_error: median(relative.map(|e| relative_error(e.interval.value, e.truth))),
        }
    }
}

/// Gain, drag and hover of a case whose effects are right.
fn base_estimates(case: &Case) -> Vec<Estimate> {
    let Some(answer) = case.answer.as_ref().filter(|_| effects_are_right(case)) else { return Vec::new() };
    let estimate = |(key, truth): (&String, &f64)| {
        Some(Estimate {
            parameter: key.clone(),
            truth: *truth,
            interval: *answer.parameters.get(key)?,
            sigma: sigma(case, key),
        })
    };
    case.truth.base.iter().filter_map(estimate).collect()
}

/// Whether the answered model has the effects of the rig by their own names.
fn effects_are_right(case: &Case) -> bool {
    let Some(answer) = &case.answer else { return false };
    match case.truth.kind {
        Kind::None | Kind::Parameters => no_alarm(answer),
        Kind::Single | Kind::Pair => exact(case) && named_by_their_own(case),
        // With clutter no model is exact, and no bound of a number holds.
        Kind::Outside | Kind::Clutter | Kind::Amid | Kind::Several => false,
    }
}

fn named_by_their_own(case: &Case) -> bool {
    case.answer.as_ref().is_some_and(|answer| {
        let mut bare = answer.clone();
        bare.effects.iter_mut().for_each(|entry| entry.indistinguishable_from.clear());
        named(&bare, &case.truth.effects) == case.truth.effects.len()
    })
}

/// Each true effect with the values that were answered under its own name.
fn found(case: &Case) -> impl Iterator<Item = (&TrueEffect, &BTreeMap<String, Interval>)> {
    case.truth.effects.iter().filter_map(|effect| {
        let entry = case.answer.as_ref()?.effects.iter().find(|entry| entry.name == effect.name)?;
        Some((effect, &entry.parameters))
    })
}

fn effect_estimates(case: &Case) -> Vec<Estimate> {
    let of_effect = |(effect, values): (&TrueEffect, &BTreeMap<String, Interval>)| -> Vec<Estimate> {
        let acting = effect.parameters.iter().filter(|(key, truth)| acts(case, key, **truth));
        let estimate = |(key, truth): (&String, &f64)| {
            let parameter = format!("{}.{key}", effect.name);
            let sigma = sigma(case, &parameter);
            Some(Estimate { parameter, truth: *truth, interval: *values.get(key)?, sigma })
        };
        acting.filter_map(estimate).collect()
    };
    found(case).flat_map(of_effect).collect()
}

/// Relative errors of the parameters of the effects that were found. Of two parameters whose difference is known far
/// better than each, such as the edges of a dead zone, it is that of the difference.
fn effect_errors(case: &Case) -> Vec<f64> {
    let of_effect = |(effect, values): (&TrueEffect, &BTreeMap<String, Interval>)| -> Vec<f64> {
        let value = |key: &str| values.get(key).map(|interval| interval.value);
        let entry = Effects::built_in(&effect.name);
        if let Some((entry, difference)) = entry.and_then(|entry| Some((entry, entry.difference?))) {
            let [lower, upper] = difference.of.map(|index| entry.params[index].name);
            let truth = effect.parameters.get(upper).zip(effect.parameters.get(lower));
            let answered = value(upper).zip(value(lower));
            let error = answered.zip(truth).map(|(a, t)| relative_error(a.0 - a.1, t.0 - t.1));
            return error.into_iter().collect();
        }
        let acting = effect.parameters.iter().filter(|(key, truth)| acts(case, key, **truth));
        acting.filter_map(|(key, truth)| Some(relative_error(value(key)?, *truth))).collect()
    };
    found(case).flat_map(of_effect).collect()
}

/// Whether a parameter has an effect in this rig.
fn acts(case: &Case, key: &str, truth: f64) -> bool {
    truth != 0.0 && !(key == "top_mm" && truth >= case.pipe_length_mm)
}

fn sigma(case: &Case, parameter: &str) -> Option<f64> {
    case.bounds.as_ref()?.sigma.get(parameter).copied()
}

fn relative_error(value: f64, truth: f64) -> f64 {
    ((value - truth) / truth).abs()
}

/// The median: the middle value, or the mean of the two in the middle.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (sorted.len().checked_sub(1)? / 2, sorted.len() / 2);
    Some(f64::midpoint(sorted[low], sorted[high]))
}
