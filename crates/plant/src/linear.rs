//! The linear part of a model: what a design can use.
//!
//! ```text
//! gain, drag, height_dependent_flow.gradient, fan_lag (or the mean of spin_asymmetry's two), sensor_lag
//! delay = transport_delay + sensor_delay + stale_samples.hold/2      a held reading is half of its hold old on average
//! ```
//!
//! Every other effect bends, sticks, drifts or scatters, and is left out there. [`Model::slopes_at`] are the slopes of
//! the whole force at any height and duty: how far from hover the linear part holds.

use crate::acts::Conditions;
use crate::model::Model;
use control::design::Linear;

/// Steps of the central differences, in percent, mm/s and mm: far below what a flight covers, far above rounding.
const STEPS: [f64; 3] = [0.05, 1.0, 1.0];

/// The slopes of the acceleration of a ball at rest, about one height and duty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes {
    /// By the duty, with the fan settled, mm/s² per percent.
    pub gain_mm_per_s2_per_percent: f64,
    /// Against the velocity, 1/s.
    pub drag_per_s: f64,
    /// Against the height, 1/s².
    pub gradient_per_s2: f64,
}

impl Model {
    /// The linear plant about hover at mid-pipe.
    #[must_use]
    pub fn linear(&self) -> Linear {
        let mut plant = Linear::two_poles(self.gain_mm_per_s2_per_percent, self.drag_per_s);
        self.effects.linearise(&mut plant);
        plant
    }

    /// The slopes of the acceleration at this height and duty, of everything that bends it; friction, ends and what
    /// drifts are left out.
    #[must_use]
    pub fn slopes_at(&self, position_mm: f64, duty_percent: f64) -> Slopes {
        let acceleration = |duty: f64, velocity_mm_per_s: f64, position_mm: f64| {
            let commanded = self.commanded(duty);
            let settled = self.at_rest(position_mm, commanded);
            let conditions = Conditions {
                position_mm,
                velocity_mm_per_s,
                commanded_mm_per_s2: commanded,
                fan_mm_per_s2: commanded,
                own: settled.own,
                ..self.conditions()
            };
            self.effects.accelerated(commanded - self.drag_per_s * velocity_mm_per_s, &conditions)
        };
        let slope = |by: [f64; 3]| {
            let at = |sign: f64| acceleration(duty_percent + sign * by[0], sign * by[1], position_mm + sign * by[2]);
            (at(1.0) - at(-1.0)) / (2.0 * by.iter().sum::<f64>())
        };
        Slopes {
            gain_mm_per_s2_per_percent: slope([STEPS[0], 0.0, 0.0]),
            drag_per_s: -slope([0.0, STEPS[1], 0.0]),
            gradient_per_s2: -slope([0.0, 0.0, STEPS[2]]),
        }
    }

    /// The names of the effects that are on and that [`Model::linear`] leaves out.
    #[must_use]
    pub fn not_linear(&self) -> Vec<&'static str> {
        self.effects.present().iter().filter(|entry| !entry.acts.is_linear).map(|entry| entry.name).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::Model;
    use crate::effects::{
        DeadZone, Effects, FanLag, HeightDependentFlow, RelativeAirflow, SensorDelay, ThrustCurve, TransportDelay,
    };
    use crate::model::tests::thesis;

    #[test]
    fn delays_add_up_and_what_bends_is_named() {
        let model = Model {
            effects: Effects {
                transport_delay: Some(TransportDelay { delay_s: 0.03 }),
                sensor_delay: Some(SensorDelay { delay_s: 0.02 }),
                dead_zone: Some(DeadZone { lower_percent: -0.3, upper_percent: 0.3 }),
                fan_lag: Some(FanLag { time_constant_s: 0.257 }),
                ..Effects::default()
            },
            ..thesis()
        };
        assert!((model.linear().delay_s - 0.05).abs() < 1e-15);
        assert_eq!(model.not_linear(), ["dead_zone"]);
    }

    #[test]
    fn the_slopes_at_a_height_and_a_duty_are_the_closed_forms_of_the_effects_that_bend() {
        let (c, q, gradient) = (0.02, 1e-3, 0.5);
        let model = Model {
            effects: Effects {
                thrust_curve: Some(ThrustCurve { curvature_per_percent: c }),
                relative_airflow: Some(RelativeAirflow { inverse_speed_s_per_mm: q }),
                height_dependent_flow: Some(HeightDependentFlow {
                    gradient_per_s2: gradient,
                    centre_mm: None,
                    turn_mm: None,
                }),
                ..Effects::default()
            },
            ..thesis()
        };
        let (gain, drag) = (model.gain_mm_per_s2_per_percent, model.drag_per_s);
        for u in [-2.0, 0.0, 5.0] {
            let found = model.slopes_at(200.0, model.hover_duty_percent + u);
            let lift = gain * (u + c * u * u);
            let exact = [gain * (1.0 + 2.0 * c * u), (drag * drag + 2.0 * q * drag * lift).sqrt(), gradient];
            for (found, exact) in
                [found.gain_mm_per_s2_per_percent, found.drag_per_s, found.gradient_per_s2].iter().zip(exact)
            {
                assert!((found / exact - 1.0).abs() < 1e-6, "at {u} %: {found}, exact {exact}");
            }
        }
    }
}
