//! The rotor of the fan: how fast it turns, in percent of the duty that would keep it at that speed.
//!
//! ```text
//! duty(t − delay) → as the fan takes it = u      dw/dt = (u − w)/τ      τ: inertia of the fan
//! ```
//!
//! Effects that act before hover is subtracted, and the inertia of the fan, change the rotor's speed; the others act
//! between rotor and force.
//! Leaves out that a real fan's speed is not exactly proportional to its duty.

use crate::actuator::Actuator;
use crate::model::Model;

/// A rotor along its duty.
#[derive(Clone, Debug)]
pub struct Rotor {
    /// A model whose command is the duty that reaches the rotor, percent.
    model: Model,
    actuator: Actuator,
    now_s: f64,
    speed_percent: f64,
}

impl Rotor {
    /// The rotor of `model` at time 0, which has followed `duty_percent` for long.
    #[must_use]
    pub fn new(model: &Model, duty_percent: f64) -> Self {
        let effects = model.effects.of_rotor();
        let model = Model { gain_mm_per_s2_per_percent: 1.0, hover_duty_percent: 0.0, effects, ..model.clone() };
        Self { actuator: Actuator::new(&model, duty_percent), model, now_s: 0.0, speed_percent: duty_percent }
    }

    /// The duty from `time_s` on, percent.
    pub fn write(&mut self, time_s: f64, duty_percent: f64) {
        self.actuator.write(&self.model, time_s, duty_percent);
    }

    /// Turns on to `time_s`. A time that has passed changes nothing.
    pub fn advance_to(&mut self, time_s: f64) {
        while self.now_s < time_s {
            let until_s = self.actuator.next_jump_s(self.now_s).map_or(time_s, |jump_s| jump_s.min(time_s));
            let commanded = self.actuator.commanded(&self.model, self.now_s);
            self.speed_percent = self.followed(commanded, until_s - self.now_s);
            self.now_s = until_s;
        }
    }

    /// How fast it turns, percent of duty.
    #[must_use]
    pub const fn speed_percent(&self) -> f64 {
        self.speed_percent
    }

    /// The speed after `dt_s` of a constant command.
    fn followed(&self, commanded: f64, dt_s: f64) -> f64 {
        self.model.effects.fan(commanded, self.speed_percent, dt_s)
    }
}

#[cfg(test)]
mod tests {
    use super::Rotor;
    use crate::effects::{DeadZone, FanLag, TransportDelay};
    use crate::model::tests::thesis;
    use crate::{Effects, Model};

    #[test]
    fn it_follows_the_duty_with_the_fans_delay_and_lag_and_with_no_effect_of_the_force() {
        let effects = Effects {
            transport_delay: Some(TransportDelay { delay_s: 0.1 }),
            fan_lag: Some(FanLag { time_constant_s: 0.25 }),
            dead_zone: Some(DeadZone { lower_percent: -5.0, upper_percent: 5.0 }),
            ..Effects::default()
        };
        let model = Model { effects, ..thesis() };
        let mut rotor = Rotor::new(&model, 10.0);
        rotor.write(0.0, 20.0);
        rotor.advance_to(0.1);
        assert_eq!(rotor.speed_percent(), 10.0);
        rotor.advance_to(0.35);
        let exact = 20.0 - 10.0 * (-1.0_f64).exp();
        assert!((rotor.speed_percent() - exact).abs() < 1e-12, "{} %, exact {exact} %", rotor.speed_percent());
    }
}
