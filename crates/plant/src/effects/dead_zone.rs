//! Dead zone: near hover the fan's force does not respond to the duty.
//!
//! ```text
//! u' = u − upper    u > upper           u, u' in percent of duty about hover
//! u' = 0            lower ≤ u ≤ upper
//! u' = u − lower    u < lower
//! ```
//!
//! Leaves out that a real zone has soft edges. Moving both edges together is the same as moving hover, so
//! that only the width is certain from a log.
//! Source: the thesis, section 3.2.1, whose rig has 21.1 to 21.7 % about a hover of 21.4 %.

use crate::acts::Acts;
use crate::effect::{Difference, Effect, Entry, InColumn, Neutral, Param, Scale, Similar, Stage, values_in_order};
use serde::{Deserialize, Serialize};

/// No force between the edges; outside, force is measured from the edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeadZone {
    /// Lower edge, percent of duty relative to hover, at most 0.
    pub lower_percent: f64,
    /// Upper edge, percent of duty relative to hover, at least 0.
    pub upper_percent: f64,
}

impl Effect for DeadZone {
    const ENTRY: Entry = Entry {
        name: "dead_zone",
        stage: Stage::Actuator,
        article: "a ",
        params: &[
            Param { name: "lower_percent", min: -100.0, max: 0.0, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "upper_percent", min: 0.0, max: 100.0, neutral: Neutral::At(0.0), scale: Scale::Value },
        ],
        sizes: &[&[-0.15, 0.15], &[-0.4, 0.4]],
        difference: Some(Difference { name: "width", key: "width_percent", of: [0, 1] }),
        represents_its_stage: Some(0),
        in_columns: &[InColumn::Input, InColumn::Input],
        in_a_log: "the ball drifts while the duty wanders between two edges about hover, and the loop oscillates \
             slowly (limit cycle)",
        mend_elsewhere: "let the controller add the edge on the side of its command (inverse of the dead zone), or \
             take an actuator and driver that answer to smaller inputs",
        mend: "correct it in [compensation.dead_zone] with the same two numbers, or use a fan and driver with finer \
             steps",
        similar: &[
            Similar {
                name: "wall_friction",
                distinguished_by: "inside a dead zone a moving ball drifts on; friction stops it and holds it. Fly a \
                     slow ramp of duty through hover",
            },
            Similar {
                name: "hysteresis",
                distinguished_by: "a dead zone stays at hover, so that slow ramps up and down give the same curve; \
                     with hysteresis the flat part moves with each reversal",
            },
            Similar {
                name: "duty_quantisation",
                distinguished_by: "a dead zone is one flat part, at hover; quantisation repeats at every step. Fly a \
                     slow ramp over several percent",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { on_command: Some(Self::effective), ..Acts::NONE };

    values_in_order!(lower_percent, upper_percent);
}

impl DeadZone {
    /// The effective duty about hover, percent.
    #[must_use]
    pub fn effective(&self, about_hover_percent: f64) -> f64 {
        (about_hover_percent - self.upper_percent).max(0.0) + (about_hover_percent - self.lower_percent).min(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::DeadZone;

    #[test]
    fn force_begins_at_the_edges_without_a_jump() {
        let zone = DeadZone { lower_percent: -0.3, upper_percent: 0.2 };
        for (u, effective) in [(-1.3, -1.0), (-0.3, 0.0), (-0.1, 0.0), (0.0, 0.0), (0.2, 0.0), (1.2, 1.0)] {
            assert!((zone.effective(u) - effective).abs() < 1e-12, "{u} % gave {}", zone.effective(u));
        }
    }

    #[test]
    fn neutral_edges_change_nothing_bit_for_bit() {
        let zone = DeadZone { lower_percent: 0.0, upper_percent: 0.0 };
        for u in [-21.4, -1e-300, 0.0, 0.1, 78.6] {
            assert_eq!(zone.effective(u), u);
        }
    }
}
