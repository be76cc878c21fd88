//! Fan lag: the rotor needs time to reach the speed it is told.
//!
//! ```text
//! dA/dt = (A_cmd − A) / τ      A, A_cmd: acceleration of the ball by the air about hover, mm/s²; τ in s
//! ```
//!
//! Assumes one τ for spin-up and coast-down; real fans coast down more slowly.
//! Source: linearised momentum balance of the rotor; the thesis, equation 3.1.1.12, and its model G_c with
//! τ = 1/3.896 s.

use crate::effect::{Effect, Entry, Param, Stage};
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
        params: &[Param { name: "time_constant_s", min: 0.0, max: 5.0, neutral: 0.0 }],
        sizes: &[&[0.05], &[0.2]],
        in_a_log: "the ball answers late to every change of duty, and oscillates at gains that the simulator calls safe",
        mend: "a lighter rotor or a fan with active braking; in the controller, more derivative action or less gain",
    };

    fn values(&self) -> Vec<f64> {
        vec![self.time_constant_s]
    }

    fn from_values(values: &[f64]) -> Self {
        Self { time_constant_s: values.first().copied().unwrap_or_default() }
    }
}

impl FanLag {
    /// Whether the lag does anything. Below a tenth of a millisecond it is shorter than anything else on the rig.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.time_constant_s >= 1e-4
    }

    /// dA/dt, mm/s³, of a fan that gives `acceleration` and is told to give `commanded`.
    #[must_use]
    pub fn rate(&self, commanded: f64, acceleration: f64) -> f64 {
        (commanded - acceleration) / self.time_constant_s
    }
}
