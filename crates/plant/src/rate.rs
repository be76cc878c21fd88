//! How fast a motion can change: what limits the step of its integration.
//!
//! ```text
//! rate = max( |∂v̇/∂v|, √|∂v̇/∂y|, |∂q̇/∂q|, 1/τ )      q: own states    τ: lags, correlation time of turbulence
//! ```
//!
//! These are bounds of the eigenvalues of the linearised motion, up to a factor of about 2: an RK4 step of h errs by
//! about (h·rate)⁵/120.
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, section II.1.

use crate::flow::{Drive, Flow};
use crate::model::Model;
use crate::motion::{Input, Motion, OWN_STATES};

impl Motion {
    /// The fastest rate of the motion from here, 1/s. `None`: a written effect changes with the time itself, at a rate
    /// that does not follow from the state.
    #[must_use]
    pub fn fastest_rate_per_s(&self, model: &Model, input: Input) -> Option<f64> {
        if model.effects.written.moves_with_time() {
            return None;
        }
        let flow = Flow { model, input };
        let fan = self.fan_mm_per_s2;
        let drive = Drive { force: fan + self.turbulence_mm_per_s2, fan, time_s: input.time_s };
        let conditions = flow.conditions([self.position_mm, self.velocity_mm_per_s], self.own, drive);
        let (_, [by_position, by_velocity, ..]) = flow.acceleration_with_slopes(0.0, &conditions);
        let own = flow.own_rates_with_slopes(&conditions);
        let of_own = (0..OWN_STATES).map(|state| own[state].1[3 + state].abs());
        let of_ball =
            [(model.drag_per_s - by_velocity).abs(), by_position.abs().sqrt(), model.effects.fastest_lag_per_s()];
        Some(of_own.chain(of_ball).fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::Effects;
    use crate::model::Model;
    use crate::model::tests::thesis;
    use crate::motion::{Input, Motion};

    fn rate(effects: &[(&str, &[f64])], velocity_mm_per_s: f64) -> f64 {
        let mut model = Model { drag_per_s: 4.0, effects: Effects::default(), ..thesis() };
        assert!(effects.iter().all(|(name, values)| model.effects.set(name, values)));
        let motion = Motion { velocity_mm_per_s, ..Motion::at_rest(300.0, 0.0) };
        motion.fastest_rate_per_s(&model, Input::of(0.0)).unwrap()
    }

    #[test]
    fn the_fastest_rate_is_that_of_the_drag_the_spring_or_the_shortest_lag() {
        assert_eq!(rate(&[], 0.0), 4.0);
        assert_eq!(rate(&[("quadratic_drag", &[0.01])], -300.0), 10.0);
        assert_eq!(rate(&[("height_dependent_flow", &[400.0])], 0.0), 20.0);
        assert_eq!(rate(&[("fan_lag", &[0.5]), ("sensor_lag", &[0.1])], 0.0), 10.0);
        assert_eq!(rate(&[("turbulence", &[100.0, 0.05])], 0.0), 20.0);
    }
}
