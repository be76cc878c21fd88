//! A model's extended Kalman filter along a recording.
//!
//! ```text
//! state x = (y, v, A, w, s, own states)             see `plant::Motion`
//! x ← motion(x, command), P ← Φ·P·Φᵀ + Q            Φ and Q: see `covariance`
//! reading = y, or s behind a sensor's lag           see `measurement` where written effects act in the sensor
//! ```
//!
//! It is exact for linear models, and for effects that act on the duty alone. A step with dry friction is one linear
//! map until the ball stops. A delayed reading belongs to an earlier time, and the filter uses it there. Each
//! integration step has the real time between its ends and ends where the command jumps.
//! Source: Gelb, *Applied Optimal Estimation*, chapter 6.

mod active;
mod advance;
mod covariance;
mod fast_duty;
mod measurement;
mod prior;
mod smoother;
mod step;

use crate::record::reading_variance::reading_variance;
use active::Active;
pub(crate) use covariance::PropagationCache;
use fast_duty::DutyAveraging;
use measurement::{Measured, expected_mm};
#[cfg(test)]
pub(crate) use prior::VELOCITY_PRIOR_MM_PER_S;
use prior::prior;
pub(crate) use smoother::{FilteredStep, Segment, Sensitivity, Smoothed, SmootherMemory, smoothed};

use crate::filter::innovation::{Innovation, Reading};
use crate::record::recording::Write;
use nalgebra::{SMatrix, SVector};
use plant::{Actuator, Input, Model, OWN_STATES};

const STATES: usize = 5 + OWN_STATES;
type State = SVector<f64, STATES>;
type Square = SMatrix<f64, STATES, STATES>;

/// Outliers come singly: after this many in a row the filter was wrong, and the next reading counts in full.
const WILD_IN_A_ROW: u32 = 2;
/// The same for a sensor that is believed to have outliers: they may come in bursts.
const WILD_IN_A_BURST: u32 = 5;

/// The filter: its state, covariance and time, and the duty's path to the fan.
#[derive(Clone, Debug)]
pub(crate) struct Ekf<'a> {
    model: &'a Model,
    /// The duties of the flight, row by row.
    writes: &'a [Write],
    state: State,
    covariance: Square,
    /// The states that this model has.
    active: Active,
    /// Whether a step in the air is one linear map.
    linear: bool,
    actuator: Actuator,
    /// Time of the filter since the start of the flight, seconds.
    time_s: f64,
    /// The last command, mm/s².
    commanded_mm_per_s2: f64,
    /// The next row whose duty has not been written.
    next_write: usize,
    wild_run: u32,
    /// How the duties between two readings are averaged.
    flown: DutyAveraging,
    /// Variance of a reading, mm².
    reading_mm2: f64,
    /// Whether the covariance is kept: where friction is smoothed, the mean depends on it.
    keeps_covariance: bool,
    /// What the smoother needs, boxed because most filters lack it; `None`: no smoothing.
    back: Option<Box<SmootherMemory>>,
}

impl<'a> Ekf<'a> {
    /// A filter that starts from the first reading of a flight, at row `row` of its `writes`.
    pub(crate) fn new(
        model: &'a Model,
        writes: &'a [Write],
        row: usize,
        reading_mm: f64,
        steps: &mut PropagationCache,
    ) -> Self {
        let (first, last) = (writes.first(), writes.last());
        let first_duty = first.map_or(0.0, |first| first.duty_percent);
        let duration_s = first.zip(last).map_or(0.0, |(first, last)| last.time_s - first.time_s);
        let time_s = reading_time(model, writes, row).unwrap_or_default();
        let mut actuator = Actuator::new(model, first_duty);
        actuator.set_setpoint(first.and_then(|first| first.setpoint_mm));
        let commanded_mm_per_s2 = actuator.clone().commanded(model, 0.0);
        let before = Input { setpoint_mm: actuator.setpoint_mm(), ..Input::of(commanded_mm_per_s2) };
        let (state, covariance) = prior(model, reading_mm, before);
        let mut ekf = Self {
            model,
            writes,
            state,
            covariance,
            active: Active::of(model),
            linear: model.effects.motion_is_linear_in_command(),
            actuator,
            time_s: time_s.min(0.0),
            commanded_mm_per_s2,
            next_write: 0,
            wild_run: 0,
            reading_mm2: reading_variance(model),
            flown: DutyAveraging::of(duration_s, writes.len()),
            keeps_covariance: true,
            back: None,
        };
        ekf.advance_to(time_s, steps);
        ekf.covariance = covariance;
        ekf.state[0] = reading_mm;
        ekf.state[4] = reading_mm;
        ekf
    }

