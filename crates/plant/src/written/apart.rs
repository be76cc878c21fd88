//! A written effect apart from any model, at values of its own: for a search over its values.

use super::definition::Definition;
use super::scope::{self, MOST_PARAMETERS};
use crate::acts::Conditions;
use crate::effect::Stage;
use crate::motion::OWN_STATES;
use crate::rk4;

impl Definition {
    /// What it adds with these values of its parameters, which are in the order of its entry: percent of duty in the
    /// actuator, mm/s² in the air and at the ball, mm in the sensor.
    #[must_use]
    pub fn adds_with(&self, values: &[f64], conditions: &Conditions) -> f64 {
        let parameters = padded(values);
        if self.stage() != Stage::Actuator {
            return self.adds(&scope::of_force(conditions, &parameters));
        }
        let u = conditions.commanded_mm_per_s2 / conditions.gain_mm_per_s2_per_percent;
        let at = [conditions.hover_duty_percent + u, conditions.time_s, conditions.setpoint_mm];
        self.adds(&scope::of_duty(u, at, &parameters))
    }

    /// Its own states where these conditions have lasted for ever.
    #[must_use]
    pub fn settled_with(&self, values: &[f64], conditions: &Conditions) -> [f64; OWN_STATES] {
        if self.states() == 0 {
            return [0.0; OWN_STATES];
        }
        self.start(&scope::of_force(conditions, &padded(values)))
    }

    /// Its own states, those of `conditions`, after so many seconds under these conditions.
    #[must_use]
    pub fn states_with(&self, values: &[f64], conditions: &Conditions, dt_s: f64) -> [f64; OWN_STATES] {
        if self.states() == 0 {
            return conditions.own;
        }
        let parameters = padded(values);
        let rate = |own: &[f64; OWN_STATES], ()| {
            self.rates(&scope::of_force(&Conditions { own: *own, ..*conditions }, &parameters))
        };
        rk4::step(rate, &conditions.own, [(); 3], dt_s)
    }
}

/// The values in their order; what is beyond them is 0.
fn padded(values: &[f64]) -> [f64; MOST_PARAMETERS] {
    std::array::from_fn(|index| values.get(index).copied().unwrap_or(0.0))
}
