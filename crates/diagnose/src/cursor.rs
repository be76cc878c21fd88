//! A model's Kalman filter on its way along a recording.
//!
//! ```text
//! state x = (y, v, A, w, s)                         see `plant::Motion`
//! x ← motion(x, command), P ← Φ·P·Φᵀ + Q            Φ = ∂motion/∂x by central differences
//! Q = PSD·dt/6 · ( g₀·g₀ᵀ + 4·g·gᵀ + g₁·g₁ᵀ )       white acceleration over a step: Simpson's rule of Φ(s)·e_v
//!     g₀ = e_v, g₁ = Φ·e_v, g = (g₀ + g₁)/2         and δ² of turbulence on w
//! reading = y, or s behind a sensor's lag
//! ```
//!
//! The extended Kalman filter: exact for the linear part, which central differences reproduce to rounding, and for
//! whatever acts on the duty alone. A reading that is old is a reading of an earlier time: the filter comes by there
//! first. Each stretch uses its real length and ends where the command jumps.
//! Source: Gelb, *Applied Optimal Estimation*, chapter 6.

use crate::likelihood::Surprise;
use crate::recording::Sample;
use control::kalman::Kalman;
use nalgebra::{RowSVector, SMatrix, SVector};
use plant::{Actuator, Model, Motion};

const STATES: usize = 5;
type State = SVector<f64, STATES>;
type Square = SMatrix<f64, STATES, STATES>;

/// Longest integration step, seconds: RK4 is exact to 1e-6 of a rig's motion there.
const MAX_STEP_S: f64 = 0.02;
/// Steps of the central differences, each small beside a flight and large beside rounding.
const NUDGE: [f64; STATES] = [1e-3, 1e-2, 1e-1, 1e-1, 1e-3];
/// Before the first reading nothing is known of the velocity but that a ball in a pipe stays below 2 m/s.
pub(crate) const VELOCITY_PRIOR_MM_PER_S: f64 = 1000.0;
/// Wild readings come singly: so many in a row are the ball, and the filter is what was wrong.
const WILD_IN_A_ROW: u32 = 2;

/// The filter, where it is, and the fan's part of the way there.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    model: &'a Model,
    samples: &'a [Sample],
    filter: Kalman<STATES>,
    actuator: Actuator,
    /// Time of the filter since the start of the record, seconds.
    time_s: f64,
    /// The next row whose duty has not been written yet.
    next_write: usize,
    wild_run: u32,
}

impl<'a> Cursor<'a> {
    /// A filter that knows the first reading, at row `row`, and nothing else.
    pub(crate) fn new(model: &'a Model, samples: &'a [Sample], row: usize, reading_mm: f64) -> Self {
        let first_duty = samples.first().map_or(0.0, |first| first.duty_percent);
        let time_s = reading_time(model, samples, row).unwrap_or_default();
        let actuator = Actuator::new(model, first_duty);
        let mut cursor = Self {
            model,
            samples,
            filter: prior(model, reading_mm, first_duty),
            actuator,
            time_s: time_s.min(0.0),
            next_write: 0,
            wild_run: 0,
        };
        cursor.go_to(time_s);
        cursor.filter = Kalman { covariance: prior(model, reading_mm, first_duty).covariance, ..cursor.filter };
        cursor.filter.state[0] = reading_mm;
        cursor.filter.state[4] = reading_mm;
        cursor
    }

    /// Moves the filter to when the reading of `row` was taken.
    pub(crate) fn go_to_row(&mut self, row: usize) {
        if let Some(time_s) = reading_time(self.model, self.samples, row) {
            self.go_to(time_s);
        }
    }

    /// What the reading here would be, mm, and its variance, mm².
    pub(crate) fn expect(&self) -> (f64, f64) {
        self.filter.expect(&row_of(self.model), reading_variance(self.model))
    }

