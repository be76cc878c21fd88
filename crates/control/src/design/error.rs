//! Why there is no design.

use core::fmt;

/// Why there is no design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DesignError {
    /// The delay is too long for the loop's period.
    DelayTooLong {
        /// The delay, seconds.
        delay_s: f64,
        /// The loop's period, seconds.
        period_s: f64,
        /// Periods at most.
        most: usize,
    },
    /// The input does not reach every state, or the output does not show it.
    OutOfReach,
    /// Poles that are not real and not one of a conjugate pair.
    UnpairedPoles,
    /// The Riccati equation has no stabilising solution.
    NoRiccatiSolution,
    /// The fan's pole leaves no room for the wanted poles.
    NoRoom {
        /// Where the pole that is left over would be, 1/s.
        left_over_per_s: f64,
        /// The sum of the plant's poles, 1/s.
        sum_per_s: f64,
    },
    /// A PID with these poles would need a negative gain.
    NegativeGain {
        /// The gain's name.
        gain: &'static str,
        /// Its value.
        value: f64,
    },
    /// No third pole gives this critical gain.
    NoThirdPole {
        /// The critical gain asked for.
        critical_gain: f64,
    },
    /// An oscillation that does not reach the relay's hysteresis.
    WithinHysteresis {
        /// Amplitude of the oscillation, mm.
        amplitude_mm: f64,
        /// Half width of the hysteresis, mm.
        hysteresis_mm: f64,
    },
    /// The phase asked for is beyond what the rule can give.
    PhaseOutOfReach {
        /// Lead that the controller would have to give, degrees.
        lead_deg: f64,
    },
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DelayTooLong { delay_s, period_s, most } => {
                write!(f, "a delay of {delay_s} s is more than {most} periods of {period_s} s; sample more slowly")
            }
            Self::OutOfReach => f.write_str(
                "the input does not reach every state, or the output does not show it; check that gain and lags are not 0",
            ),
            Self::UnpairedPoles => f.write_str("a complex pole without its conjugate; give both, a + bi and a - bi"),
            Self::NoRiccatiSolution => f.write_str(
                "the Riccati equation has no stabilising solution; give every integrator a weight or a noise above 0",
            ),
            Self::NoRoom { left_over_per_s, sum_per_s } => write!(
                f,
                "the plant's poles sum to -{sum_per_s:.3} 1/s, which leaves {left_over_per_s:.3} 1/s for the last one; \
                 ask for a slower or less damped pair"
            ),
            Self::NegativeGain { gain, value } => {
                write!(f, "these poles need {gain} = {value:.6}, which is below 0; ask for faster or better damped poles")
            }
            Self::NoThirdPole { critical_gain } => {
                write!(f, "no third pole gives the critical gain {critical_gain}; check gain and drag of the model")
            }
            Self::WithinHysteresis { amplitude_mm, hysteresis_mm } => write!(
                f,
                "the oscillation of {amplitude_mm:.2} mm does not reach the hysteresis of {hysteresis_mm:.2} mm; \
                 make the relay's step larger"
            ),
            Self::PhaseOutOfReach { lead_deg } => write!(
                f,
                "the controller would have to lead by {lead_deg:.0}°, and a PID gives less than 90°; ask for less phase margin"
            ),
        }
    }
}

impl core::error::Error for DesignError {}
