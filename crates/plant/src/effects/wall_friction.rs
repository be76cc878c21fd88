//! Wall friction: the ball rubs against the pipe, and sticks when it rests.
//!
//! ```text
//! v ≠ 0:  a = −f·sign(v)                        a, f in mm/s²
//! v = 0:  a = 0 while |net| ≤ f, else net − f·sign(net)      net: everything else that accelerates the ball
//! with a transition w:  a = −f·tanh(v/w)        w in mm/s
//! ```
//!
//! Coulomb's law with one f for sticking and sliding. Leaves out that the ball also rolls. With a transition, friction
//! builds up with the speed, as in lubricated and elastic contacts: the ball does not stick, but creeps under a force
//! below f.
//! Source: Karnopp, *Computer Simulation of Stick-Slip Friction in Mechanical Dynamic Systems*, J. Dyn. Sys.,
//! Meas., Control 107 (1985); without its band of low speed, because the instant of standstill is solved for. The
//! transition: Andersson, Söderberg and Björklund, *Friction models for sliding dry, boundary and mixed lubricated
//! contacts*, Tribology International 40 (2007).

use crate::acts::Acts;
use crate::effect::{Effect, Entry, InColumn, Neutral, Param, Scale, Similar, Stage, Start};
use core::iter;
use serde::{Deserialize, Serialize};

/// Friction against the pipe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallFriction {
    /// f: what friction takes from the acceleration, mm/s².
    pub acceleration_mm_per_s2: f64,
    /// w: the speed over which friction builds up, mm/s; the ball sticks unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transition_mm_per_s: Option<f64>,
}

/// Steepest smooth friction, 1/s: it acts within 5 ms, so that a step of the filter or the simulator can follow it. One
/// that is steeper is so smoothed.
const STEEPEST_PER_S: f64 = 200.0;

impl Effect for WallFriction {
    const ENTRY: Entry = Entry {
        name: "wall_friction",
        stage: Stage::Ball,
        params: &[
            Param {
                name: "acceleration_mm_per_s2",
                min: 0.0,
                max: 1e6,
                neutral: Neutral::At(0.0),
                scale: Scale::Value,
            },
            Param { name: "transition_mm_per_s", min: 1e-3, max: 1e5, neutral: Neutral::Any(1.0), scale: Scale::Speed },
        ],
        optional: 1,
        sizes: &[&[20.0], &[60.0]],
        start: Start::AgainstMotion(&[&[8.0], &[20.0], &[50.0]]),
        in_columns: &[InColumn::InputDifferenceByForce],
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

    /// The acceleration; the transition as well where it is given.
    fn values(&self) -> Vec<f64> {
        iter::once(self.acceleration_mm_per_s2).chain(self.transition_mm_per_s).collect()
    }

    fn from_values(values: &[f64]) -> Self {
        let at = |index: usize| values.get(index).copied();
        Self { acceleration_mm_per_s2: at(0).unwrap_or(f64::NAN), transition_mm_per_s: at(1) }
    }

    fn set_values(&mut self, values: &[f64]) {
        *self = Self::from_values(values);
    }
}

impl WallFriction {
    /// Whether it holds a ball at rest; otherwise it is smooth.
    #[must_use]
    pub fn is_dry(&self) -> bool {
        self.transition_mm_per_s.is_none()
    }

    /// The derivative of a smooth friction by the velocity at standstill, 1/s, without its sign.
    #[must_use]
    pub fn steepness_per_s(&self) -> f64 {
        let over = self.transition_mm_per_s.unwrap_or_default();
        (self.acceleration_mm_per_s2 / over).min(STEEPEST_PER_S)
    }

    /// The acceleration by a smooth friction at this velocity, mm/s².
    #[must_use]
    pub fn smooth(&self, velocity_mm_per_s: f64) -> f64 {
        let most = self.acceleration_mm_per_s2;
        if most == 0.0 { 0.0 } else { -most * libm::tanh(self.steepness_per_s() * velocity_mm_per_s / most) }
    }

    /// Its derivative by the velocity, 1/s.
    #[must_use]
    pub fn smooth_slope_per_s(&self, velocity_mm_per_s: f64) -> f64 {
        let share = self.smooth(velocity_mm_per_s) / self.acceleration_mm_per_s2;
        if share.is_nan() { 0.0 } else { -self.steepness_per_s() * (1.0 - share * share) }
    }

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

#[cfg(test)]
mod tests {
    use super::{STEEPEST_PER_S, WallFriction};
    use crate::model::Model;
    use crate::model::tests::thesis;
    use crate::motion::{Input, Motion};
    use crate::{Effect, Effects};

    #[test]
    fn smooth_friction_is_the_hyperbolic_tangent_and_no_steeper_than_a_step_can_follow() {
        let friction = WallFriction::from_values(&[50.0, 5.0]);
        assert!(!friction.is_dry() && WallFriction::from_values(&[50.0]).is_dry());
        assert!((friction.smooth(2.5) + 50.0 * 0.5_f64.tanh()).abs() < 1e-12);
        assert!((friction.smooth(-100.0) - 50.0).abs() < 1e-12);
        let slope = (friction.smooth(2.51) - friction.smooth(2.49)) / 0.02;
        assert!((friction.smooth_slope_per_s(2.5) - slope).abs() < 1e-4, "{slope}");
        let steep = WallFriction::from_values(&[50.0, 0.01]);
        assert_eq!(steep.smooth_slope_per_s(0.0), -STEEPEST_PER_S);
        let none = WallFriction::from_values(&[0.0, 5.0]);
        assert_eq!([none.smooth(3.0), none.smooth_slope_per_s(3.0)], [0.0, 0.0]);
    }

    /// The height after a second at 20 mm/s² from rest, which is less than the friction.
    fn moved_mm(values: &[f64]) -> f64 {
        let mut model = Model { drag_per_s: 0.0, effects: Effects::default(), ..thesis() };
        assert!(model.effects.set("wall_friction", values));
        let start = Motion::at_rest(300.0, 20.0);
        let end = (0..100).fold(start, |motion, _| motion.step(&model, Input::of(20.0), 0.01));
        end.position_mm - start.position_mm
    }

    #[test]
    fn a_ball_sticks_with_dry_friction_and_creeps_with_a_smooth_one_at_the_speed_that_balances_the_force() {
        assert_eq!(moved_mm(&[50.0]), 0.0);
        // It reaches w·artanh(20/50) = 2.118 mm/s within a tenth of a second.
        assert!((1.8..2.118).contains(&moved_mm(&[50.0, 5.0])), "{}", moved_mm(&[50.0, 5.0]));
    }
}
