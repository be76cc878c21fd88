//! The first-order lag, exact for any step and any time constant.
//!
//! ```text
//! ds/dt = (x − s) / τ        s(h) = x + (s₀ − x)·e^(−h/τ)  under a constant x
//! ```
//!
//! A difference scheme would blow up where τ is short beside the step; the closed form does not.

use libm::exp;

/// What a step of `dt_s` leaves of a difference: e^(−dt/τ). τ = 0 follows at once.
pub(crate) fn decay(time_constant_s: f64, dt_s: f64) -> f64 {
    // The start of a step is asked for as often as its middle and its end, and needs no exponential.
    match (time_constant_s > 0.0, dt_s == 0.0) {
        (true, true) => 1.0,
        (true, false) => exp(-dt_s / time_constant_s),
        (false, _) => 0.0,
    }
}
