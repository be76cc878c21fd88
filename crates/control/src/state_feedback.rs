//! State feedback, with and without an integral, and LQG.
//!
//! ```text
//! u = K_r·r − k₁·y − k₂·(v − ṙ)                       K_r = k₁ unless given: the plant integrates, hover is control 0
//! added      u = K_r·r + I − k₁·y − k₂·(v − ṙ)        I ← I + K_r/T_i·e·T: removes undershoot and error at rest
//! in place   u =         I − k₁·y − k₂·(v − ṙ)        the same integral in place of K_r·r
//! LQG        u = k₁·(r − x̂) + k₂·(ṙ − v̂) + k₃·(w_r − ŵ − d̂) − d̂     all from the observer, which also finds hover
//! ```
//!
//! The integrals are held while u is held the same way as e. Source: the thesis, section 4.2; d̂: Åström & Wittenmark,
//! *Computer-Controlled Systems*, "Disturbance state".

use crate::check::{OutOfRange, within};
use crate::inputs::{Inputs, Source};

/// Bound of every gain.
const LARGEST: f64 = 1e6;

/// Feedback of position and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct StateFeedback {
    /// k₁: control value per millimetre.
    pub position_per_mm: f64,
    /// k₂: control value per mm/s.
    pub velocity_s_per_mm: f64,
    /// K_r: control value per millimetre of setpoint. Absent: k₁.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub setpoint_per_mm: Option<f64>,
    /// Where the velocity comes from.
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: Source,
    /// The integral. Absent: none.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub integral: Option<Integral>,
}

/// What becomes of the integral of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Integral {
    /// It adds to K_r·r.
    Added {
        /// T_i, seconds.
        ti_s: f64,
    },
    /// It replaces K_r·r.
    InPlace {
        /// T_i, seconds.
        ti_s: f64,
    },
}

impl StateFeedback {
    /// Checks every gain against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first gain outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("position_per_mm", self.position_per_mm, 0.0, LARGEST)?;
        within("velocity_s_per_mm", self.velocity_s_per_mm, 0.0, LARGEST)?;
        self.setpoint_per_mm.map_or(Ok(()), |gain| within("setpoint_per_mm", gain, 0.0, LARGEST))?;
        match self.integral {
            Some(Integral::Added { ti_s }) => within("integral.added.ti_s", ti_s, 1e-3, LARGEST),
            Some(Integral::InPlace { ti_s }) => within("integral.in_place.ti_s", ti_s, 1e-3, LARGEST),
            None => Ok(()),
        }
    }

    /// One control step; `integral` is the integral's part of the control value.
    pub fn step(&self, integral: &mut f64, inputs: &Inputs) -> f64 {
        let error = inputs.error_mm();
        let wanted = self.proportional(inputs) + self.integral.map_or(0.0, |_| *integral);
        if !inputs.limits.blocks(wanted, error) {
            *integral += self.setpoint_gain() / self.ti_s() * error * inputs.dt_s;
        }
        inputs.limits.hold(wanted)
    }

    /// The integral with which the next step gives `control`, where there is one.
    pub(crate) fn align(&self, inputs: &Inputs, control: f64) -> f64 {
        control - self.proportional(inputs)
    }

    /// The gains multiplied.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            position_per_mm: factor * self.position_per_mm,
            velocity_s_per_mm: factor * self.velocity_s_per_mm,
            setpoint_per_mm: self.setpoint_per_mm.map(|gain| factor * gain),
            ..*self
        }
    }

    fn setpoint_gain(&self) -> f64 {
        self.setpoint_per_mm.unwrap_or(self.position_per_mm)
    }

    const fn ti_s(&self) -> f64 {
        match self.integral {
            Some(Integral::Added { ti_s } | Integral::InPlace { ti_s }) => ti_s,
            None => f64::INFINITY,
        }
    }

    fn proportional(&self, inputs: &Inputs) -> f64 {
        let setpoint = match self.integral {
            Some(Integral::InPlace { .. }) => 0.0,
            _ => self.setpoint_gain() * inputs.reference.position_mm,
        };
        let velocity = inputs.velocity_mm_per_s(self.velocity) - inputs.reference.velocity_mm_per_s;
        setpoint - self.position_per_mm * inputs.filtered.position_mm - self.velocity_s_per_mm * velocity
    }
}

