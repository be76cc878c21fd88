//! Grey-box identification: a plant of two or three poles from what a rig did, with intervals.
//!
//! ```text
//! two poles   K/(s(s + a))        three poles   K/(s(s + a)(τs + 1))
//! θ = (K, a, τ, hover, both noises) = arg max Σ ln p(ν_k)      ν: innovations of the Kalman filter along the recorded duty
//! ```
//!
//! The recorded duty goes in, whoever made it: in closed loop as well the innovations of a right model are white, and no controller is
//! simulated (the direct approach). Other effects of the start stay as they are believed. The start says nothing of the result.
//! Source: Ljung, *System Identification*, 2nd edition, chapters 7 and 13; the thesis, sections 3.1.3 and 3.1.4.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::fit::profile::{OF_90_PERCENT, interval};
use crate::identify::residual_tests::ResidualTests;
use crate::identify::validation::HeldOut;
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::select::refit::with_noise_that_fits;
use crate::thresholds::ENOUGH_READINGS;
use plant::effects::FanLag;
use plant::{Effect, Model};
use serde::Serialize;

/// Lags of the fan from which a fit of three poles begins, seconds; the best wins.
const LAGS_S: [f64; 3] = [0.05, 0.2, 0.6];
/// Steps of the first look from each, at least.
const FIRST_LOOK: usize = 4;

/// How many poles the plant has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Poles {
    /// The ball alone.
    Two,
    /// Ball and fan.
    Three,
}

/// A number of the plant with its 90 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Its key in the config's `[plant]`.
    pub name: &'static str,
    /// The most likely value.
    pub value: f64,
    /// Lower end; `None`: the record sets none.
    pub low: Option<f64>,
    /// Upper end; `None`: the record sets none.
    pub high: Option<f64>,
}

/// A plant that was identified.
#[derive(Clone, Debug)]
pub struct GreyBox {
    /// How many poles it has.
    pub poles: Poles,
    /// The model at its best, and how the record looks to it.
    pub fit: Fit,
    /// Gain, drag, hover and, with three poles, the fan's lag.
    pub estimates: Vec<Estimate>,
    /// Whether the innovations are noise.
    pub residuals: ResidualTests,
    /// How well the same fit, made without the last third of each flight, foretells that third.
    pub held_out: HeldOut,
}

/// Why nothing was identified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TooLittle {
    /// Too few readings in free flight.
    #[error(
        "{readings} readings in free flight, {ENOUGH_READINGS} are needed; fly experiments/identify.toml, which takes 100 s, or longer stretches \
         without control, which count from 4 s on"
    )]
    Readings {
        /// How many there are.
        readings: usize,
    },
}

impl GreyBox {
    /// Identifies a plant of so many poles from `recording`, with `start` as a first guess.
    ///
    /// # Errors
    /// [`TooLittle`]: the record is too short.
    pub fn identify(start: &Model, recording: &Recording, poles: Poles) -> Result<Self, TooLittle> {
        let folds = Folds::new(start, recording);
        let counts = recording.samples().iter().enumerate();
        let readings = counts.filter(|(row, s)| s.position_mm.is_some() && folds.counts(*row)).count();
        if readings < ENOUGH_READINGS {
            return Err(TooLittle::Readings { readings });
        }
        let start = with_poles(start, poles);
        let problem = Problem { recording, belief: &start, folds: &folds, prior: Prior::Nothing };
        let fit = best_fit(&problem, poles);
        let estimates = estimates(&problem, &fit);
        let residuals = ResidualTests::of(&fit, recording, &folds);
        let held_out = HeldOut::of(&problem, &fit);
        Ok(Self { poles, fit, estimates, residuals, held_out })
    }
}

/// The start with a fan's lag where three poles are asked for, and without where two are.
fn with_poles(start: &Model, poles: Poles) -> Model {
    let lag_s = match poles {
        Poles::Two => None,
        Poles::Three => start.effects.fan_lag_s().filter(|lag_s| *lag_s > 0.0).or(Some(LAGS_S[1])),
    };
    with_lag(start, lag_s)
}

/// The model whose fan has this lag, or none.
fn with_lag(model: &Model, lag_s: Option<f64>) -> Model {
    Model { effects: model.effects.with_fan_lag(lag_s), ..model.clone() }
}

/// The most likely model, from the start's own lag and from others.
fn best_fit(problem: &Problem<'_>, poles: Poles) -> Fit {
    let parameters = parameters(problem.belief);
    let near = with_noise_that_fits(problem, &parameters);
    let mut starts = vec![near.clone()];
    if poles == Poles::Three {
        starts.extend(LAGS_S.map(|lag_s| with_lag(&near, Some(lag_s))));
    }
    let looks = starts.iter().map(|start| problem.fit_briefly(start, &parameters, FIRST_LOOK));
    let best = looks.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(near, |(model, _)| model);
    // A lag moves in units of what it is about.
    problem.fit(&best, &self::parameters(&best))
}

/// What a fit moves: gain, drag, hover, both noises, and the fan's lag where there is one.
fn parameters(model: &Model) -> Vec<Parameter> {
    let lag =
        model.effects.fan_lag_s().map_or_else(Vec::new, |lag_s| parameters_of_effect(FanLag::ENTRY.name, &[lag_s]));
    [&BASE[..], &lag].concat()
}

/// The key of a number in the config's `[plant]`. `None`: a nuisance.
const fn key(parameter: Parameter) -> Option<&'static str> {
    match parameter {
        Parameter::Gain => Some("gain_mm_per_s2_per_percent"),
        Parameter::Drag => Some("drag_per_s"),
        Parameter::Hover => Some("hover_duty_percent"),
        Parameter::SensorNoise | Parameter::AirNoise => None,
        Parameter::Effect { .. } => Some("fan_lag.time_constant_s"),
    }
}

/// Every number but the nuisances, with its interval.
fn estimates(problem: &Problem<'_>, fit: &Fit) -> Vec<Estimate> {
    let one = |(at, parameter): (usize, &Parameter)| {
        let (name, value) = (key(*parameter)?, parameter.value(&fit.model)?);
        let [low, high] =
            interval(problem, fit, at, OF_90_PERCENT).map(|by| parameter.value(&parameter.stepped(&fit.model, by?)));
        Some(Estimate { name, value, low, high })
    };
    fit.parameters.iter().enumerate().filter_map(one).collect()
}
