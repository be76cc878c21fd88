//! Cascade: a loop for the velocity within a loop for the position.
//!
//! ```text
//! v_ref = K_x·(setpoint − position) + ṙ, held within ±v_max
//! u     = K_v·(v_ref − v) + I         I ← I + K_v/T_i·(v_ref − v)·T, held while u is held the same way
//! ```
//!
//! The integral finds hover; v_max bounds the speed of long moves, which one loop cannot.
//! Source: Åström & Hägglund, *Advanced PID Control*, "Cascade control".

use crate::Limits;
use crate::check::{OutOfRange, within};
use crate::inputs::{Inputs, Source};

/// Gains of both loops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Cascade {
    /// K_x: commanded velocity per millimetre of error, 1/s.
    pub position_per_s: f64,
    /// v_max: the largest commanded velocity, mm/s.
    pub fastest_mm_per_s: f64,
    /// K_v: control value per mm/s.
    pub velocity_s_per_mm: f64,
    /// T_i of the velocity loop, seconds. `inf` switches the integral off.
    pub ti_s: f64,
    /// Where the velocity comes from.
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: Source,
}

impl Cascade {
    /// Checks every gain against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first gain outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("position_per_s", self.position_per_s, 0.0, 1e3)?;
        within("fastest_mm_per_s", self.fastest_mm_per_s, 1.0, 1e6)?;
        within("velocity_s_per_mm", self.velocity_s_per_mm, 0.0, 1e3)?;
        within("ti_s", self.ti_s, 1e-3, f64::INFINITY)
    }

    /// One control step; `integral` is the integral's part of the control value.
    pub fn step(&self, integral: &mut f64, inputs: &Inputs) -> f64 {
        let error = self.velocity_error(inputs);
        let wanted = self.velocity_s_per_mm * error + *integral;
        if !inputs.limits.blocks(wanted, error) {
            let grown = *integral + self.velocity_s_per_mm / self.ti_s * error * inputs.dt_s;
            *integral = inputs.limits.hold(grown);
        }
        inputs.limits.hold(wanted)
    }

    /// The integral with which the next step gives `control`.
    pub(crate) fn align(&self, inputs: &Inputs, control: f64) -> f64 {
        control - self.velocity_s_per_mm * self.velocity_error(inputs)
    }

    /// The loop gain multiplied.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { velocity_s_per_mm: factor * self.velocity_s_per_mm, ..*self }
    }

    fn velocity_error(&self, inputs: &Inputs) -> f64 {
        let fastest = Limits { lower: -self.fastest_mm_per_s, upper: self.fastest_mm_per_s };
        let wanted = self.position_per_s * inputs.error_mm() + inputs.reference.velocity_mm_per_s;
        fastest.hold(wanted) - inputs.velocity_mm_per_s(self.velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::{Cascade, Source};
    use crate::inputs::tests::inputs;

    const GAINS: Cascade = Cascade {
        position_per_s: 2.0,
        fastest_mm_per_s: 150.0,
        velocity_s_per_mm: 0.01,
        ti_s: 1.0,
        velocity: Source::Filter,
    };

    #[test]
    fn near_the_setpoint_it_is_a_pd_law() {
        let control = GAINS.step(&mut 0.0, &inputs(300.0, 290.0, 5.0));
        assert!((control - 0.01 * (2.0 * 10.0 - 5.0)).abs() < 1e-12, "{control}");
    }

    #[test]
    fn far_from_the_setpoint_it_asks_for_the_fastest_velocity() {
        let far = GAINS.step(&mut 0.0, &inputs(500.0, 100.0, 150.0));
        assert_eq!(far, 0.0, "already as fast as allowed");
        assert!(GAINS.step(&mut 0.0, &inputs(500.0, 100.0, 151.0)) < 0.0);
    }

    #[test]
    fn the_integral_of_a_constant_velocity_error_is_the_closed_form() {
        let mut integral = 0.0;
        for _ in 0..50 {
            GAINS.step(&mut integral, &inputs(300.0, 290.0, 0.0));
        }
        assert!((integral - 0.01 * 20.0 * 50.0 * 0.02).abs() < 1e-12, "K_v·e·t/T_i, got {integral}");
    }

    #[test]
    fn aligned_it_gives_what_it_was_told() {
        let now = inputs(300.0, 280.0, -20.0);
        let mut integral = GAINS.align(&now, 0.7);
        assert!((GAINS.step(&mut integral, &now) - 0.7).abs() < 1e-12);
    }
}
