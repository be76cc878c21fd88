//! The sum of numbers that are given by their logarithms.

/// ln(eᵃ + eᵇ).
pub(crate) fn log_sum(a: f64, b: f64) -> f64 {
    a.max(b) + (-(a - b).abs()).exp().ln_1p()
}
