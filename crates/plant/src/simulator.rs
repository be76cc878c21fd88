//! A rig that flies by a model and its noise, on its own time.
//!
//! ```text
//! each step: RK4, then v ← v + √(PSD·dt)·n₁          reading = y + σ·n₂          n: standard normal
//! ```
//!
//! Steps are 1 ms at most and end where the duty changes or a reading is taken. Process and sensor draw from
//! their own streams, so that reading more often does not change the flight's noise in kind.

use crate::model::Model;
use crate::motion::Motion;
use crate::normal::Normal;
use libm::{ceil, sqrt};

/// The longest integration step, seconds: a hundredth of the shortest time constant that a rig is likely to have.
const MAX_STEP_S: f64 = 0.001;

/// A simulated rig.
#[derive(Clone, Debug)]
pub struct Simulator {
    model: Model,
    motion: Motion,
    time_s: f64,
    commanded: f64,
    process: Normal,
    sensor: Normal,
}

impl Simulator {
    /// A rig with its fan off and the ball at the bottom of the pipe, at time 0.
    #[must_use]
    pub fn new(model: Model, seed: u64) -> Self {
        let commanded = model.commanded(0.0);
        Self {
            motion: Motion::at_rest(0.0, commanded),
            time_s: 0.0,
            commanded,
            process: Normal::new(seed, 0),
            sensor: Normal::new(seed, 1),
            model,
        }
    }

    /// The rig's own time, seconds.
    #[must_use]
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Where the ball really is.
    #[must_use]
    pub const fn motion(&self) -> Motion {
        self.motion
    }

    /// The duty from now on, percent.
    pub fn drive(&mut self, duty_percent: f64) {
        self.commanded = self.model.commanded(duty_percent);
    }

    /// Flies on to `time_s`. A time that has passed changes nothing.
    pub fn advance_to(&mut self, time_s: f64) {
        let ahead = time_s - self.time_s;
        if ahead <= 0.0 {
            return;
        }
        let steps = ceil(ahead / self.model.longest_step_s(MAX_STEP_S));
        let dt = ahead / steps;
        let kick = sqrt(self.model.noise.acceleration_psd_mm2_per_s3 * dt);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
        for _ in 0..steps as u64 {
            self.motion = self.motion.step(&self.model, self.commanded, dt);
            self.motion.velocity_mm_per_s += kick * self.process.draw();
        }
        self.time_s = time_s;
    }

    /// Measures the position now, mm, with the sensor's noise and without its rounding.
    pub fn reading_mm(&mut self) -> f64 {
        self.motion.position_mm + self.model.noise.sensor_mm * self.sensor.draw()
    }
}

#[cfg(test)]
mod tests {
    use super::Simulator;
    use crate::effects::Effects;
    use crate::model::{Model, Noise, tests::thesis};

    #[test]
    fn one_seed_gives_one_flight_bit_for_bit_and_another_seed_another() {
        let fly = |seed| {
            let mut rig = Simulator::new(thesis(), seed);
            rig.drive(22.0);
            (1..200)
                .map(|k| {
                    rig.advance_to(0.02 * f64::from(k));
                    rig.reading_mm()
                })
                .collect::<Vec<f64>>()
        };
        assert_eq!(fly(3), fly(3));
        assert_ne!(fly(3), fly(4));
    }

    #[test]
    fn white_acceleration_grows_the_variance_of_the_velocity_as_configured() {
        // Without drag the velocity is a random walk: variance PSD·t.
        let noise = Noise { sensor_mm: 0.0, acceleration_psd_mm2_per_s3: 360.0 };
        let model = Model { drag_per_s: 0.0, pipe_length_mm: 1e6, noise, effects: Effects::default(), ..thesis() };
        let runs: u32 = 2000;
        let sum: f64 = (0..runs)
            .map(|seed| {
                let mut rig = Simulator::new(model.clone(), u64::from(seed));
                rig.motion.position_mm = 5e5;
                rig.drive(model.hover_duty_percent);
                rig.advance_to(0.05);
                rig.motion().velocity_mm_per_s.powi(2)
            })
            .sum();
        let variance = sum / f64::from(runs);
        let exact = 360.0 * 0.05;
        // Five standard errors of a variance from 2000 runs.
        assert!((variance - exact).abs() < 5.0 * exact * (2.0 / f64::from(runs)).sqrt(), "{variance}, exact {exact}");
    }

    #[test]
    fn readings_scatter_by_the_configured_noise() {
        let noise = Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 0.0 };
        let mut rig = Simulator::new(Model { noise, ..thesis() }, 11);
        let n = 20_000;
        let variance = (0..n).map(|_| rig.reading_mm().powi(2)).sum::<f64>() / f64::from(n);
        assert!((variance.sqrt() - 2.5).abs() < 0.07, "σ = {} mm", variance.sqrt());
    }
}
