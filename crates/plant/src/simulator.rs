//! A rig that flies by a model and its noise, on its own time.
//!
//! ```text
//! each step: mean motion (see `Motion`), then
//!   v ← v + √(PSD·dt)·n₁            white acceleration
//!   w ← w + δ, v ← v + δ·dt/2       turbulence: δ = σ·√(1 − ρ²)·n₂ came in during the step      n: standard normal
//! ```
//!
//! Steps are 1 ms at most and end where the command jumps or a reading is taken; a command that drifts is taken
//! in the middle of the step. Each source of chance draws from its own stream, so that reading more often, or
//! switching one on, leaves the others' numbers alone.

use crate::actuator::Actuator;
use crate::model::Model;
use crate::motion::{Input, Motion};
use crate::normal::Normal;
use crate::sensor::Sensor;
use libm::{ceil, sqrt};

/// The longest integration step, seconds: a hundredth of the shortest time constant that a rig is likely to have.
const MAX_STEP_S: f64 = 0.001;
/// Stream numbers of the motion's random numbers; the sensor has 1 and 3.
const PROCESS_STREAM: u64 = 0;
const TURBULENCE_STREAM: u64 = 2;

/// A simulated rig.
#[derive(Clone, Debug)]
pub struct Simulator {
    model: Model,
    motion: Motion,
    /// The command in force, and the rig's own time.
    input: Input,
    actuator: Actuator,
    sensor: Sensor,
    process: Normal,
    turbulence: Normal,
}

impl Simulator {
    /// A rig whose fan has been off, with the ball at the bottom of its way, at time 0.
    #[must_use]
    pub fn new(model: Model, seed: u64) -> Self {
        let commanded = model.commanded(0.0);
        let mut motion = model.at_rest(model.ends_mm().0, commanded);
        let mut turbulence = Normal::new(seed, TURBULENCE_STREAM);
        if let Some(effect) = model.effects.coloured_force() {
            motion.turbulence_mm_per_s2 = effect.sigma_mm_per_s2 * turbulence.draw();
        }
        let mut sensor = Sensor::new(seed);
        sensor.follow(&model, &motion, Input::of(commanded));
        Self {
            motion,
            input: Input::of(commanded),
            actuator: Actuator::new(&model, 0.0),
            sensor,
            process: Normal::new(seed, PROCESS_STREAM),
            turbulence,
            model,
        }
    }

    /// The rig's own time, seconds.
    #[must_use]
    pub const fn time_s(&self) -> f64 {
        self.input.time_s
    }

    /// Where the ball really is.
    #[must_use]
    pub const fn motion(&self) -> Motion {
        self.motion
    }

    /// The duty from now on, percent.
    pub fn drive(&mut self, duty_percent: f64) {
        self.actuator.write(&self.model, self.input.time_s, duty_percent);
    }

    /// Sets the setpoint in force, mm, for effects that depend on it; `None` keeps the last one.
    pub fn set_setpoint(&mut self, setpoint_mm: Option<f64>) {
        self.actuator.set_setpoint(setpoint_mm);
    }

    /// Flies on to `time_s`. A time that has passed changes nothing.
    pub fn advance_to(&mut self, time_s: f64) {
        while self.input.time_s < time_s {
            let until = self.actuator.next_jump_s(self.input.time_s).map_or(time_s, |jump_s| jump_s.min(time_s));
            self.fly_to(until);
        }
    }

    /// Measures the position now, mm.
    pub fn reading_mm(&mut self) -> f64 {
        self.sensor.reading(&self.model, self.input.time_s, self.model.seen_mm(&self.motion, self.input))
    }

    /// Flies on to `time_s`, until which the command does not jump.
    fn fly_to(&mut self, time_s: f64) {
        let start = self.input.time_s;
        let ahead = time_s - start;
        let steps = ceil(ahead / MAX_STEP_S);
        let dt = ahead / steps;
        let white = sqrt(self.model.noise.acceleration_psd_mm2_per_s3 * dt);
        let coloured = self.model.effects.coloured_force().map(|turbulence| turbulence.kick(dt));
        let (drifts, setpoint_mm) = (Actuator::drifts(&self.model), self.actuator.setpoint_mm());
        let mut commanded = self.actuator.commanded(&self.model, start);
        let mut motion = self.motion;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
        for step in 1..=steps as u64 {
            #[expect(clippy::cast_precision_loss, reason = "far below 2⁵³ steps")]
            let end = start + step as f64 * dt;
            if drifts {
                commanded = self.actuator.commanded(&self.model, end - dt / 2.0);
            }
            let input = Input { commanded_mm_per_s2: commanded, time_s: end - dt, setpoint_mm };
            motion = motion.step(&self.model, input, dt);
            self.kick(&mut motion, white, coloured, dt);
            self.sensor.follow(&self.model, &motion, Input { time_s: end, ..input });
        }
        (self.motion, self.input) = (motion, Input { commanded_mm_per_s2: commanded, time_s, setpoint_mm });
    }

    /// What a step adds at random.
    #[inline(always)]
    fn kick(&mut self, motion: &mut Motion, white: f64, coloured: Option<f64>, dt_s: f64) {
        if let Some(coloured) = coloured {
            let push = coloured * self.turbulence.draw();
            motion.turbulence_mm_per_s2 += push;
            // A ball that is held at rest is not pushed off by what it will feel in the next step anyway.
            if motion.velocity_mm_per_s != 0.0 {
                motion.velocity_mm_per_s += push * dt_s / 2.0;
            }
        }
        if white > 0.0 {
            motion.velocity_mm_per_s += white * self.process.draw();
        }
    }
}

#[cfg(test)]
mod tests;
