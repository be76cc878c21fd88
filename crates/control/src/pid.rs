//! PID with two degrees of freedom, a filtered derivative, limits, a rate limit and anti-windup.
//!
//! ```text
//! u = K_p · ( b·setpoint − position + (1/T_i)·∫e dt + u_d )      e = setpoint − position, b the setpoint's weight
//! u_d   the derivative filter of −position (or of e)            see `filter.rs`
//! u is held within its limits and within rate·T of the last one
//! I ← I + K_p/T_i · e · T                      clamping: held while u is held the same way as e
//! I ← I + K_p/T_i · e · T + (held − u)·T/T_t   back-calculation, T_t the tracking time
//! ```
//!
//! u is the control value: percent of duty about hover, or mm/s² where the fan is linearised.
//! Source: the thesis, section 4.1; weights and anti-windup: Åström & Murray, *Feedback Systems*, "PID Control",
//! "Implementation". The integral is kept as its part of u, so that a change of gains can be bumpless.

use crate::Limits;
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

/// Anti-windup: limits the integral while the fan cannot follow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum AntiWindup {
    /// The integral is held while the error would push it further.
    #[default]
    Clamping,
    /// The integral follows the fan's real command.
    BackCalculation {
        /// T_t: how fast it follows, seconds; between T_d and T_i.
        tracking_s: f64,
    },
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
    /// b: weight of the setpoint in the proportional part, 0 to 1. The derivative's weight is 0 or 1 by
    /// [`Pid::derivative_on`].
    #[cfg_attr(feature = "serde", serde(default = "whole", skip_serializing_if = "is_whole"))]
    pub setpoint_weight: f64,
    /// The fastest change of the control value, per second. Absent: no limit.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub rate_limit_per_s: Option<f64>,
    /// Anti-windup.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "is_default"))]
    pub anti_windup: AntiWindup,
}

#[cfg(feature = "serde")]
const fn whole() -> f64 {
    1.0
}

#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks with a reference")]
fn is_whole(weight: &f64) -> bool {
    *weight == 1.0
}

#[cfg(feature = "serde")]
fn is_default(anti_windup: &AntiWindup) -> bool {
    *anti_windup == AntiWindup::default()
}

/// The controller's state between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidState {
    /// The integral's part of the control value.
    integral: f64,
    /// The derivative's T_d·d/dt, in millimetres.
    derivative_mm: f64,
    /// b·setpoint − position.
    proportional_mm: f64,
    filter: DerivativeFilter,
    /// The last control value, if there was one.
    last: Option<f64>,
}

impl Pid {
    /// The gains that may be changed in flight, in their order: key, smallest, largest.
    pub const BOUNDS: [(&'static str, f64, f64); 3] =
        [("kp_per_mm", 0.0, 1e3), ("ti_s", 1e-3, f64::INFINITY), ("td_s", 0.0, 1e3)];

    /// Checks every gain against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first gain outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        for ((key, min, max), gain) in Self::BOUNDS.into_iter().zip([self.kp_per_mm, self.ti_s, self.td_s]) {
            within(key, gain, min, max)?;
        }
        within("derivative_n", self.derivative_n, 1.0, 1e3)?;
        within("setpoint_weight", self.setpoint_weight, 0.0, 1.0)?;
        if let AntiWindup::BackCalculation { tracking_s } = self.anti_windup {
            within("anti_windup.back_calculation.tracking_s", tracking_s, 1e-3, 1e3)?;
        }
        self.rate_limit_per_s.map_or(Ok(()), |rate| within("rate_limit_per_s", rate, 1e-6, 1e9))
    }

    /// Gains with the weights and limits of the textbook: the setpoint's weight 1, clamping, no rate limit.
    #[must_use]
    pub const fn new(kp_per_mm: f64, ti_s: f64, td_s: f64, derivative_n: f64, derivative_on: DerivativeOn) -> Self {
        let anti_windup = AntiWindup::Clamping;
        let (setpoint_weight, rate_limit_per_s) = (1.0, None);
        Self { kp_per_mm, ti_s, td_s, derivative_n, derivative_on, setpoint_weight, anti_windup, rate_limit_per_s }
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
        state.proportional_mm = self.setpoint_weight * setpoint_mm - position_mm;

        let wanted = self.kp_per_mm * (state.proportional_mm + state.derivative_mm) + state.integral;
        let reach = match (self.rate_limit_per_s, state.last) {
            (Some(rate), Some(last)) => limits.within(last, rate * dt_s),
            _ => limits,
        };
        let control = reach.hold(wanted);
        state.last = Some(control);
        let grown = state.integral + self.kp_per_mm / self.ti_s * error * dt_s;
        state.integral = match self.anti_windup {
            AntiWindup::Clamping if reach.blocks(wanted, error) => state.integral,
            // A second bound for the integral alone: the derivative may hide a saturation from `wanted`.
            AntiWindup::Clamping => limits.hold(grown),
            AntiWindup::BackCalculation { tracking_s } => {
                limits.hold(grown + (control - wanted) * (dt_s / tracking_s).min(1.0))
            }
        };
        control
    }

    /// Sets the integral so that the next step gives `control`, were it to see these inputs and no change.
    pub(crate) fn align(&self, state: &mut PidState, setpoint_mm: f64, position_mm: f64, control: f64) {
        let proportional_mm = self.setpoint_weight * setpoint_mm - position_mm;
        *state = PidState {
            integral: control - self.kp_per_mm * proportional_mm,
            proportional_mm,
            last: Some(control),
            ..PidState::default()
        };
    }

    /// The loop gain multiplied.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { kp_per_mm: factor * self.kp_per_mm, ..*self }
    }

    /// Moves `state` from the gains `old` to these gains so that the control value does not jump: the integral takes
    /// the difference, and returns it over T_i. Change gains when the ball is near its setpoint, where the difference
    /// is small.
    pub fn take_over(&self, old: &Self, state: &mut PidState) {
        let before = old.kp_per_mm * (state.proportional_mm + state.derivative_mm);
        self.rescale(old, state);
        state.integral += before - self.kp_per_mm * (state.proportional_mm + state.derivative_mm);
    }

    /// Makes `state` one of these gains: the filter's output is T_d·d/dt, so that a new T_d scales what it holds. The
    /// integral is kept.
    pub(crate) fn rescale(&self, old: &Self, state: &mut PidState) {
        let derivative = if old.td_s > 0.0 { state.derivative_mm * self.td_s / old.td_s } else { 0.0 };
        state.filter.rescale(derivative);
        state.derivative_mm = derivative;
    }
}

impl PidState {
    /// The same controller where control values are counted from elsewhere, so that each is larger `by` so much.
    pub(crate) const fn rebase(&mut self, by: f64) {
        self.integral += by;
        if let Some(last) = &mut self.last {
            *last += by;
        }
    }

    /// A controller that starts where the fan already is: its integral part is `control`.
    #[must_use]
    pub fn starting_at(control: f64) -> Self {
        Self { integral: control, ..Self::default() }
    }

    /// The same controller after readings were missing: the integral is kept, the derivative starts anew.
    #[must_use]
    pub fn after_a_hole(self) -> Self {
        Self { last: self.last, ..Self::starting_at(self.integral) }
    }
}

#[cfg(test)]
mod tests;
