//! Wall friction: the ball rubs against the pipe, and sticks when it rests.
//!
//! ```text
//! v ≠ 0:  a = −f·sign(v)                        a, f in mm/s²
//! v = 0:  a = 0 while |net| ≤ f, else net − f·sign(net)      net: everything else that accelerates the ball
//! ```
//!
//! Coulomb's law with one f for sticking and sliding. Leaves out that the ball also rolls.
//! Source: Karnopp, *Computer Simulation of Stick-Slip Friction in Mechanical Dynamic Systems*, J. Dyn. Sys.,
//! Meas., Control 107 (1985); without its band of low speed, because the instant of standstill is solved for.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// Dry friction against the pipe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallFriction {
    /// f: what friction takes from the acceleration, mm/s².
    pub acceleration_mm_per_s2: f64,
}

impl Effect for WallFriction {
    const ENTRY: Entry = Entry {
        name: "wall_friction",
        stage: Stage::Ball,
        params: &[Param {
            name: "acceleration_mm_per_s2",
            min: 0.0,
            max: 1e6,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[20.0], &[60.0]],
        start: Start::AgainstMotion(&[&[8.0], &[20.0], &[50.0]]),
        in_a_log: "the ball sticks while the duty changes, then breaks away; it stops at reversals",
        mend_elsewhere: "clean, align and lubricate guides and bearings; dither the input",
        mend: "set the pipe vertical, clean pipe and ball, ground them against static charge; dither the duty",
        similar: &[
            Similar {
                name: "dead_zone",
                distinguished_by: "friction holds a resting ball and stops a moving one; in a dead zone it drifts on. \
                     Fly a slow ramp through hover",
            },
            Similar {
                name: "hysteresis",
                distinguished_by: "friction depends on the motion of the ball: while the ball moves on, a reversal of \
                     the duty acts at once; with hysteresis it does not",
            },
            Similar {
                name: "quadratic_drag",
                distinguished_by: "friction affects slow motion most; drag hardly affects it. Fly a slow ramp and \
                     large steps",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { friction: Some(|friction| *friction), ..Acts::NONE };

    values_in_order!(acceleration_mm_per_s2);
}

impl WallFriction {
    /// Whether a ball at rest stays there under the acceleration `net`, mm/s².
    #[must_use]
    pub fn holds(&self, net: f64) -> bool {
        net.abs() <= self.acceleration_mm_per_s2
    }

    /// The acceleration that friction adds to a ball that slides `direction` (+1 up, −1 down), mm/s².
    #[must_use]
    pub fn acceleration(&self, direction: f64) -> f64 {
        -self.acceleration_mm_per_s2 * direction
    }
}
