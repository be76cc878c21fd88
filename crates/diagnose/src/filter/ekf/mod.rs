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
mod covariance;
mod fast_duty;
mod measurement;
mod prior;
mod smoother;
mod step;

use crate::record::reading_variance::reading_variance;
use active::Active;
pub(crate) use covariance::PropagationCache;
use covariance::{Propagation, motion_of, vector};
use fast_duty::{DutyAveraging, DutyBlock};
use measurement::{Measured, expected_mm};
#[cfg(test)]
pub(crate) use prior::VELOCITY_PRIOR_MM_PER_S;
use prior::prior;
pub(crate) use smoother::{FilteredStep, Segment, Sensitivity, Smoothed, SmootherMemory, smoothed};
use step::{MAX_STEP_S, Step, longest_step_s, steps_over};

use crate::filter::innovation::{Innovation, Reading};
use crate::record::recording::Write;
use nalgebra::{SMatrix, SVector};
use plant::{Actuator, Friction, Input, Model, Motion, OWN_STATES};

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
        (expected_mm(self.model, &self.state, self.input()), variance_mm2 + self.reading_mm2)
    }

    /// What a reading measures now, about a state.
    fn measured(&self, state: &State) -> Measured {
        Measured::of(self.model, &self.active, state, self.input())
    }

    fn input(&self) -> Input {
        let setpoint_mm = self.actuator.setpoint_mm();
        Input { commanded_mm_per_s2: self.commanded_mm_per_s2, time_s: self.time_s, setpoint_mm }
    }

    /// The same for a reading as the file holds it, rounded by a quantised sensor.
    pub(crate) fn predicted_rounded_reading(&self) -> (f64, f64) {
        let rounding = self.model.effects.reading_step_mm().map_or(0.0, |step_mm| step_mm.powi(2) / 12.0);
        let (position_mm, variance_mm2) = self.predicted_reading();
        (position_mm, variance_mm2 + rounding)
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

    /// Propagates to `time_s` through every written duty and every jump of the command.
    fn advance_to(&mut self, time_s: f64, steps: &mut PropagationCache) {
        let start_s = self.writes.first().map_or(0.0, |first| first.time_s);
        let mut chatter = DutyBlock::from(self.time_s);
        while self.time_s < time_s || self.next_write == 0 {
            let written = self.writes.get(self.next_write);
            let write_s = written.map_or(f64::INFINITY, |write| write.time_s - start_s);
            if let Some(write) = written.filter(|_| write_s <= chatter.until_s) {
                self.actuator.set_setpoint(write.setpoint_mm);
                self.actuator.write(self.model, write_s.max(0.0), write.duty_percent);
                self.next_write += 1;
                continue;
            }
            if self.time_s >= time_s {
                break;
            }
            let jump_s = self.actuator.next_jump_s(chatter.until_s).unwrap_or(f64::INFINITY);
            let next_s = time_s.min(write_s).min(jump_s);
            if self.flown.averages() {
                self.average_duty(&mut chatter, next_s, next_s >= time_s, steps);
            } else {
                self.propagate_to(next_s, steps);
                chatter.until_s = next_s;
            }
        }
    }

    /// Where duties are written faster than a ball responds, adds each to `chatter` until all are propagated at once.
    fn average_duty(&mut self, chatter: &mut DutyBlock, next_s: f64, last: bool, known: &mut PropagationCache) {
        let middle_s = 0.5 * (chatter.until_s + next_s);
        chatter.add(self.actuator.commanded(self.model, middle_s.max(0.0)), next_s);
        let dt = next_s - self.time_s;
        if dt > 0.0 && (last || dt >= MAX_STEP_S) {
            let (commands, step_s) = chatter.as_few(self.flown);
            commands.for_each(|commanded| self.step(commanded, step_s, known));
            self.time_s = next_s;
            *chatter = DutyBlock::from(next_s);
        }
    }

    /// Propagates to `time_s`; the command does not jump before.
    fn propagate_to(&mut self, time_s: f64, known: &mut PropagationCache) {
        let (start, ahead) = (self.time_s, time_s - self.time_s);
        // Where one step does in any case, the rates need not be computed.
        let steps = if ahead <= MAX_STEP_S { 1.0 } else { steps_over(ahead, self.longest_step_s()) };
        let dt = ahead / steps;
        let drifts = Actuator::drifts(self.model);
        let mut commanded = self.actuator.commanded(self.model, start.max(0.0));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
        for step in 0..steps as u64 {
            if drifts {
                commanded = self.actuator.commanded(self.model, (start + (step as f64 + 0.5) * dt).max(0.0));
            }
            self.step(commanded, dt, known);
        }
        self.time_s = time_s;
    }

    /// The longest integration step from here, seconds.
    fn longest_step_s(&self) -> f64 {
        longest_step_s(motion_of(&self.state).fastest_rate_per_s(self.model, self.input()))
    }

    fn step(&mut self, commanded: f64, dt: f64, known: &mut PropagationCache) {
        self.commanded_mm_per_s2 = commanded;
        let motion = motion_of(&self.state);
        let step = Step::new(self.model, self.input(), dt, self.covariance[(1, 1)].max(0.0).sqrt());
        let mut next = None;
        let mut moved = || {
            let (after, transition) = step.moved(&self.active, &motion);
            next = Some(after);
            Propagation::of(&self.active, self.model, transition, dt)
        };
        let shared = if self.linear {
            known.propagation(dt, || Propagation::linear(&self.active, self.model, dt))
        } else {
            known.propagation(dt, &mut moved)
        };
        let own;
        let propagation = match shared {
            Some(shared) if self.linear => match self.slid(&step, &motion, shared) {
                Some((after, friction)) if friction.slope_per_s != 0.0 => {
                    next = Some(after);
                    own = shared.with_friction(&self.active, self.model, friction.slope_per_s, dt);
                    &own
                }
                Some((after, _)) => {
                    next = Some(after);
                    shared
                }
                None => {
                    own = moved();
                    &own
                }
            },
            Some(shared) => shared,
            None => {
                own = moved();
                &own
            }
        };
        let next = self.in_the_air(next).unwrap_or_else(|| vector(&step.after(&motion)));
        if let Some(back) = &mut self.back {
            back.go(&propagation.transition);
        }
        self.state = next;
        self.active.predict(&propagation.transition, &propagation.noise, &mut self.covariance);
        self.time_s += dt;
    }

    /// The state after a linear step and the friction during it. `None`: friction stops the ball.
    fn slid(&self, step: &Step<'_>, motion: &Motion, shared: &Propagation) -> Option<(State, Friction)> {
        let friction = step.friction(motion)?;
        let after = shared.moved(&self.active, &self.state, self.commanded_mm_per_s2, friction.mm_per_s2)?;
        step.slides(motion, &motion_of(&after)).then_some((after, friction))
    }

    /// The state after a step, where the step touches no end of the pipe. With friction the filter knows no ends.
    fn in_the_air(&self, next: Option<State>) -> Option<State> {
        if self.model.effects.friction().is_some() {
            return next;
        }
        let (bottom, top) = self.model.ends_mm();
        let between = |state: &State| bottom < state[0] && state[0] < top;
        next.filter(|next| between(&self.state) && between(next))
    }
}

/// The time of the reading of `row`, seconds since the start of the flight. `None`: there is no such row.
fn reading_time(model: &Model, writes: &[Write], row: usize) -> Option<f64> {
    let since_start_s = writes.get(row)?.time_s - writes.first()?.time_s;
    Some(since_start_s - model.effects.reading_delay_s())
}
