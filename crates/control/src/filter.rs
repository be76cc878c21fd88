//! The discrete derivative filter: the rate of change of a noisy signal, over irregular samples.
//!
//! ```text
//! u_d[n] = e^(−N·T/T_d) · u_d[n−1] + N · (x[n] − x[n−1])        T: time since the last sample, s
//! F(z)   = N · (1 − z⁻¹) / (1 − e^(−N·T/T_d) · z⁻¹)             ≈ T_d·s / (1 + T_d·s/N)
//! ```
//!
//! Its output is T_d·dx/dt, in the units of x: on a ramp of slope c it settles at about c·T_d.
//! Source: the thesis, section 4.1.1. Erratum: its equation 4.1.1.2 prints the denominator without
//! z⁻¹, which is not the filter that its code computes; this is the recursion of the code.

use libm::exp;

/// The filter's state between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DerivativeFilter {
    output: f64,
    last: Option<f64>,
}

impl DerivativeFilter {
    /// Takes the sample `x`, `dt_s` after the last one, and returns T_d·dx/dt.
    ///
    /// `td_s` is T_d and `n` the ratio of T_d to the filter's time constant. The first sample gives 0.
    pub fn step(&mut self, x: f64, dt_s: f64, td_s: f64, n: f64) -> f64 {
        let change = x - self.last.unwrap_or(x);
        self.last = Some(x);
        // T_d = 0 switches the derivative off: the memory fades at once and nothing is added.
        self.output = if td_s > 0.0 { exp(-n * dt_s / td_s) * self.output + n * change } else { 0.0 };
        self.output
    }

    /// Replaces what the filter holds, so that a change of T_d does not jump.
    pub(crate) const fn rescale(&mut self, output: f64) {
        self.output = output;
    }
}

#[cfg(test)]
mod tests {
    use super::{DerivativeFilter, exp};

    const TD: f64 = 0.3;
    const N: f64 = 10.0;
    const T: f64 = 0.018;

    #[test]
    fn step_response_decays_by_the_closed_form() {
        let mut filter = DerivativeFilter::default();
        filter.step(0.0, T, TD, N);
        for k in 0..50 {
            let got = filter.step(1.0, T, TD, N);
            let exact = N * exp(-N * T * f64::from(k) / TD);
            assert!((got - exact).abs() < 1e-12 * N, "sample {k}: {got}, exact {exact}");
        }
    }

    #[test]
    fn a_ramp_settles_at_the_dc_gain_of_the_transfer_function() {
        let mut filter = DerivativeFilter::default();
        let slope = 100.0;
        let mut got = 0.0;
        for k in 0..400 {
            got = filter.step(slope * T * f64::from(k), T, TD, N);
        }
        // F on a ramp of c·T a sample: N·c·T / (1 − e^(−N·T/T_d)).
        let exact = N * slope * T / (1.0 - exp(-N * T / TD));
        assert!((got - exact).abs() < 1e-9, "{got}, exact {exact}");
    }

    #[test]
    fn the_first_sample_gives_no_kick() {
        assert_eq!(DerivativeFilter::default().step(400.0, T, TD, N), 0.0);
    }

    #[test]
    fn no_derivative_time_is_no_derivative() {
        let mut filter = DerivativeFilter::default();
        filter.step(0.0, T, 0.0, N);
        assert_eq!(filter.step(5.0, T, 0.0, N), 0.0);
    }
}
