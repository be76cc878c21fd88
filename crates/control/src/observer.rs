//! The observer: a Kalman filter of the believed plant along the control value, over irregular samples.
//!
//! ```text
//! predict over t      Φ, Γ of `believed.rs`     Q: v gains q·(1 − e^(−2at))/(2a), x·v q·A₁²/2, x·x q·A₁²·t/3, d q_d·t
//! update              test ratio ν²/(gate²·S): to 0.5 as expected, to 1.0 doubtful, above 1.0 an outlier, not used
//! steady state        x̂ ← x̂ + L·ν with the L to which K converges at the nominal period
//! second sensor       another update by the position
//! tachometer          an update by w, the fan's state, which then wanders: q_w·(1 − e^(−2t/τ))·τ/2
//! ```
//!
//! The steady-state filter costs a tenth of the time and is right while readings come on time; the time-varying one
//! uses the age of its estimate. Without a reading both only predict. Several consecutive outliers are not outliers:
//! the filter then restarts from the reading. A start from a ball in the air knows nothing of its velocity: until S has
//! come down to that of the steady state, the gain is time-varying whatever is set, so the next readings give the
//! velocity. A ball that lies at the bottom is at rest. x·x neglects a quarter of a·t, and the share of the wandering
//! hover in x and v over one step is left out.
//! Source: Gelb, *Applied Optimal Estimation*, chapter 4; the test ratio is that of PX4's estimator.

mod steady;

use crate::believed::{Believed, State, Transition};
use crate::check::{OutOfRange, within};
use crate::design::DesignError;
use crate::kalman::Kalman;
use libm::{exp, fabs};
use nalgebra::{RowSVector, SMatrix, matrix, vector};
use steady::{Steady, Weight};

/// The measured quantities: the position, and the fan's state where there is a tachometer.
const POSITION: RowSVector<f64, 4> = matrix![1.0, 0.0, 0.0, 0.0];
const FAN: RowSVector<f64, 4> = matrix![0.0, 0.0, 1.0, 0.0];
/// The initial velocity of a ball after its first reading: 1 sigma, mm/s.
const FIRST_VELOCITY_MM_PER_S: f64 = 300.0;
/// The initial variance of hover is that of this many seconds of wandering.
const FIRST_WANDERING_S: f64 = 100.0;
/// Consecutive rejected readings after which the estimate is discarded.
const REFUSALS: u32 = 10;
/// A ball whose first reading is no more than so many sigma above the bottom lies there: one in 30,000 that lies there
/// reads higher.
const AT_BOTTOM_SIGMA: f64 = 4.0;
/// The steady-state gain is used again once the variance of an innovation is at most so many times that of the steady
/// state: its deviation then is a tenth larger.
const CONVERGED: f64 = 1.2;
/// A steady-state filter takes steps that differ by less than this share of its period for one period.
const ON_TIME: f64 = 0.1;

/// How the gain of the observer is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Gain {
    /// Once, for readings at the loop's period.
    #[default]
    SteadyState,
    /// At every step, for the time that has passed.
    TimeVarying,
}

/// The observer's belief. It never changes in flight; see [`Estimator`] for the state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Observer {
    /// Standard deviation of one reading, mm.
    pub sensor_mm: f64,
    /// q: white acceleration, the variance of the velocity grows by this per second, mm²/s³.
    pub acceleration_psd_mm2_per_s3: f64,
    /// q_d: hover wanders, its variance grows by this per second, (control value)²/s. Absent: hover is known.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub disturbance_psd_per_s: Option<f64>,
    /// Readings further from what was expected than so many sigma are outliers. `inf` takes all.
    pub gate_sigma: f64,
    /// Standard deviation of one reading of the second sensor, mm. Absent: it is read only while the first is silent.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub second_sensor_mm: Option<f64>,
    /// The noise of the fan's speed. Absent: it is not used; nor is it without `fan_lag_s`.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub tachometer: Option<Tachometer>,
    /// How the gain is found.
    #[cfg_attr(feature = "serde", serde(default))]
    pub gain: Gain,
    /// The plant. With `fan_lag_s` the fan is a third state.
    pub believed: Believed,
}

/// The relation of the fan's speed to its state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Tachometer {
    /// Standard deviation of one speed, control value.
    pub control: f64,
    /// q_w: how far the fan is from the believed lag, its variance grows by this per second, (control value)²/s.
    pub psd_per_s: f64,
}

/// The estimate of the plant's state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Position, mm.
    pub position_mm: f64,
    /// Velocity, mm/s, upward.
    pub velocity_mm_per_s: f64,
    /// The fan's contribution, control value.
    pub fan: f64,
    /// The error of hover, control value: it acts as if added to the fan's.
    pub disturbance: f64,
}

/// The innovation of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// Reading minus expectation, mm.
    pub innovation_mm: f64,
    /// Its square over that of the gate: to 0.5 as expected, to 1.0 doubtful, above 1.0 refused.
    pub test_ratio: f64,
}

