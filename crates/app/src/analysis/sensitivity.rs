//! Peak of the sensitivity: the distance of a loop to instability in one number.
//!
//! ```text
//! M_s = max over ω of 1 / |1 + L(iω)|          L: the open loop
//! ```
//!
//! 1 / M_s is the smallest distance of the Nyquist curve to −1. Åström and Murray, *Feedback Systems*, section 13.2:
//! 1.2 to 2 is usual.

use control::design::{Plane, Transfer};
use std::f64::consts::PI;

/// Frequencies of the search, rad/s; of a sampled loop up to half of the sampling frequency.
const LOWEST: f64 = 1e-3;
const HIGHEST: f64 = 1e4;
/// Frequencies tried, at equal ratios: the peak is found to better than 0.1 %.
const STEPS: i32 = 4000;

/// The peak of the sensitivity of a stable loop with this open loop.
#[must_use]
pub fn peak(open: &Transfer) -> f64 {
    let highest = match open.plane {
        Plane::Continuous => HIGHEST,
        Plane::Sampled(period_s) => PI / period_s,
    };
    let at = |step: i32| LOWEST * (highest / LOWEST).powf(f64::from(step) / f64::from(STEPS));
    let distance = |omega: f64| {
        let response = open.response(omega);
        (1.0 + response.re).hypot(response.im)
    };
    (0..=STEPS).map(|step| distance(at(step)).recip()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::peak;
    use control::design::Linear;

    #[test]
    fn the_peak_of_a_second_order_loop_is_that_of_its_closed_form() {
        // L = ω²/(s·(s + 2ζω)); with x = (frequency/ω)², |S|² = x·(x + 4ζ²) / ((1 − x)² + 4ζ²x).
        for damping in [0.3_f64, 0.5, 0.7] {
            let (omega, four) = (3.0_f64, 4.0 * damping * damping);
            let square = |x: f64| x * (x + four) / ((1.0 - x).powi(2) + four * x);
            let exact = (1..100_000).map(|k| square(f64::from(k) * 1e-4)).fold(0.0, f64::max).sqrt();
            let open = Linear::two_poles(omega * omega, 2.0 * damping * omega).continuous();
            let found = peak(&open);
            assert!((found / exact - 1.0).abs() < 1e-3, "{found}, exact {exact}");
        }
    }
}
