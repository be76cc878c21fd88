//! Force asymmetry: the fan pushes harder above hover than it lets go below, or the other way round.
//!
//! ```text
//! gain' = gain·√r    u > 0           r: gain above hover over gain below; u: effective duty about hover
//! gain' = gain/√r    u < 0
//! ```
//!
//! The geometric mean of the two is the gain, so that the effect leaves the gain alone. Leaves out that a real
//! curve bends smoothly through hover.
//! Source: the thesis, section 3.2.2: 3.7 % of duty above standstill its fan gives 978 mm/s², 3.7 % below −805.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, values_in_order};
use libm::sqrt;
use serde::{Deserialize, Serialize};

/// The gain above hover differs from the gain below.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceAsymmetry {
    /// r: gain above hover over gain below, no unit.
    pub up_over_down: f64,
}

impl Effect for ForceAsymmetry {
    const ENTRY: Entry = Entry {
        name: "force_asymmetry",
        stage: Stage::Actuator,
        article: "a ",
        params: &[Param { name: "up_over_down", min: 0.05, max: 20.0, neutral: Neutral::At(1.0), scale: Scale::Value }],
        sizes: &[&[1.15], &[0.85]],
        in_a_log: "equal steps of duty up and down from hover move the ball by different distances",
        mend: "invert the measured force curve between controller and fan (predistortion)",
        similar: &[
            Similar {
                name: "thrust_curve",
                distinguished_by: "with an asymmetry small steps up and down differ by the same ratio as large ones. \
                     Fly pairs of steps of several sizes",
            },
            Similar {
                name: "saturation",
                distinguished_by: "with an asymmetry small steps differ too; saturation does not affect them. Fly \
                     pairs of steps of several sizes",
            },
            Similar {
                name: "spin_asymmetry",
                distinguished_by: "with a force asymmetry the final forces of equal steps up and down differ; with \
                     spin asymmetry only the transients do",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { gain_by_command: Some(Self::gain_factor), ..Acts::NONE };

    values_in_order!(up_over_down);
}

impl ForceAsymmetry {
    /// What the gain is multiplied by at an effective duty of `about_hover_percent`.
    #[must_use]
    pub fn gain_factor(&self, about_hover_percent: f64) -> f64 {
        let root = sqrt(self.up_over_down);
        if about_hover_percent > 0.0 { root } else { 1.0 / root }
    }
}

#[cfg(test)]
mod tests {
    use super::ForceAsymmetry;

    #[test]
    fn the_two_gains_have_the_ratio_and_their_geometric_mean_is_one() {
        let asymmetry = ForceAsymmetry { up_over_down: 1.7 };
        let (up, down) = (asymmetry.gain_factor(0.1), asymmetry.gain_factor(-0.1));
        assert!((up / down - 1.7).abs() < 1e-12 && (up * down - 1.0).abs() < 1e-12, "{up}, {down}");
    }
}
