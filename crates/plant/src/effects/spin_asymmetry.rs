//! Spin asymmetry: the fan spins up faster than it coasts down.
//!
//! ```text
//! dA/dt = (A_cmd − A) / τ      τ = up where A_cmd > A, else down; A, A_cmd in mm/s², τ in s
//! ```
//!
//! With up = down it is `fan_lag`, which is why a config may hold only one of the two. Leaves out that both
//! times depend on the speed.
//! Source: motor torque spins the rotor up, only drag slows it down.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, values_in_order};
use crate::lag::decay;
use serde::{Deserialize, Serialize};

/// The force follows the commanded force with one lag on the way up and another on the way down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpinAsymmetry {
    /// Time constant while the force grows, seconds.
    pub up_s: f64,
    /// Time constant while the force falls, seconds.
    pub down_s: f64,
}

impl Effect for SpinAsymmetry {
    const ENTRY: Entry = Entry {
        name: "spin_asymmetry",
        stage: Stage::Actuator,
        article: "a ",
        params: &[
            Param { name: "up_s", min: 0.0, max: 5.0, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "down_s", min: 0.0, max: 5.0, neutral: Neutral::At(0.0), scale: Scale::Value },
        ],
        sizes: &[&[0.1, 0.25], &[0.25, 0.1]],
        contains: Some("fan_lag"),
        shown_at: Some(&[0.15, 0.40]),
        in_a_log: "the ball responds to a change of duty in one direction sooner than in the other, and floats higher \
             or lower while the duty oscillates fast about hover",
        mend_elsewhere: "an amplifier that drives and brakes alike; a lower gain for one direction",
        mend: "a driver that brakes the fan (four-quadrant, or speed control by the tachometer); a lower gain for \
             downward moves",
        similar: &[
            Similar {
                name: "fan_lag",
                distinguished_by: "the response to a fall of duty is slower than to a rise; here both are equal. Fly \
                     equal steps up and down; a fast square wave about hover lifts the ball only with spin asymmetry",
            },
            Similar {
                name: "force_asymmetry",
                distinguished_by: "the final forces of equal steps up and down are equal. Hold each step for several \
                     time constants of the fan",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        follows: Some(Self::after),
        lag_s: Some(|spin| [spin.up_s, spin.down_s]),
        linearise: Some(|spin, plant| plant.fan_lag_s = (spin.up_s + spin.down_s) / 2.0),
        ..Acts::NONE
    };

    values_in_order!(up_s, down_s);
}

impl SpinAsymmetry {
    /// A, mm/s², `dt_s` after it was `acceleration`, under a constant command, which it never crosses.
    #[must_use]
    pub fn after(&self, commanded: f64, acceleration: f64, dt_s: f64) -> f64 {
        let time_constant_s = if commanded > acceleration { self.up_s } else { self.down_s };
        commanded + (acceleration - commanded) * decay(time_constant_s, dt_s)
    }
}

#[cfg(test)]
mod tests {
    use super::SpinAsymmetry;

    #[test]
    fn each_direction_has_its_own_time_constant() {
        let spin = SpinAsymmetry { up_s: 0.1, down_s: 0.4 };
        let (up, down) = (spin.after(100.0, 0.0, 0.1), spin.after(0.0, 100.0, 0.4));
        assert!((up - 100.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-12, "{up}");
        assert!((down - 100.0 * (-1.0_f64).exp()).abs() < 1e-12, "{down}");
    }
}
