//! Fan lag: the rotor needs time to reach the speed it is told.
//!
//! ```text
//! dA/dt = (A_cmd − A) / τ      A, A_cmd: acceleration of the ball by the air about hover, mm/s²; τ in s
//! ```
//!
//! Assumes one τ for spin-up and coast-down; `spin_asymmetry` has two.
//! Source: linearised momentum balance of the rotor; the thesis, equation 3.1.1.12, and its model G_c with
//! τ = 1/3.896 s.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Form, Neutral, Param, Scale, Similar, Stage, values_in_order};
use crate::effects::Effects;
use crate::lag::decay;
use serde::{Deserialize, Serialize};

/// The force follows the commanded force as a first-order lag.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FanLag {
    /// Time constant τ, seconds.
    pub time_constant_s: f64,
}

impl Effect for FanLag {
    const ENTRY: Entry = Entry {
        name: "fan_lag",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param {
            name: "time_constant_s",
            min: 0.0,
            max: 5.0,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.05], &[0.2]],
        form: Form::Approximate,
        twins: &["sensor_lag"],
        in_a_log: "the ball responds late to every change of duty, and oscillates at gains at which the simulator is \
             stable",
        mend_elsewhere: "a faster actuator or amplifier; more derivative action or less gain in the controller",
        mend: "a lighter rotor or a fan with active braking; more derivative action or less gain in the controller",
        similar: &[
            Similar {
                name: "transport_delay",
                distinguished_by: "with a lag the force begins right after a step of duty and grows; with a delay it \
                     begins late and at its full size. Fly steps of duty",
            },
            Similar {
                name: "sensor_lag",
                distinguished_by: "duty and position hardly separate them. With a fan lag a recorded fan speed lags \
                     the duty, and a second sensor is late as well",
            },
            Similar {
                name: "spin_asymmetry",
                distinguished_by: "with a plain lag the responses to a rise and to a fall of duty are equally slow. \
                     Fly equal steps up and down",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        follows: Some(Self::after),
        is_linear: Some(|_| true),
        lag_s: Some(|lag| [lag.time_constant_s; 2]),
        linearise: Some(|lag, plant| plant.fan_lag_s = lag.time_constant_s),
        ..Acts::NONE
    };

    values_in_order!(time_constant_s);
}

impl FanLag {
    /// A, mm/s², `dt_s` after it was `acceleration`, under a constant command.
    #[must_use]
    pub fn after(&self, commanded: f64, acceleration: f64, dt_s: f64) -> f64 {
        commanded + (acceleration - commanded) * decay(self.time_constant_s, dt_s)
    }
}

impl Effects {
    /// The first-order lag of the fan, seconds; `None`: there is none.
    #[must_use]
    pub fn fan_lag_s(&self) -> Option<f64> {
        self.fan_lag.map(|lag| lag.time_constant_s)
    }

    /// The same effects with a fan of this first-order lag, or of none, in the place of whatever inertia it had.
    #[must_use]
    pub fn with_fan_lag(&self, time_constant_s: Option<f64>) -> Self {
        let mut effects = self.clone();
        for entry in self.present().iter().filter(|entry| Self::exclude_each_other(entry.name, FanLag::ENTRY.name)) {
            effects.remove(entry.name);
        }
        effects.fan_lag = time_constant_s.map(|time_constant_s| FanLag { time_constant_s });
        effects
    }
}

#[cfg(test)]
mod tests {
    use super::FanLag;

    #[test]
    fn a_step_of_the_command_has_covered_63_percent_after_one_time_constant() {
        let lag = FanLag { time_constant_s: 0.3 };
        let after = (0..300).fold(0.0, |a, _| lag.after(100.0, a, 0.001));
        let exact = 100.0 * (1.0 - (-1.0_f64).exp());
        assert!((after - exact).abs() < 1e-10, "{after} mm/s², exact {exact} mm/s²");
    }
}
