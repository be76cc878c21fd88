//! Thrust curve: the force bends as the duty leaves hover.
//!
//! ```text
//! u' = u + c·u²          u, u' in percent of duty about hover, c per percent
//! u' = −1/(4c)           beyond the vertex u = −1/(2c), where the parabola would turn back
//! ```
//!
//! The first two terms of the curve about hover: c = 1/(2·hover) is a thrust that grows with the square of the
//! duty. Leaves out everything of third order and above. It is the static part of air whose speed goes with the duty; how
//! that air brakes a ball that moves is `relative_airflow`.
//! Source: affinity laws of fans, thrust ∝ speed².

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Form, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// The force is a parabola of the duty about hover, held beyond its vertex.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThrustCurve {
    /// c: curvature at hover, 1 per percent of duty.
    pub curvature_per_percent: f64,
}

impl Effect for ThrustCurve {
    const ENTRY: Entry = Entry {
        name: "thrust_curve",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param {
            name: "curvature_per_percent",
            min: -1.0,
            max: 1.0,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.05], &[-0.05]],
        start: Start::Values(&[&[0.01], &[0.03], &[-0.01], &[-0.03]]),
        form: Form::Approximate,
        represents_its_stage: Some(2),
        in_a_log: "small steps of duty fit the gain; large ones give too much force on one side of hover and too \
             little on the other",
        mend: "invert the measured force curve between controller and fan (predistortion)",
        similar: &[
            Similar {
                name: "force_asymmetry",
                distinguished_by: "with a thrust curve small steps up and down have the same gain; with an asymmetry \
                     they differ as large ones do. Fly pairs of steps of several sizes",
            },
            Similar {
                name: "saturation",
                distinguished_by: "a thrust curve bends from hover on; a saturated one is straight up to the limit and \
                     flat beyond. Fly steps of several sizes",
            },
            Similar {
                name: "relative_airflow",
                distinguished_by: "a thrust curve acts on a ball at rest too, and the drag is the same at every duty. \
                     Fly large steps of duty, with fast motion at small and at large duties",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { on_command: Some(Self::bent), ..Acts::NONE };

    values_in_order!(curvature_per_percent);
}

impl ThrustCurve {
    /// The effective duty about hover, percent.
    #[must_use]
    pub fn bent(&self, about_hover_percent: f64) -> f64 {
        let (c, u) = (self.curvature_per_percent, about_hover_percent);
        let held = if c > 0.0 {
            u.max(-0.5 / c)
        } else if c < 0.0 {
            u.min(-0.5 / c)
        } else {
            return u;
        };
        held + c * held * held
    }
}

#[cfg(test)]
mod tests {
    use super::ThrustCurve;

    #[test]
    fn the_parabola_is_held_beyond_its_vertex_on_either_side() {
        let up = ThrustCurve { curvature_per_percent: 0.1 };
        let down = ThrustCurve { curvature_per_percent: -0.1 };
        for (u, exact) in [(1.0, 1.1), (10.0, 20.0), (-1.0, -0.9), (-5.0, -2.5), (-40.0, -2.5)] {
            assert!((up.bent(u) - exact).abs() < 1e-12, "{u} % gave {}, exact {exact}", up.bent(u));
            assert!((down.bent(-u) + exact).abs() < 1e-12, "{} % gave {}, exact {}", -u, down.bent(-u), -exact);
        }
    }
}