/// The observer at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimator {
    set: Observer,
    period_s: f64,
    transition: Transition,
    steady: Steady,
    filter: Kalman<4>,
    seen: bool,
    /// Since a start in the air the variances have not come down to those of the steady state.
    converging: bool,
    refusals: u32,
}

impl Observer {
    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("sensor_mm", self.sensor_mm, 1e-3, 1e3)?;
        within("acceleration_psd_mm2_per_s3", self.acceleration_psd_mm2_per_s3, 1e-6, 1e9)?;
        within("gate_sigma", self.gate_sigma, 1.0, f64::INFINITY)?;
        self.disturbance_psd_per_s.map_or(Ok(()), |psd| within("disturbance_psd_per_s", psd, 1e-12, 1e9))?;
        self.second_sensor_mm.map_or(Ok(()), |sigma_mm| within("second_sensor_mm", sigma_mm, 1e-3, 1e3))?;
        let Some(tachometer) = self.tachometer else { return Ok(()) };
        within("tachometer.control", tachometer.control, 1e-3, 1e3)?;
        within("tachometer.psd_per_s", tachometer.psd_per_s, 1e-9, 1e6)
    }

    fn reading_variance(&self) -> f64 {
        self.sensor_mm * self.sensor_mm
    }

    fn second_variance(&self) -> Option<f64> {
        self.second_sensor_mm.map(|sigma_mm| sigma_mm * sigma_mm)
    }

    /// The tachometer, if the fan is a state of the model.
    fn measured_fan(&self) -> Option<Tachometer> {
        self.tachometer.filter(|_| self.believed.fan_lag_s.is_some())
    }

    /// Q over `dt_s`.
    fn noise(&self, dt_s: f64, transition: &Transition) -> SMatrix<f64, 4, 4> {
        let (q, drag) = (self.acceleration_psd_mm2_per_s3, self.believed.drag_per_s);
        let reach = transition.matrix[(0, 1)];
        let velocity = if drag * dt_s > 1e-6 { q * (1.0 - exp(-2.0 * drag * dt_s)) / (2.0 * drag) } else { q * dt_s };
        let both = q * reach * reach / 2.0;
        let position = q * reach * reach * dt_s / 3.0;
        let hover = self.disturbance_psd_per_s.unwrap_or(0.0) * dt_s;
        let wanders = |lag_s: f64| (1.0 - exp(-2.0 * dt_s / lag_s)) * lag_s / 2.0;
        let fan = self.measured_fan().zip(self.believed.fan_lag_s);
        let fan = fan.map_or(0.0, |(tachometer, lag_s)| tachometer.psd_per_s * wanders(lag_s));
        matrix![
            position, both, 0.0, 0.0;
            both, velocity, 0.0, 0.0;
            0.0, 0.0, fan, 0.0;
            0.0, 0.0, 0.0, hover]
    }

    /// The state after the first reading.
    fn first(&self, state: State) -> Kalman<4> {
        let hover = self.disturbance_psd_per_s.unwrap_or(0.0) * FIRST_WANDERING_S;
        let velocity = FIRST_VELOCITY_MM_PER_S * FIRST_VELOCITY_MM_PER_S;
        let variances: State = vector![self.reading_variance(), velocity, 0.0, hover];
        Kalman { state, covariance: SMatrix::from_diagonal(&variances) }
    }

    /// L: the steady-state filter's corrections of position, velocity, fan and disturbance per millimetre of
    /// innovation, when only readings of the first sensor come, every `period_s`.
    ///
    /// # Errors
    /// [`DesignError::NoRiccatiSolution`]: numbers so far apart that no steady-state gain can be computed.
    pub fn steady_gain(&self, period_s: f64) -> Result<State, DesignError> {
        let alone = Self { second_sensor_mm: None, tachometer: None, ..*self };
        Ok(Steady::of(&alone, period_s, &self.believed.over(period_s))?.first.gain)
    }
}

impl Estimator {
    /// An observer for readings every `period_s`, before its first reading.
    ///
    /// # Errors
    /// [`DesignError::NoRiccatiSolution`]: numbers so far apart that no steady-state gain can be computed.
    pub fn new(set: Observer, period_s: f64) -> Result<Self, DesignError> {
        let transition = set.believed.over(period_s);
        let steady = Steady::of(&set, period_s, &transition)?;
        let filter = set.first(State::zeros());
        Ok(Self { set, period_s, transition, steady, filter, seen: false, converging: false, refusals: 0 })
    }

    /// The numbers.
    #[must_use]
    pub const fn numbers(&self) -> &Observer {
        &self.set
    }

    /// The same estimate, continued with other numbers.
    ///
    /// # Errors
    /// [`DesignError::NoRiccatiSolution`]: numbers so far apart that no steady-state gain can be computed.
    pub fn with(&self, set: Observer) -> Result<Self, DesignError> {
        let Self { mut filter, seen, converging, refusals, .. } = *self;
        if self.gain() == Gain::SteadyState && set.gain == Gain::TimeVarying {
            // With the steady gain the filter's own covariance is still that of the first reading.
            filter.covariance = self.steady.covariance;
        }
        Ok(Self { filter, seen, converging, refusals, ..Self::new(set, self.period_s)? })
    }

