//! Quadratic drag: the air brakes a fast ball more than in proportion.
//!
//! ```text
//! a = −c·v·|v|      a in mm/s², v in mm/s, c in 1/mm
//! ```
//!
//! On top of the linear drag about hover. Leaves out that the drag is really of the speed relative to the air,
//! of which the linear drag is the first term.
//! Source: the thesis, equation 3.1.1.3, the square of its relative speed.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, values_in_order};
use serde::{Deserialize, Serialize};

/// Drag that grows with the square of the speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuadraticDrag {
    /// c: deceleration per squared speed, 1/mm.
    pub coefficient_per_mm: f64,
}

impl Effect for QuadraticDrag {
    const ENTRY: Entry = Entry {
        name: "quadratic_drag",
        stage: Stage::Ball,
        params: &[Param {
            name: "coefficient_per_mm",
            min: 0.0,
            max: 0.05,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.002], &[0.006]],
        in_a_log: "slow motion fits the model; fast motion has more drag than in the simulator",
        mend_elsewhere: "none, it is the drag of the medium. Put it into the simulator, or limit the speed of the \
            setpoint",
        mend: "none, it is the physics of a sphere. Put it into the simulator, or limit the speed of the setpoint",
        similar: &[
            Similar {
                name: "saturation",
                distinguished_by: "the residual force grows with the speed, also at small duties. Compare slow and \
                     fast motion at the same duty",
            },
            Similar {
                name: "wall_friction",
                distinguished_by: "drag hardly acts on a slow ball and never holds it; friction is the same at any \
                     speed. Fly a slow ramp and large steps",
            },
            Similar {
                name: "thrust_curve",
                distinguished_by: "drag acts equally in both directions and only when the ball is fast; a thrust curve \
                     acts right after a step. Fly steps up and down",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        force: Some(|drag, now| drag.acceleration(now.velocity_mm_per_s)),
        force_slopes: Some(|drag, now| [0.0, -2.0 * drag.coefficient_per_mm * now.velocity_mm_per_s.abs(), 0.0]),
        ..Acts::NONE
    };

    values_in_order!(coefficient_per_mm);
}

impl QuadraticDrag {
    /// The acceleration that the drag adds, mm/s².
    #[must_use]
    pub fn acceleration(&self, velocity_mm_per_s: f64) -> f64 {
        -self.coefficient_per_mm * velocity_mm_per_s * velocity_mm_per_s.abs()
    }
}