    /// The same filter for readings that are means of `count` readings.
    pub(crate) fn of_means(self, count: usize) -> Self {
        let flown = if count > 1 { self.flown.roughly() } else { self.flown };
        Self { reading_mm2: self.reading_mm2 / count as f64, flown, ..self }
    }

    /// The same filter for forecasts of the mean alone, which takes a fraction of the time.
    pub(crate) fn of_mean_alone(self) -> Self {
        let keeps_covariance = self.model.effects.friction().is_some();
        Self { keeps_covariance, ..self }
    }

    /// Propagates the filter to the time of the reading of `row`.
    pub(crate) fn advance_to_row(&mut self, row: usize, steps: &mut PropagationCache) {
        if let Some(time_s) = reading_time(self.model, self.writes, row) {
            self.advance_to(time_s, steps);
        }
    }

    /// The expected reading, mm, and its variance, mm².
    pub(crate) fn predicted_reading(&self) -> (f64, f64) {
        let measured = self.measured(&self.state);
        let variance_mm2 = measured.change(&measured.towards(&self.covariance));
        (self.expected_reading_mm(), variance_mm2 + self.reading_mm2)
    }

    /// The expected reading, mm.
    pub(crate) fn expected_reading_mm(&self) -> f64 {
        expected_mm(self.model, &self.state, self.input())
    }

    /// What a reading measures now, about a state.
    fn measured(&self, state: &State) -> Measured {
        Measured::of(self.model, &self.active, state, self.input())
    }

    fn input(&self) -> Input {
        let setpoint_mm = self.actuator.setpoint_mm();
        Input { commanded_mm_per_s2: self.commanded_mm_per_s2, time_s: self.time_s, setpoint_mm }
    }

    /// The variance of a reading as the file holds it, rounded by a quantised sensor, mm².
    pub(crate) fn rounded_reading_mm2(&self) -> f64 {
        let rounding = self.model.effects.reading_step_mm().map_or(0.0, |step_mm| step_mm.powi(2) / 12.0);
        self.predicted_reading().1 + rounding
    }

    /// The innovation of a reading.
    pub(crate) fn predict(&self, reading: Reading) -> Innovation {
        let (expected, variance) = self.predicted_reading();
        Innovation::of(reading, expected, variance)
    }

    /// Updates the state by a reading, weighted by its probability of being no outlier: an outlier has no effect.
    pub(crate) fn take(&mut self, reading: Reading) -> Innovation {
        if let Some(back) = &mut self.back {
            back.arrive(self.state, self.covariance);
        }
        let innovation = self.predict(reading);
        let (expected, variance) = (innovation.expected_mm, innovation.variance_mm2);
        let (weight, standardised) =
            if self.wild_run >= if reading.outliers.is_some() { WILD_IN_A_BURST } else { WILD_IN_A_ROW } {
                (1.0, (reading.position_mm - expected) / variance.sqrt())
            } else {
                (innovation.weight, innovation.standardised)
            };
        let towards = self.measured(&self.state).towards(&self.covariance);
        self.state += towards * (standardised / variance.sqrt());
        self.active.reduce(&mut self.covariance, &towards, weight / variance);
        self.wild_run = if innovation.weight < 0.5 && reading.coarse.is_none() { self.wild_run + 1 } else { 0 };
        innovation
    }

    /// Propagates to `time_s` since the start of the flight, and updates the state by a second sensor's reading of the
    /// ball itself.
    pub(crate) fn update_by_second_sensor(
        &mut self,
        time_s: f64,
        reading: Reading,
        variance_mm2: f64,
        steps: &mut PropagationCache,
    ) -> Innovation {
        self.advance_to(time_s, steps);
        let variance = self.covariance[(0, 0)] + variance_mm2;
        let innovation = Innovation::of(reading, self.state[0], variance);
        let towards = self.covariance.column(0).into_owned();
        self.state += towards * (innovation.standardised / variance.sqrt());
        self.active.reduce(&mut self.covariance, &towards, innovation.weight / variance);
        innovation
    }

    /// The time of the reading of `row`, seconds since the start of the flight.
    pub(crate) fn time_of(&self, row: usize) -> f64 {
        reading_time(self.model, self.writes, row).unwrap_or(self.time_s)
    }

    /// Position and velocity, mm and mm/s.
    pub(crate) fn position_and_velocity(&self) -> (f64, f64) {
        (self.state[0], self.state[1])
    }
}

/// The time of the reading of `row`, seconds since the start of the flight. `None`: there is no such row.
fn reading_time(model: &Model, writes: &[Write], row: usize) -> Option<f64> {
    let since_start_s = writes.get(row)?.time_s - writes.first()?.time_s;
    Some(since_start_s - model.effects.reading_delay_s())
}