/// Feedback of the observer's whole estimate. LQG when gains and observer are both optimal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Lqg {
    /// k₁: control value per millimetre.
    pub position_per_mm: f64,
    /// k₂: control value per mm/s.
    pub velocity_s_per_mm: f64,
    /// k₃: control value per control value of the fan. 0 where the fan has no state.
    #[cfg_attr(feature = "serde", serde(default))]
    pub fan: f64,
}

impl Lqg {
    /// Checks every gain against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first gain outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("position_per_mm", self.position_per_mm, 0.0, LARGEST)?;
        within("velocity_s_per_mm", self.velocity_s_per_mm, 0.0, LARGEST)?;
        within("fan", self.fan, 0.0, LARGEST)
    }

    /// One control step. It has no state: the observer has.
    #[must_use]
    pub fn step(&self, inputs: &Inputs) -> f64 {
        let (wanted, seen) = (&inputs.reference, &inputs.observed);
        let control = self.position_per_mm * (wanted.position_mm - seen.position_mm)
            + self.velocity_s_per_mm * (wanted.velocity_mm_per_s - seen.velocity_mm_per_s)
            + self.fan * (wanted.fan - seen.fan - seen.disturbance)
            - seen.disturbance;
        inputs.limits.hold(control)
    }

    /// The gains multiplied; what hover lacks is no gain.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            position_per_mm: factor * self.position_per_mm,
            velocity_s_per_mm: factor * self.velocity_s_per_mm,
            fan: factor * self.fan,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Integral, Lqg, Source, StateFeedback};
    use crate::Limits;
    use crate::inputs::{Inputs, tests::inputs};
    use crate::observer::Estimate;

    /// The thesis' gains by Ackermann for poles −0.78 ± 2i, in mm/s².
    const ACKERMANN: StateFeedback = StateFeedback {
        position_per_mm: 7.8187,
        velocity_s_per_mm: 1.32335,
        setpoint_per_mm: None,
        integral: None,
        velocity: Source::Filter,
    };

    #[test]
    fn at_rest_on_the_setpoint_it_asks_for_hover_and_moving_it_brakes() {
        assert_eq!(ACKERMANN.step(&mut 0.0, &inputs(300.0, 300.0, 0.0)), 0.0);
        let moving = ACKERMANN.step(&mut 0.0, &inputs(300.0, 290.0, 20.0));
        assert!((moving - (78.187 - 26.467)).abs() < 1e-9, "{moving}");
    }

    #[test]
    fn both_integrals_grow_by_the_closed_form_and_one_of_them_replaces_the_setpoint() {
        for (integral, from_setpoint) in [(Integral::Added { ti_s: 4.0 }, 10.0), (Integral::InPlace { ti_s: 4.0 }, 0.0)]
        {
            let law = StateFeedback { setpoint_per_mm: Some(1.0), integral: Some(integral), ..ACKERMANN };
            let mut sum = 0.0;
            let mut control = 0.0;
            for _ in 0..=100 {
                control = law.step(&mut sum, &inputs(10.0, 0.0, 0.0));
            }
            let exact = from_setpoint + 10.0 / 4.0 * 100.0 * 0.02;
            assert!((control - exact).abs() < 1e-9, "{integral:?}: {control}, exact {exact}");
        }
    }

    #[test]
    fn the_integral_holds_while_the_fan_is_saturated() {
        let law = StateFeedback { integral: Some(Integral::Added { ti_s: 1.0 }), ..ACKERMANN };
        let now = Inputs { limits: Limits { lower: -1.0, upper: 1.0 }, ..inputs(300.0, 0.0, 0.0) };
        let mut integral = 0.25;
        assert_eq!(law.step(&mut integral, &now), 1.0);
        assert_eq!(integral, 0.25);
    }

    #[test]
    fn what_hover_lacks_is_taken_off_in_full_whatever_the_gains() {
        let law = Lqg { position_per_mm: 0.02, velocity_s_per_mm: 0.004, fan: 0.5 };
        let seen = Estimate { position_mm: 300.0, fan: -0.7, disturbance: 0.7, ..Estimate::default() };
        let now = Inputs { observed: seen, ..inputs(300.0, 0.0, 0.0) };
        assert!((law.step(&now) + 0.7).abs() < 1e-12);
        assert!((law.scaled(3.0).step(&now) + 0.7).abs() < 1e-12);
    }
}
