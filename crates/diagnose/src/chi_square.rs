//! The chance of a χ² as large as the one found, in closed form.
//!
//! ```text
//! Q(n, x) = Γ(n/2, x/2)/Γ(n/2)        Γ(a + 1, x) = a·Γ(a, x) + xᵃ·e⁻ˣ        Q(2, x) = e^(−x/2), Q(1, x) = erfc(√(x/2))
//! ```
//!
//! Source: Abramowitz and Stegun, *Handbook of Mathematical Functions*, 6.5.22 and 26.4.19.

/// The chance that a χ² of so many degrees of freedom is `x` or more. 1 without any.
pub(crate) fn survival(degrees: usize, x: f64) -> f64 {
    if degrees == 0 || x.is_nan() || x <= 0.0 {
        return 1.0;
    }
    let half = 0.5 * x;
    let (mut chance, mut order) =
        if degrees.is_multiple_of(2) { (libm::exp(-half), 1.0) } else { (libm::erfc(half.sqrt()), 0.5) };
    while 2.0 * order < degrees as f64 - 0.5 {
        chance += libm::exp(order * half.ln() - half - libm::lgamma(order + 1.0));
        order += 1.0;
    }
    chance.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::survival;

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
}
