//! The believed plant of observer, feed-forward and model-predictive control: linear, and exact over any step.
//!
//! ```text
//! ẋ = v      v̇ = K·(w + d) − a·v      ẇ = (u − w)/τ      ḋ = 0          u: control value about hover
//!
//! φ₁(z) = (e^z − 1)/z     A₁ = t·φ₁(−at)     D = t·e^(−bt)·φ₁((b − a)·t), b = 1/τ
//! φ₂(z) = (φ₁(z) − 1)/z   A₂ = t²·φ₂(−at)    X = (A₁ − D)/b
//! ```
//!
//! w is the fan's contribution, in units of the control value; d is the error of hover, in the same units. Without a
//! fan lag w = u. D and X are divided differences of the exponential, so that equal poles, as in the thesis' G_c, are
//! no special case.
//! Source: the thesis, section 3.1; Higham, *Functions of Matrices*, section 10.7 (the φ functions).

use crate::check::{OutOfRange, within};
use libm::{exp, expm1, fabs};
use nalgebra::{SMatrix, SVector, matrix, vector};

/// Position x, mm; velocity v, mm/s; fan w and disturbance d, control value.
pub type State = SVector<f64, 4>;

/// The linear plant, as believed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Believed {
    /// K: acceleration per unit of the control value, mm/s² per percent (per mm/s² where predistortion linearises the
    /// fan).
    pub gain_mm_per_s2_per_control: f64,
    /// a: linear drag of the ball, 1/s.
    pub drag_per_s: f64,
    /// τ: the fan's lag, seconds. Absent: the fan follows at once.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub fan_lag_s: Option<f64>,
}

/// The transition of the state over one step under a constant control value u: Φ·state + Γ·u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// Φ.
    pub matrix: SMatrix<f64, 4, 4>,
    /// Γ.
    pub input: State,
}

impl Believed {
    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("gain_mm_per_s2_per_control", self.gain_mm_per_s2_per_control, 1e-6, 1e6)?;
        within("drag_per_s", self.drag_per_s, 0.0, 1e3)?;
        self.fan_lag_s.map_or(Ok(()), |lag_s| within("fan_lag_s", lag_s, 1e-3, 10.0))
    }

    /// The control value that accelerates the ball by `mm_per_s2` at `mm_per_s` in steady flow.
    #[must_use]
    pub fn control_for(&self, mm_per_s2: f64, mm_per_s: f64) -> f64 {
        (mm_per_s2 + self.drag_per_s * mm_per_s) / self.gain_mm_per_s2_per_control
    }

    /// The transition of the state over `dt_s` seconds.
    #[must_use]
    pub fn over(&self, dt_s: f64) -> Transition {
        let (gain, drag, t) = (self.gain_mm_per_s2_per_control, self.drag_per_s, dt_s);
        let first = t * phi1(-drag * t);
        let second = t * t * phi2(-drag * t);
        let slowed = exp(-drag * t);
        let Some(lag_s) = self.fan_lag_s else {
            return Transition {
                matrix: matrix![
                    1.0, first, 0.0, gain * second;
                    0.0, slowed, 0.0, gain * first;
                    0.0, 0.0, 0.0, 0.0;
                    0.0, 0.0, 0.0, 1.0],
                input: vector![gain * second, gain * first, 1.0, 0.0],
            };
        };
        let pole = lag_s.recip();
        let faded = exp(-pole * t);
        // From the slower of the two poles: the other way round, 0·∞ where they lie far apart.
        let along = t * slowed.max(faded) * phi1(-fabs(pole - drag) * t);
        let risen = (first - along) / pole;
        Transition {
            matrix: matrix![
                1.0, first, gain * risen, gain * second;
                0.0, slowed, gain * along, gain * first;
                0.0, 0.0, faded, 0.0;
                0.0, 0.0, 0.0, 1.0],
            input: vector![gain * (second - risen), gain * (first - along), 1.0 - faded, 0.0],
        }
    }
}

impl Transition {
    /// The state after the step under the control value `control`.
    #[must_use]
    pub fn apply(&self, state: &State, control: f64) -> State {
        self.matrix * state + self.input * control
    }
}

/// (e^z − 1)/z.
fn phi1(z: f64) -> f64 {
    if fabs(z) < 1e-5 { 1.0 + z / 2.0 } else { expm1(z) / z }
}

/// (φ₁(z) − 1)/z; its series where the difference would cancel.
fn phi2(z: f64) -> f64 {
    if fabs(z) < 1e-2 {
        0.5 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z / 720.0)))
    } else {
        (phi1(z) - 1.0) / z
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::{Believed, State};
    use nalgebra::vector;

    /// The three-pole model G_c of the thesis.
    pub(crate) const G_C: Believed =
        Believed { gain_mm_per_s2_per_control: 827.2, drag_per_s: 3.896, fan_lag_s: Some(0.257) };

    /// The model's differential equation by a thousand steps of Runge and Kutta.
    fn integrated(model: &Believed, start: State, control: f64, t: f64) -> State {
        let slope = |s: State| {
            let lag = model.fan_lag_s.unwrap_or(1.0);
            let fan = if model.fan_lag_s.is_some() { s[2] } else { control };
            let acceleration = model.gain_mm_per_s2_per_control * (fan + s[3]) - model.drag_per_s * s[1];
            vector![s[1], acceleration, (control - s[2]) / lag, 0.0]
        };
        let h = t / 1000.0;
        (0..1000).fold(start, |s, _| {
            let k1 = slope(s);
            let k2 = slope(s + k1 * (h / 2.0));
            let k3 = slope(s + k2 * (h / 2.0));
            let k4 = slope(s + k3 * h);
            s + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0)
        })
    }

    #[test]
    fn the_transition_is_the_integral_of_the_differential_equation() {
        let equal = Believed { fan_lag_s: Some(1.0 / 3.896), ..G_C };
        let quick = Believed { fan_lag_s: Some(0.01), ..G_C };
        let free = Believed { drag_per_s: 0.0, ..G_C };
        let none = Believed { fan_lag_s: None, ..G_C };
        let start = vector![200.0, -30.0, 0.4, 0.2];
        for model in [G_C, equal, quick, free, none] {
            for t in [0.001, 0.02, 0.3] {
                let (got, exact) = (model.over(t).apply(&start, -0.7), integrated(&model, start, -0.7, t));
                for row in [0, 1, 3] {
                    let error = (got[row] - exact[row]).abs();
                    assert!(error < 1e-8 * exact[row].abs().max(1.0), "{model:?}, {t} s, {row}: {got} or {exact}");
                }
            }
        }
    }

    #[test]
    fn far_poles_and_long_steps_stay_numbers() {
        let model = Believed { fan_lag_s: Some(1e-3), ..G_C };
        let after = model.over(1e3).apply(&vector![0.0, 10.0, 5.0, 0.0], 0.0);
        assert!(after.iter().all(|value| value.is_finite()) && after[1].abs() < 1e-9, "{after}");
    }

    #[test]
    fn the_control_for_an_acceleration_gives_it_without_a_lag() {
        let model = Believed { fan_lag_s: None, ..G_C };
        let control = model.control_for(120.0, 50.0);
        let after = model.over(1e-6).apply(&vector![0.0, 50.0, 0.0, 0.0], control);
        assert!(((after[1] - 50.0) / 1e-6 - 120.0).abs() < 1e-2, "{after}");
    }
}