    /// Takes the reading of `row` as far as it is no wild one: its weight divides the variance of the innovation.
    pub(crate) fn take(&mut self, row: usize, reading_mm: f64) -> Surprise {
        let variance = reading_variance(self.model);
        let (expected, expected_variance) = self.expect();
        let outliers = self.model.effects.sensor_outliers.map(|o| (o.probability, o.size_mm));
        let surprise = Surprise::of(row, reading_mm - expected, expected_variance, outliers);
        let weight = if self.wild_run >= WILD_IN_A_ROW { 1.0 } else { surprise.weight.max(1e-6) };
        let widened = variance + expected_variance / weight - expected_variance;
        self.filter.update(reading_mm, &row_of(self.model), widened);
        self.wild_run = if surprise.weight < 0.5 { self.wild_run + 1 } else { 0 };
        surprise
    }

    /// Position and velocity, mm and mm/s.
    pub(crate) fn position_and_velocity(&self) -> (f64, f64) {
        (self.filter.state[0], self.filter.state[1])
    }

    /// Flies on to `time_s`, through every duty that is written and every jump of the command on the way.
    fn go_to(&mut self, time_s: f64) {
        let start_s = self.samples.first().map_or(0.0, |first| first.time_s);
        while self.time_s < time_s || self.next_write == 0 {
            let written = self.samples.get(self.next_write).map(|s| (s.time_s - start_s, s.duty_percent));
            let write_s = written.map_or(f64::INFINITY, |(at_s, _)| at_s);
            if write_s <= self.time_s {
                self.actuator.write(self.model, write_s.max(0.0), written.map_or(0.0, |(_, duty)| duty));
                self.next_write += 1;
                continue;
            }
            if self.time_s >= time_s {
                break;
            }
            let jump_s = self.actuator.next_jump_s(self.time_s).unwrap_or(f64::INFINITY);
            self.fly_to(time_s.min(write_s).min(jump_s));
        }
    }

    /// Flies on to `time_s`, until which the command does not jump.
    fn fly_to(&mut self, time_s: f64) {
        let (start, ahead) = (self.time_s, time_s - self.time_s);
        let steps = (ahead / MAX_STEP_S).ceil().max(1.0);
        let dt = ahead / steps;
        let drifts = Actuator::drifts(self.model);
        let mut commanded = self.actuator.commanded(self.model, start.max(0.0));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
        for step in 0..steps as u64 {
            if drifts {
                commanded = self.actuator.commanded(self.model, (start + (step as f64 + 0.5) * dt).max(0.0));
            }
            self.step(commanded, dt);
        }
        self.time_s = time_s;
    }

    fn step(&mut self, commanded: f64, dt: f64) {
        let x = &self.filter.state;
        let motion = Motion {
            position_mm: x[0],
            velocity_mm_per_s: x[1],
            fan_mm_per_s2: x[2],
            turbulence_mm_per_s2: x[3],
            sensed_mm: x[4],
        };
        // An end of the pipe stops the ball, not the doubt about it: the covariance grows as if there were none.
        let flow = |nudged: &Motion| nudged.step_in_endless_pipe(self.model, commanded, dt);
        let transition = derivative(self.model, flow, &motion);
        let next = vector(&motion.step(self.model, commanded, dt));
        let noise = process_noise(self.model, &transition, dt);
        self.filter.predict(next, &transition, &noise);
    }
}

/// When the reading of `row` was taken, seconds since the start of the record. `None`: there is no such row.
fn reading_time(model: &Model, samples: &[Sample], row: usize) -> Option<f64> {
    let since_start_s = samples.get(row)?.time_s - samples.first()?.time_s;
    Some(since_start_s - model.effects.sensor_delay.map_or(0.0, |delay| delay.delay_s))
}