    /// Counts control values from another duty, so that each is larger `by` so much: fan and error of hover keep their
    /// sum.
    pub(crate) fn rebase(&mut self, by: f64) {
        self.filter.state[2] += by;
        self.filter.state[3] -= by;
    }

    /// How the gain is found now.
    const fn gain(&self) -> Gain {
        if self.converging { Gain::TimeVarying } else { self.set.gain }
    }

    /// What is believed of the plant.
    #[must_use]
    pub const fn believed(&self) -> &Believed {
        &self.set.believed
    }

    /// The estimate. `None` before the first reading.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        let [position_mm, velocity_mm_per_s, fan, disturbance] = self.filter.state.data.0[0];
        self.seen.then_some(Estimate { position_mm, velocity_mm_per_s, fan, disturbance })
    }

    /// Lets `dt_s` pass, in which `control` acted.
    pub fn predict(&mut self, control: f64, dt_s: f64) {
        let steady = self.gain() == Gain::SteadyState;
        let on_time = steady && fabs(dt_s - self.period_s) < ON_TIME * self.period_s;
        let transition = if on_time { self.transition } else { self.set.believed.over(dt_s) };
        let next = transition.apply(&self.filter.state, control);
        if steady {
            self.filter.state = next;
        } else {
            self.filter.predict(next, &transition.matrix, &self.set.noise(dt_s, &transition));
        }
        if self.filter.state[0] < 0.0 {
            // The bottom of the pipe holds the ball, above all before the fan has spun up.
            self.filter.state[0] = 0.0;
            self.filter.state[1] = self.filter.state[1].max(0.0);
        }
    }

    /// Takes a reading of the position, unless it is an outlier. The first one only sets the position.
    pub fn update(&mut self, position_mm: f64) -> Option<Innovation> {
        self.take(position_mm, self.set.reading_variance(), self.steady.first)
    }

    /// The same of the second sensor, after the first one's where both came. Without `second_sensor_mm` as if it were
    /// the first.
    pub fn update_second(&mut self, position_mm: f64) -> Option<Innovation> {
        match (self.set.second_variance(), self.steady.second) {
            (Some(variance), Some(weight)) => self.take(position_mm, variance, weight),
            _ => self.update(position_mm),
        }
    }

    /// Whether readings of the second sensor are used in addition to those of the first.
    #[must_use]
    pub const fn knows_second(&self) -> bool {
        self.set.second_sensor_mm.is_some()
    }

    /// Takes the fan's speed as a measurement of its state: the control value at which it would remain.
    pub fn update_fan(&mut self, control: f64) {
        let (Some(tachometer), Some(weight)) = (self.set.measured_fan(), self.steady.fan) else { return };
        match self.gain() {
            Gain::SteadyState => self.filter.state += weight.gain * (control - self.filter.state[2]),
            Gain::TimeVarying => {
                self.filter.update(control, &FAN, tachometer.control * tachometer.control);
            }
        }
    }

    /// Takes a position of variance `variance`, with this weight in steady state.
    fn take(&mut self, position_mm: f64, variance: f64, weight: Weight) -> Option<Innovation> {
        if !self.seen {
            self.start(position_mm);
            return None;
        }
        let (expected_mm, expected_variance) = match self.gain() {
            Gain::SteadyState => (self.filter.state[0], weight.variance),
            Gain::TimeVarying => self.filter.expect(&POSITION, variance),
        };
        let innovation_mm = position_mm - expected_mm;
        let test_ratio =
            innovation_mm * innovation_mm / (self.set.gate_sigma * self.set.gate_sigma * expected_variance);
        if test_ratio > 1.0 {
            self.refusals += 1;
            if self.refusals >= REFUSALS {
                self.start(position_mm);
            }
        } else {
            self.refusals = 0;
            match self.gain() {
                Gain::SteadyState => self.filter.state += weight.gain * innovation_mm,
                Gain::TimeVarying => {
                    self.filter.update(position_mm, &POSITION, variance);
                }
            }
            self.converging &= expected_variance > CONVERGED * weight.variance;
        }
        Some(Innovation { innovation_mm, test_ratio })
    }

    /// Discards the position, but not the error of hover: the next reading sets the position.
    pub const fn lose_sight(&mut self) {
        self.seen = false;
    }

    /// Starts from a reading: the ball is there, at rest at the bottom and with unknown velocity elsewhere; fan and
    /// hover have their believed values.
    fn start(&mut self, position_mm: f64) {
        let [_, _, fan, disturbance] = self.filter.state.data.0[0];
        self.filter = self.set.first(vector![position_mm, 0.0, fan, disturbance]);
        self.converging = position_mm > AT_BOTTOM_SIGMA * self.set.sensor_mm;
        (self.seen, self.refusals) = (true, 0);
    }
}

#[cfg(test)]
mod tests;
