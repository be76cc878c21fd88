//! Height-dependent flow: the air lifts less the higher the ball is.
//!
//! ```text
//! a = −gradient·(x − centre)      a in mm/s², gradient in 1/s², x and centre in mm
//! ```
//!
//! Linear over the pipe; a leak at one place would be a kink. The centre is the height where hover was
//! measured: moving it is the same as moving hover, so that a log cannot tell it and no diagnosis varies it.
//! Source: leaks and wall drag take pressure along the pipe, Bernoulli's equation with losses.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, within_bounds};
use crate::unsound::Unsound;
use control::check::within;
use serde::{Deserialize, Serialize};

/// The lift falls linearly with height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightDependentFlow {
    /// Fall of the lift per height, mm/s² per mm; below 0 it rises.
    pub gradient_per_s2: f64,
    /// Height at which the lift is that of the duty, mm; the middle of the pipe unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_mm: Option<f64>,
}

impl Effect for HeightDependentFlow {
    const ENTRY: Entry = Entry {
        name: "height_dependent_flow",
        stage: Stage::Air,
        params: &[Param {
            name: "gradient_per_s2",
            min: -50.0,
            max: 50.0,
            neutral: Neutral::At(0.0),
            scale: Scale::Value,
        }],
        sizes: &[&[0.5], &[-0.5]],
        start: Start::DutyOverHeight,
        represents_its_stage: Some(3),
        in_a_log: "the duty that holds the ball depends on the height, and a released ball drifts back to one height",
        mend_elsewhere: "find the spring, slope or cable that pulls to one position; an integral term in the \
            controller",
        mend: "seal the pipe and its joints; identify hover at the height of the flight; an integral term in the controller",
        similar: &[
            Similar {
                name: "hover_drift",
                distinguished_by: "the hover duty at one height is the same at every visit. Hold several heights, and \
                     the first one again at the end",
            },
            Similar {
                name: "end_stop",
                distinguished_by: "the force changes gradually along the pipe; an end stop acts only at its height. \
                     Hold several heights far from the ends",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts {
        force: Some(|flow, now| flow.lift(now.position_mm, now.pipe_length_mm)),
        is_linear: true,
        linearise: Some(|flow, plant| plant.gradient_per_s2 = flow.gradient_per_s2),
        ..Acts::NONE
    };

    fn values(&self) -> Vec<f64> {
        vec![self.gradient_per_s2]
    }

    fn from_values(values: &[f64]) -> Self {
        Self { gradient_per_s2: values.first().copied().unwrap_or(f64::NAN), centre_mm: None }
    }

    fn set_values(&mut self, values: &[f64]) {
        *self = Self { centre_mm: self.centre_mm, ..Self::from_values(values) };
    }

    fn check(&self) -> Result<(), Unsound> {
        within_bounds(self)?;
        Ok(self.centre_mm.map_or(Ok(()), |centre| within("centre_mm", centre, -1e6, 1e6))?)
    }
}

impl HeightDependentFlow {
    /// The acceleration that the height adds, mm/s².
    #[must_use]
    pub fn lift(&self, position_mm: f64, pipe_length_mm: f64) -> f64 {
        -self.gradient_per_s2 * (position_mm - self.centre_mm.unwrap_or(pipe_length_mm / 2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::HeightDependentFlow;
    use crate::effect::Effect;

    #[test]
    fn the_middle_of_the_pipe_is_the_centre_unless_another_is_given() {
        let flow = HeightDependentFlow { gradient_per_s2: 2.0, centre_mm: None };
        assert_eq!((flow.lift(300.0, 600.0), flow.lift(350.0, 600.0)), (0.0, -100.0));
        let flow = HeightDependentFlow { centre_mm: Some(100.0), ..flow };
        assert_eq!(flow.lift(50.0, 600.0), 100.0);
    }

    #[test]
    fn a_fit_of_the_gradient_leaves_the_centre_alone() {
        let mut flow = HeightDependentFlow { gradient_per_s2: 2.0, centre_mm: Some(100.0) };
        flow.set_values(&[3.0]);
        assert_eq!(flow, HeightDependentFlow { gradient_per_s2: 3.0, centre_mm: Some(100.0) });
        flow.centre_mm = Some(f64::NAN);
        assert_eq!(flow.check().unwrap_err().key(), "centre_mm");
    }
}
