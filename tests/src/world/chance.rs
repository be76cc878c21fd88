//! Reproducible random numbers: a stream depends on seed, case and purpose only.
//!
//! SplitMix64 (Steele, Lea, Flood 2014), started from a SHA-256. The distributions are not normal on purpose: a model
//! that assumes normal distributions must not gain from that alone.

use sha2::{Digest, Sha256};

/// The source of the streams of one case.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// Names the whole set.
    pub(crate) seed: String,
    /// Number of the case in the set.
    pub(crate) case: usize,
}

impl Source {
    /// The stream for one purpose. A second call gives the same stream from its start.
    pub(crate) fn stream(&self, purpose: &str) -> Chance {
        let digest = Sha256::digest(format!("{}\n{}\n{purpose}", self.seed, self.case));
        Chance(digest.iter().take(8).fold(0, |bits, &byte| bits << 8 | u64::from(byte)))
    }
}

/// One stream.
#[derive(Clone, Debug)]
pub(crate) struct Chance(u64);

impl Chance {
    /// Uniform in 0 to 1, never 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the logarithm: as many small as large ones.
    pub(crate) fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// True with this probability.
    pub(crate) fn happens(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// +1 or −1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.happens(0.5) { 1.0 } else { -1.0 }
    }

    /// One of these.
    pub(crate) fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[(self.unit() * from.len() as f64) as usize]
    }

    /// Sum of three uniforms, variance 1: lighter tails than normal.
    pub(crate) fn hump(&mut self) -> f64 {
        (self.unit() + self.unit() + self.unit() - 1.5) * 2.0
    }

    /// Logistic, variance 1: tails a little heavier than normal.
    pub(crate) fn logistic(&mut self) -> f64 {
        let u = self.unit().max(1e-12);
        (u / (1.0 - u)).ln() * 3.0_f64.sqrt() / std::f64::consts::PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shapes_have_mean_zero_and_variance_one() {
        let mut chance = Source { seed: "shapes".into(), case: 0 }.stream("test");
        for shape in [Chance::hump, Chance::logistic] {
            let draws: Vec<f64> = (0..200_000).map(|_| shape(&mut chance)).collect();
            let mean = draws.iter().sum::<f64>() / draws.len() as f64;
            let variance = draws.iter().map(|x| x * x).sum::<f64>() / draws.len() as f64;
            assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.02, "{mean}, {variance}");
        }
    }

    #[test]
    fn a_stream_is_its_seed_its_case_and_its_purpose() {
        let first = |seed: &str, case, purpose| Source { seed: seed.into(), case }.stream(purpose).unit();
        assert_eq!(first("a", 1, "air"), first("a", 1, "air"));
        assert!(first("a", 1, "air") != first("a", 1, "sensor"));
        assert!(first("a", 1, "air") != first("a", 2, "air") && first("a", 1, "air") != first("b", 1, "air"));
    }
}
