//! PID with a filtered derivative, limits and anti-windup.
//!
//! ```text
//! u = K_p · ( e + (1/T_i)·∫e dt + u_d )        e = setpoint − position
//! u_d   the derivative filter of −position (or of e)            see `filter.rs`
//! I ← I + K_p/T_i · e · T                      held while u is saturated the same way as e
//! ```
//!
//! u is the control value: percent of duty about hover, or mm/s² where the fan is linearised.
//! Source: the thesis, section 4.1; clamping: Åström & Murray, *Feedback Systems*, "PID Control",
//! "Implementation". The integral is kept as its part of u, so that a change of gains can be bumpless.

use crate::check::{OutOfRange, within};
use crate::filter::DerivativeFilter;

/// The signal whose derivative damps the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum DerivativeOn {
    /// −position: a jump of the setpoint does not kick the fan.
    #[default]
    Measurement,
    /// The error, as the original program did.
    Error,
}

/// Gains. They never change while a step runs; see [`PidState`] for what does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Pid {
    /// Proportional gain K_p: control value per millimetre of error.
    pub kp_per_mm: f64,
    /// Integral time T_i, seconds. Infinite (`inf`) switches the integral off.
    pub ti_s: f64,
    /// Derivative time T_d, seconds. Zero switches the derivative off.
    pub td_s: f64,
    /// N: how many times faster than T_d the derivative filter is.
    pub derivative_n: f64,
    /// Which signal is differentiated.
    #[cfg_attr(feature = "serde", serde(default))]
    pub derivative_on: DerivativeOn,
}

/// Smallest and largest control value that the fan can still follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Smallest control value.
    pub lower: f64,
    /// Largest control value.
    pub upper: f64,
}

impl Limits {
    /// Holds `value` within the limits. NaN becomes the lower limit: less air is the safe side.
    #[must_use]
    pub const fn hold(self, value: f64) -> f64 {
        if value.is_nan() { self.lower } else { value.max(self.lower).min(self.upper) }
    }
}

/// What the controller remembers between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidState {
    /// The integral's part of the control value.
    integral: f64,
    /// The derivative's T_d·d/dt, in millimetres.
    derivative_mm: f64,
    error_mm: f64,
    filter: DerivativeFilter,
}

impl Pid {
    /// Checks every gain against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first gain outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("kp_per_mm", self.kp_per_mm, 0.0, 1e3)?;
        within("ti_s", self.ti_s, 1e-3, f64::INFINITY)?;
        within("td_s", self.td_s, 0.0, 1e3)?;
        within("derivative_n", self.derivative_n, 1.0, 1e3)
    }

    /// One control step: `setpoint_mm` and `position_mm`, `dt_s` after the last one, to a control value
    /// within `limits`.
    pub fn step(&self, state: &mut PidState, setpoint_mm: f64, position_mm: f64, dt_s: f64, limits: Limits) -> f64 {
        let error = setpoint_mm - position_mm;
        let differentiated = match self.derivative_on {
            DerivativeOn::Measurement => -position_mm,
            DerivativeOn::Error => error,
        };
        state.derivative_mm = state.filter.step(differentiated, dt_s, self.td_s, self.derivative_n);
        state.error_mm = error;

        let wanted = self.kp_per_mm * (error + state.derivative_mm) + state.integral;
        let control = limits.hold(wanted);
        let pushes_further = (wanted > limits.upper && error > 0.0) || (wanted < limits.lower && error < 0.0);
        if !pushes_further {
            // A second bound for the integral alone: the derivative may hide a saturation from `wanted`.
            let next = state.integral + self.kp_per_mm / self.ti_s * error * dt_s;
            state.integral = limits.hold(next);
        }
        control
    }

    /// Moves `state` from the gains `old` to these gains so that the control value does not jump: the integral takes up
    /// the difference, and gives it back over T_i. Change gains when the ball is near its setpoint, where there is little.
    pub fn take_over(&self, old: &Self, state: &mut PidState) {
        // The filter's output is T_d·d/dt, so that a new T_d scales what it holds.
        let derivative = if old.td_s > 0.0 { state.derivative_mm * self.td_s / old.td_s } else { 0.0 };
        let before = old.kp_per_mm * (state.error_mm + state.derivative_mm);
        let after = self.kp_per_mm * (state.error_mm + derivative);
        state.integral += before - after;
        state.filter.rescale(derivative);
        state.derivative_mm = derivative;
    }
}

impl PidState {
    /// A controller that starts where the fan already is: its integral part is `control`.
    #[must_use]
    pub fn starting_at(control: f64) -> Self {
        Self { integral: control, ..Self::default() }
    }

