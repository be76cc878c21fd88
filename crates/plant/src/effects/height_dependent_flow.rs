//! Height-dependent flow: the air lifts less the higher the ball is.
//!
//! ```text
//! a = −gradient·(x − centre)                                  a in mm/s², gradient in 1/s², x and centre in mm
//! a = −gradient·(turn/2π)·sin(2π·(x − centre)/turn)           where the position is an angle; turn in mm
//! ```
//!
//! Linear over the pipe; a leak at one place would be a kink. The centre is the height where hover was
//! measured: moving it is the same as moving hover, so that a log cannot tell it and no diagnosis varies it.
//! Source: leaks and wall drag take pressure along the pipe, Bernoulli's equation with losses.
//!
//! On a rig whose position is an angle it is gravity, which repeats with every turn: gradient is g/l of a pendulum that
//! hangs at the centre. There a log shows the centre. Source: the equation of the pendulum, θ″ = −(g/l)·sin θ.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, Neutral, Param, Scale, Similar, Stage, Start, within_bounds};
use crate::unsound::Unsound;
use control::check::within;
use core::f64::consts::TAU;
use core::iter;
use serde::{Deserialize, Serialize};

/// The lift falls linearly with height, or gravity goes with the sine of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightDependentFlow {
    /// Fall of the lift per height, mm/s² per mm; below 0 it rises.
    pub gradient_per_s2: f64,
    /// Height at which the lift is that of the duty, mm; the middle of the pipe unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_mm: Option<f64>,
    /// Length of one turn, mm, where the position is an angle; the lift is linear in the height unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_mm: Option<f64>,
}

impl Effect for HeightDependentFlow {
    const ENTRY: Entry = Entry {
        name: "height_dependent_flow",
        stage: Stage::Air,
        params: &[
            Param { name: "gradient_per_s2", min: -1e4, max: 1e4, neutral: Neutral::At(0.0), scale: Scale::Value },
            Param { name: "centre_mm", min: -1e6, max: 1e6, neutral: Neutral::Any(0.0), scale: Scale::Height(10.0) },
            Param { name: "turn_mm", min: 1e-3, max: 1e6, neutral: Neutral::Any(1.0), scale: Scale::Given },
        ],
        sizes: &[&[0.5], &[-0.5]],
        start: Start::DutyOverHeight,
        represents_its_stage: Some(3),
        in_a_log: "the duty that holds the ball depends on the height; a released ball drifts to one height, or away \
            from it where the gradient is below 0",
        mend_elsewhere: "find the spring, slope, cable or magnet that pulls to one position or pushes away from it; an \
            integral term in the controller",
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
        force: Some(|flow, now| flow.lift(now.position_mm, now.middle_mm)),
        force_slopes: Some(|flow, now| [flow.slope_per_s2(now.position_mm, now.middle_mm), 0.0, 0.0]),
        is_linear: Some(|flow| flow.turn_mm.is_none()),
        linearise: Some(|flow, plant| plant.gradient_per_s2 = flow.gradient_per_s2),
        ..Acts::NONE
    };

    /// The gradient; centre and turn as well where the position is an angle.
    fn values(&self) -> Vec<f64> {
        let of_turn = self.turn_mm.map(|turn| [self.centre_mm.unwrap_or(f64::NAN), turn]);
        iter::once(self.gradient_per_s2).chain(of_turn.into_iter().flatten()).collect()
    }

    fn from_values(values: &[f64]) -> Self {
        let at = |index: usize| values.get(index).copied();
        Self { gradient_per_s2: at(0).unwrap_or(f64::NAN), centre_mm: at(1), turn_mm: at(2) }
    }

    fn set_values(&mut self, values: &[f64]) {
        let new = Self::from_values(values);
        *self = Self { centre_mm: new.centre_mm.or(self.centre_mm), turn_mm: new.turn_mm.or(self.turn_mm), ..new };
    }

    fn check(&self) -> Result<(), Unsound> {
        within_bounds(self)?;
        Ok(self.centre_mm.map_or(Ok(()), |centre| within("centre_mm", centre, -1e6, 1e6))?)
    }
}

impl HeightDependentFlow {
    /// The acceleration that the height adds, mm/s².
    #[must_use]
    pub fn lift(&self, position_mm: f64, middle_mm: f64) -> f64 {
        let off_centre_mm = self.off_centre_mm(position_mm, middle_mm);
        let arm_mm = self.turn_mm.map_or(off_centre_mm, |turn_mm| {
            let radian_mm = turn_mm / TAU;
            radian_mm * libm::sin(off_centre_mm / radian_mm)
        });
        -self.gradient_per_s2 * arm_mm
    }

    /// The derivative of [`Self::lift`] by the position, 1/s².
    fn slope_per_s2(&self, position_mm: f64, middle_mm: f64) -> f64 {
        let off_centre_mm = self.off_centre_mm(position_mm, middle_mm);
        -self.gradient_per_s2 * self.turn_mm.map_or(1.0, |turn_mm| libm::cos(off_centre_mm * TAU / turn_mm))
    }

    fn off_centre_mm(&self, position_mm: f64, middle_mm: f64) -> f64 {
        position_mm - self.centre_mm.unwrap_or(middle_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::HeightDependentFlow;
    use crate::effect::Effect;

    #[test]
    fn the_middle_of_the_pipe_is_the_centre_unless_another_is_given() {
        let flow = HeightDependentFlow { gradient_per_s2: 2.0, centre_mm: None, turn_mm: None };
        assert_eq!((flow.lift(300.0, 300.0), flow.lift(350.0, 300.0)), (0.0, -100.0));
        let flow = HeightDependentFlow { centre_mm: Some(100.0), ..flow };
        assert_eq!(flow.lift(50.0, 300.0), 100.0);
    }

    #[test]
    fn a_fit_of_the_gradient_leaves_the_centre_alone() {
        let mut flow = HeightDependentFlow { gradient_per_s2: 2.0, centre_mm: Some(100.0), turn_mm: None };
        flow.set_values(&[3.0]);
        assert_eq!(flow, HeightDependentFlow { gradient_per_s2: 3.0, centre_mm: Some(100.0), turn_mm: None });
        flow.centre_mm = Some(f64::NAN);
        assert_eq!(flow.check().unwrap_err().key(), "centre_mm");
    }

    #[test]
    fn gravity_of_an_angle_repeats_with_every_turn_and_has_its_gradient_at_the_centre() {
        let gravity = HeightDependentFlow { gradient_per_s2: 16.0, centre_mm: Some(40.0), turn_mm: Some(360.0) };
        // −(g/l)·sin θ, in radians of 360/2π mm.
        let at_90_degrees = -16.0 * 360.0 / std::f64::consts::TAU;
        assert!((gravity.lift(130.0, 0.0) - at_90_degrees).abs() < 1e-9);
        assert!((gravity.lift(130.0 - 5.0 * 360.0, 0.0) - at_90_degrees).abs() < 1e-9);
        assert!((gravity.lift(40.001, 0.0) + 0.016).abs() < 1e-8);
        assert!(gravity.lift(220.0, 0.0).abs() < 1e-9, "upside down");
    }

    #[test]
    fn a_turn_without_a_centre_is_refused() {
        let gravity = HeightDependentFlow { gradient_per_s2: 16.0, centre_mm: None, turn_mm: Some(360.0) };
        assert_eq!(gravity.check().unwrap_err().key(), "centre_mm");
    }
}
