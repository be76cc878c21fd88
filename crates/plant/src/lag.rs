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
    if time_constant_s > 0.0 { exp(-dt_s / time_constant_s) } else { 0.0 }
}