    /// The same controller after readings were missing: the integral stands, the derivative starts anew.
    #[must_use]
    pub fn after_a_hole(self) -> Self {
        Self::starting_at(self.integral)
    }
}

#[cfg(test)]
mod tests {
    use super::{DerivativeOn, Limits, Pid, PidState};

    const T: f64 = 0.02;
    const FREE: Limits = Limits { lower: -1e9, upper: 1e9 };
    const GAINS: Pid =
        Pid { kp_per_mm: 0.01, ti_s: 3.0, td_s: 0.3, derivative_n: 10.0, derivative_on: DerivativeOn::Measurement };

    #[test]
    fn the_integral_of_a_constant_error_is_the_closed_form() {
        let mut state = PidState::default();
        let mut control = 0.0;
        for _ in 0..=150 {
            control = GAINS.step(&mut state, 300.0, 200.0, T, FREE);
        }
        // 150 whole periods of a 100 mm error lie behind the last step: K_p·e·(1 + t/T_i).
        let exact = 0.01 * 100.0 * (1.0 + 150.0 * T / 3.0);
        assert!((control - exact).abs() < 1e-9, "{control}, exact {exact}");
    }

    #[test]
    fn a_setpoint_jump_does_not_kick_the_derivative() {
        let mut state = PidState::default();
        GAINS.step(&mut state, 200.0, 200.0, T, FREE);
        let control = GAINS.step(&mut state, 300.0, 200.0, T, FREE);
        assert!((control - 1.0).abs() < 1e-9, "only K_p·e may act, got {control}");
    }

    #[test]
    fn the_derivative_on_error_kicks_as_the_original_did() {
        let gains = Pid { derivative_on: DerivativeOn::Error, ..GAINS };
        let mut state = PidState::default();
        gains.step(&mut state, 200.0, 200.0, T, FREE);
        let control = gains.step(&mut state, 300.0, 200.0, T, FREE);
        assert!((control - 0.01 * (100.0 + 10.0 * 100.0)).abs() < 1e-9, "K_p·(e + N·Δe), got {control}");
    }

    #[test]
    fn a_rising_ball_is_braked() {
        let mut state = PidState::default();
        GAINS.step(&mut state, 300.0, 300.0, T, FREE);
        assert!(GAINS.step(&mut state, 302.0, 302.0, T, FREE) < 0.0);
    }

    #[test]
    fn integral_holds_while_the_fan_is_saturated() {
        let limits = Limits { lower: -1.0, upper: 1.0 };
        let mut state = PidState::default();
        for _ in 0..5000 {
            assert_eq!(GAINS.step(&mut state, 500.0, 0.0, T, limits), 1.0);
        }
        // The error turns: without windup the control leaves the limit at the first step.
        let control = GAINS.step(&mut state, 0.0, 10.0, T, limits);
        assert!(control < 1.0, "{control} is still at the limit");
    }

    #[test]
    fn a_change_of_gains_does_not_bump_the_control() {
        let mut state = PidState::default();
        for k in 0..200 {
            GAINS.step(&mut state, 300.0, 250.0 + f64::from(k % 7), T, FREE);
        }
        let position = 250.0 + f64::from(199 % 7);
        let new = Pid { kp_per_mm: 0.03, ti_s: 8.0, td_s: 0.9, ..GAINS };
        let mut changed = state;
        new.take_over(&GAINS, &mut changed);
        // No time passes and nothing moves: both must ask for the same.
        let before = GAINS.step(&mut state, 300.0, position, 0.0, FREE);
        let after = new.step(&mut changed, 300.0, position, 0.0, FREE);
        assert!((before - after).abs() < 1e-12, "{before} became {after}");
    }

    #[test]
    fn a_start_from_a_running_fan_keeps_its_control() {
        let mut state = PidState::starting_at(0.7);
        assert_eq!(GAINS.step(&mut state, 200.0, 200.0, T, FREE), 0.7);
    }

    proptest::proptest! {
        #[test]
        fn the_control_is_always_a_number_within_its_limits(
            samples in proptest::collection::vec((proptest::num::f64::ANY, proptest::num::f64::ANY, 0.0..10.0), 1..50)
        ) {
            let limits = Limits { lower: -21.4, upper: 30.0 };
            let mut state = PidState::default();
            for (setpoint, position, dt) in samples {
                let control = GAINS.step(&mut state, setpoint, position, dt, limits);
                proptest::prop_assert!((limits.lower..=limits.upper).contains(&control), "{control}");
            }
        }
    }
}
