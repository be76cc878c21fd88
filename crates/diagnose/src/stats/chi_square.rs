//! The tail probability of the χ² distribution, in closed form.
//!
//! ```text
//! Q(n, x) = Γ(n/2, x/2)/Γ(n/2)             Γ(a + 1, x) = a·Γ(a, x) + xᵃ·e⁻ˣ
//! Q(2, x) = e^(−x/2), Q(1, x) = erfc(√(x/2))
//! ```
//!
//! Source: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 6.5.22, 26.4.4, 26.4.5 and 26.4.19.

use crate::stats::log_sum::log_sum;

/// The probability that a χ² variable with `degrees` degrees of freedom is `x` or more; 1 for 0 degrees.
pub(crate) fn survival(degrees: usize, x: f64) -> f64 {
    if degrees == 0 || x.is_nan() || x <= 0.0 { 1.0 } else { ln_chance(x, degrees).exp().min(1.0) }
}

/// ln of that probability for `m` degrees of freedom, at least 1, and `x` above 0: by its finite sums, of
/// logarithms, so that nothing overflows or underflows.
pub(crate) fn ln_chance(x: f64, m: usize) -> f64 {
    let half = 0.5 * x;
    let (mut ln_sum, mut ln_term, first) = if m.is_multiple_of(2) {
        (f64::NEG_INFINITY, 0.0, 1.0)
    } else {
        (scaled_erfc(half.sqrt()).ln(), (2.0 * (half / std::f64::consts::PI).sqrt()).ln(), 1.5)
    };
    for k in 0..m / 2 {
        ln_sum = log_sum(ln_sum, ln_term);
        ln_term += (half / (k as f64 + first)).ln();
    }
    ln_sum - half
}

/// exp(x²)·erfc(x), beyond 5 by its asymptotic series.
fn scaled_erfc(x: f64) -> f64 {
    if x < 5.0 {
        return (x * x).exp() * libm::erfc(x);
    }
    let by = 0.5 / (x * x);
    (1.0 - by * (1.0 - 3.0 * by * (1.0 - 5.0 * by))) / (x * std::f64::consts::PI.sqrt())
}

#[cfg(test)]
mod tests {
    use super::{ln_chance, survival};

    #[test]
    fn the_published_quantiles_have_their_published_chances() {
        // Abramowitz and Stegun, table 26.8.
        for (degrees, x, chance) in
            [(1, 3.84146, 0.05), (2, 5.99146, 0.05), (3, 11.3449, 0.01), (10, 18.3070, 0.05), (25, 37.6525, 0.05)]
        {
            assert!((survival(degrees, x) - chance).abs() < 1e-5, "{degrees}: {}", survival(degrees, x));
        }
        assert_eq!(survival(0, 3.0), 1.0);
        assert_eq!(survival(5, 0.0), 1.0);
    }

    #[test]
    fn of_many_degrees_of_freedom_the_chance_is_wilsons_and_hilfertys_and_in_the_far_tail_it_vanishes() {
        // The cube root of a χ² variable over its degrees of freedom is nearly normal, Abramowitz and Stegun 26.4.17.
        for degrees in [999, 1000, 1001, 20_000] {
            let (n, spread) = (degrees as f64, (2.0 / (9.0 * degrees as f64)).sqrt());
            for deviations in [-2.0, 0.0, 2.0, 4.0] {
                let x = n + deviations * (2.0 * n).sqrt();
                let z = ((x / n).cbrt() - 1.0 + spread * spread) / spread;
                let normal = 0.5 * libm::erfc(z / std::f64::consts::SQRT_2);
                let found = survival(degrees, x);
                assert!((found / normal - 1.0).abs() < 5e-3, "{degrees}, {deviations}: {found} and {normal}");
            }
        }
        for (degrees, x) in [(1000, 1600.0), (800, 1800.0), (400, 5500.0)] {
            assert!(survival(degrees, x) < 1e-20, "{degrees}, {x}: {}", survival(degrees, x));
        }
    }

    #[test]
    fn the_chance_is_that_of_the_tables() {
        // Quantiles of χ² at 5 %, 1 % and 0.1 %: Abramowitz and Stegun, table 26.8.
        for (m, x, p) in [
            (1, 3.84146, 0.05),
            (2, 5.99147, 0.05),
            (3, 7.81473, 0.05),
            (4, 9.48773, 0.05),
            (5, 11.0705, 0.05),
            (6, 12.5916, 0.05),
            (1, 6.63490, 0.01),
            (3, 11.3449, 0.01),
            (6, 16.8119, 0.01),
            (5, 20.515, 0.001),
        ] {
            assert!((ln_chance(x, m).exp() / p - 1.0).abs() < 2e-4, "{m} {x}: {}", ln_chance(x, m).exp());
        }
        // Far out in the tail ln of it does not underflow: it falls by a little less than half of the increase of x.
        let fall = ln_chance(4000.0, 3) - ln_chance(4002.0, 3);
        assert!((0.999..1.0).contains(&fall), "{fall}");
    }
}
