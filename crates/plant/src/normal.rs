//! Normal random numbers, the same bits on every target.
//!
//! ```text
//! n₁ = √(−2·ln u₁)·cos(2π·u₂)     n₂ = √(−2·ln u₁)·sin(2π·u₂)     u₁ in (0, 1], u₂ in [0, 1)
//! ```
//!
//! Box and Muller's transform with `libm`'s functions: the sampling crates call the platform's logarithm,
//! which differs between targets in the last bit. Generator: PCG64 of `rand_pcg`.

use libm::{log, sincos, sqrt};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// A seeded stream of standard normal numbers.
#[derive(Clone, Debug)]
pub struct Normal {
    generator: Pcg64,
    second: Option<f64>,
}

impl Normal {
    /// The stream number `stream` of `seed`; streams of one seed are independent.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut seeder = Pcg64::seed_from_u64(seed);
        let key = (0..stream).fold(seeder.next_u64(), |_, _| seeder.next_u64());
        Self { generator: Pcg64::seed_from_u64(key), second: None }
    }

    /// The next number: mean 0, variance 1.
    #[inline]
    pub fn draw(&mut self) -> f64 {
        if let Some(second) = self.second.take() {
            return second;
        }
        let radius = sqrt(-2.0 * log(1.0 - self.uniform()));
        let angle = std::f64::consts::TAU * self.uniform();
        let (sine, cosine) = sincos(angle);
        self.second = Some(radius * sine);
        radius * cosine
    }

    /// The next number uniform in [0, 1), 53 bits.
    pub fn uniform(&mut self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "53 bits fit a float exactly")]
        let mantissa = (self.generator.next_u64() >> 11) as f64;
        mantissa / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::Normal;

    #[test]
    fn a_hundred_thousand_numbers_have_the_moments_of_a_normal() {
        let mut normal = Normal::new(7, 0);
        let n = 100_000;
        let numbers: Vec<f64> = (0..n).map(|_| normal.draw()).collect();
        let moment = |p: i32| numbers.iter().map(|x| x.powi(p)).sum::<f64>() / f64::from(n);
        // Five standard errors of each estimate: √(var(xᵖ)/n) with var 1, 2, 15, 96.
        for (p, exact, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
            let bound = 5.0 * f64::sqrt(variance / f64::from(n));
            assert!((moment(p) - exact).abs() < bound, "moment {p}: {}", moment(p));
        }
    }

    #[test]
    fn sine_and_cosine_taken_together_are_those_taken_apart_bit_for_bit() {
        // The numbers of a seed must not change with the function that computes them.
        for k in 0..200_000_u32 {
            let angle = std::f64::consts::TAU * f64::from(k) / 200_000.0;
            let together = libm::sincos(angle);
            let apart = (libm::sin(angle), libm::cos(angle));
            assert_eq!((together.0.to_bits(), together.1.to_bits()), (apart.0.to_bits(), apart.1.to_bits()), "{angle}");
        }
    }

    #[test]
    fn one_seed_repeats_and_its_streams_differ() {
        let draw = |seed, stream| {
            let mut normal = Normal::new(seed, stream);
            [normal.draw(), normal.draw(), normal.draw()]
        };
        assert_eq!(draw(1, 0), draw(1, 0));
        assert_ne!(draw(1, 0), draw(1, 1));
        let mut firsts: Vec<u64> = (0..1000).map(|seed| draw(seed, 0)[0].to_bits()).collect();
        firsts.sort_unstable();
        firsts.dedup();
        assert_eq!(firsts.len(), 1000, "every seed has its own numbers");
    }
}
