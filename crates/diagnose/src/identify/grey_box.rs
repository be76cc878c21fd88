//! Grey-box identification: a plant of two or three poles from what a rig did, with intervals.
//!
//! ```text
//! two poles   K/(s(s + a))        three poles   K/(s(s + a)(τs + 1))
//! θ = (K, a, τ, hover, both noises) = arg max Σ ln p(ν_k)      ν: innovations of the Kalman filter, input: duty
//! ```
//!
//! The input is the recorded duty, whatever made it. In closed loop too the innovations of a right model are white, so
//! no controller is simulated (direct approach). Other effects of the initial model keep their believed values. The
//! result does not depend on the initial values.
//! Source: Ljung, *System Identification*, 2nd edition, chapters 7 and 13; the thesis, sections 3.1.3 and 3.1.4.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::fit::profile::{OF_90_PERCENT, interval};
use crate::identify::open_loop::SHORTEST_S;
use crate::identify::residual_tests::ResidualTests;
use crate::identify::validation::HeldOut;
use crate::record::check::SLOWEST_S;
use crate::record::folds::Folds;
use crate::record::free_flight::SETTLING_S;
use crate::record::recording::Recording;
use crate::select::refit::with_noise_that_fits;
use crate::thresholds::ENOUGH_READINGS;
use plant::effects::FanLag;
use plant::{Effect, Model};
use serde::Serialize;

/// Initial fan lags of a fit with three poles, seconds; the best one is used.
const LAGS_S: [f64; 3] = [0.05, 0.2, 0.6];
/// Smallest number of scoring steps from each before they are compared.
const FIRST_LOOK: usize = 4;

/// Held-out log-likelihood gain that a third pole needs, nats: by chance one more parameter gains half a nat.
const WORTH_A_POLE: f64 = 2.0;

/// The number of poles of the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Poles {
    /// The ball only.
    Two,
    /// Ball and fan.
    Three,
}

/// A parameter of the plant with its 90 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Its key in the config's `[plant]`.
    pub name: &'static str,
    /// The most likely value.
    pub value: f64,
    /// Lower end; `None` if it is not identifiable.
    pub low: Option<f64>,
    /// Upper end; `None` if it is not identifiable.
    pub high: Option<f64>,
}

/// An identified plant.
#[derive(Clone, Debug)]
pub struct GreyBox {
    /// The number of poles.
    pub poles: Poles,
    /// The fitted model and its innovations.
    pub fit: Fit,
    /// Gain, drag, hover and, with three poles, the fan lag.
    pub estimates: Vec<ParameterEstimate>,
    /// Tests whether the innovations are white noise.
    pub residuals: ResidualTests,
    /// Prediction of the last third of each flight by a fit without that third.
    pub held_out: HeldOut,
}

/// Why identification is not possible.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TooLittle {
    /// Too few readings in free flight.
    #[error(
        "{readings} readings in free flight once the filter has settled (within {SETTLING_S} s, or a tenth of a \
         shorter flight); {ENOUGH_READINGS} are needed: record longer, with an input that moves all the time"
    )]
    Readings {
        /// Number of readings found.
        readings: usize,
    },
    /// The rows are too far apart.
    #[error(
        "the rows are {apart_s:.3} s apart, and no lag or drag of a rig shows in such a record: record at least 10 a \
         second; if the times are in another unit, such as milliseconds, say --time-scale 0.001 to `airball \
         init`, or scale = 0.001 of time_s in [import]"
    )]
    SlowRows {
        /// The mean time between rows, seconds.
        apart_s: f64,
    },
    /// Too few readings in stretches without control.
    #[error(
        "{readings} readings in stretches without control of {SHORTEST_S} s or longer, {ENOUGH_READINGS} are needed, \
         and the longest such stretch in free flight has {longest_s:.1} s; fly experiments/open-loop.toml, which takes \
         80 s, or identify a flight under control without --open-loop"
    )]
    OpenLoop {
        /// Number of readings found.
        readings: usize,
        /// The longest stretch without control, seconds.
        longest_s: f64,
    },
}

impl TooLittle {
    /// Refuses a record whose rows are too far apart on average.
    ///
    /// # Errors
    /// [`TooLittle::SlowRows`].
    pub(crate) fn check_row_period(recording: &Recording) -> Result<(), Self> {
        let apart_s = recording.duration_s() / recording.samples().len().saturating_sub(1).max(1) as f64;
        if apart_s > SLOWEST_S { Err(Self::SlowRows { apart_s }) } else { Ok(()) }
    }
}