/// The filter before its first reading, which it then takes as it takes every other.
fn prior(model: &Model, reading_mm: f64, duty_percent: f64) -> Kalman<STATES> {
    let commanded = model.commanded(duty_percent);
    let effects = &model.effects;
    // How far the fan may be from where it is told to go: it may stand still.
    let lags = effects.fan_lag.is_some() || effects.spin_asymmetry.is_some();
    let fan = if lags { model.hover_duty_percent.abs().max(1.0) * model.gain_mm_per_s2_per_percent } else { 0.0 };
    let air = effects.turbulence.map_or(0.0, |turbulence| turbulence.sigma_mm_per_s2);
    let sensed = if effects.sensor_lag.is_some() { model.pipe_length_mm } else { 0.0 };
    let deviations = State::from([model.pipe_length_mm, VELOCITY_PRIOR_MM_PER_S, fan, air, sensed]);
    Kalman {
        state: State::from([reading_mm, 0.0, commanded, 0.0, reading_mm]),
        covariance: Square::from_diagonal(&deviations.component_mul(&deviations)),
    }
}

/// Which part of the state the reading shows.
fn row_of(model: &Model) -> RowSVector<f64, STATES> {
    if model.effects.sensor_lag.is_some() {
        RowSVector::from([0.0, 0.0, 0.0, 0.0, 1.0])
    } else {
        RowSVector::from([1.0, 0.0, 0.0, 0.0, 0.0])
    }
}

/// A reading's variance, never quite 0: a sensor without noise still leaves the filter a division. A coarse reading adds
/// the variance of its rounding.
fn reading_variance(model: &Model) -> f64 {
    let believed = model.noise.sensor_mm;
    let sigma = model.effects.sensor_noise.map_or(believed, |noise| noise.total_mm(believed));
    let rounding = model.effects.sensor_quantisation.map_or(0.0, |steps| steps.step_mm.powi(2) / 12.0);
    (sigma.powi(2) + rounding).max(1e-9)
}

/// The covariance that the air gathers over a step with this `transition`.
fn process_noise(model: &Model, transition: &Square, dt: f64) -> Square {
    let first = State::from([0.0, 1.0, 0.0, 0.0, 0.0]);
    let last = transition * first;
    let middle = (first + last) / 2.0;
    let outer = |g: State| g * g.transpose();
    let white = model.noise.acceleration_psd_mm2_per_s3 * dt / 6.0;
    let mut noise = (outer(first) + 4.0 * outer(middle) + outer(last)) * white;
    if let Some(turbulence) = model.effects.turbulence {
        noise[(3, 3)] += turbulence.kick(dt).powi(2);
    }
    noise
}

fn vector(motion: &Motion) -> State {
    State::from([
        motion.position_mm,
        motion.velocity_mm_per_s,
        motion.fan_mm_per_s2,
        motion.turbulence_mm_per_s2,
        motion.sensed_mm,
    ])
}

/// ∂flow/∂x at `motion` by central differences, for the states that this model remembers.
fn derivative(model: &Model, flow: impl Fn(&Motion) -> Motion, motion: &Motion) -> Square {
    let effects = &model.effects;
    let remembered = [
        true,
        true,
        effects.fan_lag.is_some() || effects.spin_asymmetry.is_some(),
        effects.turbulence.is_some(),
        effects.sensor_lag.is_some(),
    ];
    let mut transition = Square::zeros();
    for (i, _) in remembered.iter().enumerate().filter(|(_, remembered)| **remembered) {
        let nudged = |by: f64| {
            let mut nudged = *motion;
            match i {
                0 => nudged.position_mm += by,
                1 => nudged.velocity_mm_per_s += by,
                2 => nudged.fan_mm_per_s2 += by,
                3 => nudged.turbulence_mm_per_s2 += by,
                _ => nudged.sensed_mm += by,
            }
            vector(&flow(&nudged))
        };
        transition.set_column(i, &((nudged(NUDGE[i]) - nudged(-NUDGE[i])) / (2.0 * NUDGE[i])));
    }
    transition
}
