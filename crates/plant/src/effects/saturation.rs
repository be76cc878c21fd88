//! Saturation: the fan's force has limits.
//!
//! ```text
//! A_cmd' = min(max(A_cmd, lower), upper)      A_cmd: commanded acceleration about hover, mm/s²
//! ```
//!
//! The ends of the duty are limits too, but of the duty; these are of the force. Leaves out that the curve
//! rounds off towards its limits.
//! Source: the thesis, figure 3.2.5: about −800 and +1100 mm/s², where the table of its predistortion ends too.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, InColumn, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The commanded acceleration stays within limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saturation {
    /// Lower limit, mm/s², below 0.
    pub lower_mm_per_s2: f64,
    /// Upper limit, mm/s², above 0.
    pub upper_mm_per_s2: f64,
}

impl Effect for Saturation {
    const ENTRY: Entry = Entry {
        name: "saturation",
        stage: Stage::Actuator,
        params: &[
            Param { name: "lower_mm_per_s2", min: -1e6, max: -1.0, neutral: Neutral::At(-1e6), scale: Scale::Value },
            Param { name: "upper_mm_per_s2", min: 1.0, max: 1e6, neutral: Neutral::At(1e6), scale: Scale::Value },
        ],
        sizes: &[&[-800.0, 800.0], &[-400.0, 400.0]],
        start: Start::CommandedRange,
        in_columns: &[InColumn::InputByForce, InColumn::InputByForce],
        in_a_log: "above some duty the ball rises or falls no faster, and large steps overshoot while small ones do \
             not",
        mend: "keep the controller within the limits, with anti-windup and slower setpoints; or a stronger fan",
        similar: &[
            Similar {
                name: "quadratic_drag",
                distinguished_by: "with saturation the force is too small right after a large step; with drag only \
                     when the ball is fast",
            },
            Similar {
                name: "thrust_curve",
                distinguished_by: "steps within the limits fit the model; a curved force shows in every step, and more \
                     in larger ones",
            },
            Similar {
                name: "force_asymmetry",
                distinguished_by: "small steps up and down have the same gain. Fly pairs of steps of several sizes",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { limits: Some(Self::limited), ..Acts::NONE };

    values_in_order!(lower_mm_per_s2, upper_mm_per_s2);
}

impl Saturation {
    /// The acceleration that the fan can give of the `commanded` one, mm/s².
    #[must_use]
    pub fn limited(&self, commanded: f64) -> f64 {
        commanded.max(self.lower_mm_per_s2).min(self.upper_mm_per_s2)
    }
}

#[cfg(test)]
mod tests {
    use super::Saturation;

    #[test]
    fn the_limits_hold_and_everything_between_passes() {
        let saturation = Saturation { lower_mm_per_s2: -800.0, upper_mm_per_s2: 1100.0 };
        for (commanded, given) in [(-900.0, -800.0), (-799.0, -799.0), (0.0, 0.0), (1100.0, 1100.0), (9e4, 1100.0)] {
            assert_eq!(saturation.limited(commanded), given);
        }
    }
}