impl GreyBox {
    /// Identifies a plant with this number of poles from `recording`; `start`: initial values.
    ///
    /// # Errors
    /// [`TooLittle`]: the record is too short, or its rows are too far apart.
    pub fn identify(start: &Model, recording: &Recording, poles: Poles) -> Result<Self, TooLittle> {
        TooLittle::check_row_period(recording)?;
        let folds = Folds::new(start, recording);
        let readings = folds.readings(recording);
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

impl GreyBox {
    /// The correlations of the estimates, each pair once, by their keys.
    #[must_use]
    pub fn correlations(&self) -> Vec<(&'static str, &'static str, f64)> {
        let covariance = self.fit.covariance();
        let keyed = self.fit.parameters.iter().enumerate().filter_map(|(at, one)| Some((at, key(*one)?)));
        let keyed: Vec<(usize, &'static str)> = keyed.collect();
        let pairs = keyed.iter().enumerate().flat_map(|(k, a)| keyed[k + 1..].iter().map(move |b| (a, b)));
        let of = |((i, a), (j, b)): (&(usize, &'static str), &(usize, &'static str))| {
            let value = covariance[(*i, *j)] / (covariance[(*i, *i)] * covariance[(*j, *j)]).sqrt();
            value.is_finite().then_some((*a, *b, value))
        };
        pairs.filter_map(of).collect()
    }

    /// Whether it forecasts the held-out part significantly better than `other`.
    pub(crate) fn is_better_than(&self, other: &Self) -> bool {
        self.held_out.log_likelihood > other.held_out.log_likelihood + WORTH_A_POLE
    }

    /// Half of the 90 % interval of a number of the plant.
    #[must_use]
    pub fn reach(&self, number: impl Fn(&Model) -> f64) -> f64 {
        OF_90_PERCENT * self.fit.deviation_of(number)
    }
}

/// The plant of fewer poles, unless another forecasts the held-out part significantly better. `None`: there is no
/// plant.
#[must_use]
pub fn better(found: &[GreyBox]) -> Option<&GreyBox> {
    found.iter().reduce(|best, next| if next.is_better_than(best) { next } else { best })
}

/// The initial model with a fan lag for three poles, and without for two.
fn with_poles(start: &Model, poles: Poles) -> Model {
    let lag_s = match poles {
        Poles::Two => None,
        Poles::Three => start.effects.fan_lag_s().filter(|lag_s| *lag_s > 0.0).or(Some(LAGS_S[1])),
    };
    with_lag(start, lag_s)
}

/// The model with this fan lag, or without.
fn with_lag(model: &Model, lag_s: Option<f64>) -> Model {
    Model { effects: model.effects.with_fan_lag(lag_s), ..model.clone() }
}

/// The most likely model from several initial fan lags.
fn best_fit(problem: &Problem<'_>, poles: Poles) -> Fit {
    let parameters = parameters(problem.belief);
    let near = with_noise_that_fits(problem, &parameters);
    let mut starts = vec![near.clone()];
    if poles == Poles::Three {
        starts.extend(LAGS_S.map(|lag_s| with_lag(&near, Some(lag_s))));
    }
    let looks = starts.iter().map(|start| problem.fit_briefly(start, &parameters, FIRST_LOOK));
    let best = looks.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(near, |(model, _)| model);
    // The scale of a lag depends on its value.
    problem.fit(&best, &self::parameters(&best))
}

/// The fitted parameters: gain, drag, hover, both noises, and the fan lag if the model has one.
fn parameters(model: &Model) -> Vec<Parameter> {
    let lag = model.effects.fan_lag_s().map_or_else(Vec::new, |lag_s| parameters_of_effect(&FanLag::ENTRY, &[lag_s]));
    [&BASE[..], &lag].concat()
}

/// The key of a parameter in the config's `[plant]`; `None` for a nuisance parameter.
const fn key(parameter: Parameter) -> Option<&'static str> {
    match parameter {
        Parameter::Gain => Some("gain_mm_per_s2_per_percent"),
        Parameter::Drag => Some("drag_per_s"),
        Parameter::Hover => Some("hover_duty_percent"),
        Parameter::SensorNoise | Parameter::AirNoise | Parameter::NoiseLevel => None,
        Parameter::Effect { .. } => Some("fan_lag.time_constant_s"),
    }
}

/// All parameters but the nuisance parameters, with their intervals.
fn estimates(problem: &Problem<'_>, fit: &Fit) -> Vec<ParameterEstimate> {
    let known = problem.sensitivities_of(fit, &fit.parameters);
    let one = |(at, parameter): (usize, &Parameter)| {
        let (name, value) = (key(*parameter)?, parameter.value(&fit.model)?);
        let [low, high] = interval(problem, fit, &known, at, OF_90_PERCENT)
            .map(|by| parameter.value(&parameter.stepped(&fit.model, by?)));
        Some(ParameterEstimate { name, value, low, high })
    };
    fit.parameters.iter().enumerate().filter_map(one).collect()
}
