//! The acceleration of the ball at one place, speed and duty, as a report draws it over one of them.

use crate::actuator::Actuator;
use crate::model::Model;
use crate::motion::{Input, Motion};

/// Where the ball is, how fast it moves, and under which duty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settled {
    /// The duty, which has acted for ever before, percent.
    pub duty_percent: f64,
    /// Height of the ball, mm.
    pub position_mm: f64,
    /// Velocity of the ball, mm/s, upward.
    pub velocity_mm_per_s: f64,
    /// Time since the start of the flight, seconds.
    pub time_s: f64,
}

impl Model {
    /// The acceleration of the ball there, mm/s², but for what is random. A ball at rest has no friction.
    #[must_use]
    pub fn settled_acceleration(&self, at: Settled) -> f64 {
        let commanded = Actuator::new(self, at.duty_percent).commanded(self, at.time_s);
        let input = Input { commanded_mm_per_s2: commanded, time_s: at.time_s, setpoint_mm: None };
        let motion = Motion { velocity_mm_per_s: at.velocity_mm_per_s, ..self.at_rest_under(at.position_mm, input) };
        let conditions = self.conditions_of(&motion, input);
        let friction = self.effects.friction().filter(|_| at.velocity_mm_per_s != 0.0);
        let friction = friction.map_or(0.0, |friction| friction.acceleration(at.velocity_mm_per_s.signum()));
        self.effects.accelerated(commanded - self.drag_per_s * at.velocity_mm_per_s, &conditions) + friction
    }
}

#[cfg(test)]
mod tests {
    use super::Settled;
    use crate::model::tests::thesis;

    #[test]
    fn every_term_of_the_equation_of_motion_is_there() {
        let mut model = thesis();
        let (gain, hover, drag) = (model.gain_mm_per_s2_per_percent, model.hover_duty_percent, model.drag_per_s);
        for (name, values) in [
            ("dead_zone", &[-0.2, 0.3][..]),
            ("wall_friction", &[40.0]),
            ("quadratic_drag", &[0.002]),
            ("height_dependent_flow", &[1.5]),
        ] {
            assert!(model.effects.set(name, values), "{name}");
        }
        let at = Settled { duty_percent: hover + 1.3, position_mm: 300.0, velocity_mm_per_s: -50.0, time_s: 4.0 };
        let expected = gain * 1.0 + drag * 50.0 + 0.002 * 2500.0 - 1.5 * (300.0 - 0.5 * 583.0) + 40.0;
        assert!((model.settled_acceleration(at) - expected).abs() < 1e-9, "{}", model.settled_acceleration(at));
        let still = Settled { velocity_mm_per_s: 0.0, position_mm: 0.5 * 583.0, duty_percent: hover, ..at };
        assert!(model.settled_acceleration(still).abs() < 1e-9);
    }
}
