//! Rounding to a grid.

use libm::round;

/// The nearest multiple of `step`, halves away from zero; a step of 0 rounds nothing.
pub(crate) fn rounded(step: f64, value: f64) -> f64 {
    if step > 0.0 { step * round(value / step) } else { value }
}
