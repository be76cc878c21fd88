//! Duty quantisation: the fan answers only in steps.
//!
//! ```text
//! duty' = step·round(duty / step)      duty, step in percent of full duty, halves away from zero
//! ```
//!
//! The grid starts at duty 0. Leaves out that a real fan's steps differ in height and in the way up and down.
//! Source: the thesis, section 3.2.2: the force has steps of about 0.8 % of duty, whatever drives the fan.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, InColumn, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use crate::rounding::rounded;
use serde::{Deserialize, Serialize};

/// The duty in force is the nearest multiple of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DutyQuantisation {
    /// Step, percent of full duty.
    pub step_percent: f64,
}

impl Effect for DutyQuantisation {
    const ENTRY: Entry = Entry {
        name: "duty_quantisation",
        stage: Stage::Actuator,
        params: &[Param { name: "step_percent", min: 0.0, max: 20.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[0.4], &[0.8]],
        start: Start::DutySteps,
        in_columns: &[InColumn::InputDifference],
        in_a_log: "the force jumps at certain duties and is flat between them, and the loop has a limit cycle between \
             two levels",
        mend: "dither the duty so that its mean falls between the steps, or use a driver with finer steps",
        similar: &[
            Similar {
                name: "dead_zone",
                distinguished_by: "quantisation is flat at every step of duty; a dead zone is one flat part, at hover. \
                     Fly a slow ramp of duty",
            },
            Similar {
                name: "hysteresis",
                distinguished_by: "with quantisation the force depends on the duty alone: slow ramps up and down jump \
                     at the same duties",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { on_duty: Some(Self::rounded), ..Acts::NONE };

    values_in_order!(step_percent);
}

impl DutyQuantisation {
    /// The duty that the fan makes of `duty_percent`.
    #[must_use]
    pub fn rounded(&self, duty_percent: f64) -> f64 {
        rounded(self.step_percent, duty_percent)
    }
}

#[cfg(test)]
mod tests {
    use super::DutyQuantisation;

    #[test]
    fn the_grid_starts_at_zero_duty_and_the_nearest_step_wins() {
        let steps = DutyQuantisation { step_percent: 0.8 };
        for (duty, k) in [(0.0, 0.0), (0.39, 0.0), (0.41, 1.0), (21.4, 27.0), (100.0, 125.0), (-0.5, -1.0)] {
            assert!((steps.rounded(duty) - 0.8 * k).abs() < 1e-12, "{duty} % gave {}", steps.rounded(duty));
        }
    }
}
