//! A value and its 90 % interval.
//!
//! ```text
//! χ²_ν ≈ ν·(1 − 2/9ν + x·√(2/9ν))³       x: normal quantile
//! ```
//!
//! Source: Abramowitz & Stegun, *Handbook of Mathematical Functions*, 26.4.17.

use crate::stats::student::{NORMAL_QUANTILE, student};
use serde::Serialize;

/// A value with its 90 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Estimate {
    /// A value with a normal error of this standard deviation.
    #[must_use]
    pub fn normal(value: f64, deviation: f64) -> Self {
        Self { value, low: value - NORMAL_QUANTILE * deviation, high: value + NORMAL_QUANTILE * deviation }
    }

    /// The same if the standard deviation was estimated with so many degrees of freedom.
    #[must_use]
    pub fn student(value: f64, deviation: f64, freedom: f64) -> Self {
        let t = student(freedom);
        Self { value, low: value - t * deviation, high: value + t * deviation }
    }

    /// The mean of independent values; `None` for fewer than three.
    #[must_use]
    pub fn of_mean(values: &[f64]) -> Option<Self> {
        if values.len() < 3 {
            return None;
        }
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Some(Self::student(mean, (variance / n).sqrt(), n - 1.0))
    }

    /// A standard deviation that was estimated with so many degrees of freedom.
    #[must_use]
    pub fn of_deviation(deviation: f64, freedom: f64) -> Self {
        let bound = |x: f64| deviation * (freedom / chi_square(freedom, x)).sqrt();
        Self { value: deviation, low: bound(NORMAL_QUANTILE), high: bound(-NORMAL_QUANTILE) }
    }

    /// Linear function of value and ends: `scale·x + offset`.
    #[must_use]
    pub fn mapped(self, scale: f64, offset: f64) -> Self {
        let [value, a, b] = [self.value, self.low, self.high].map(|x| scale * x + offset);
        Self { value, low: a.min(b), high: a.max(b) }
    }

    /// Whether the interval contains `truth`.
    #[must_use]
    pub fn holds(&self, truth: f64) -> bool {
        self.low <= truth && truth <= self.high
    }
}

fn chi_square(freedom: f64, x: f64) -> f64 {
    let ninth = 2.0 / (9.0 * freedom);
    freedom * (1.0 - ninth + x * ninth.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::{NORMAL_QUANTILE, chi_square};

    #[test]
    fn the_quantiles_are_those_of_the_tables() {
        for (freedom, low, high) in [(10.0, 3.940, 18.307), (50.0, 34.764, 67.505)] {
            let [found_low, found_high] = [-NORMAL_QUANTILE, NORMAL_QUANTILE].map(|x| chi_square(freedom, x));
            assert!((found_low / low - 1.0).abs() < 5e-3 && (found_high / high - 1.0).abs() < 2e-3, "{found_low}");
        }
    }
}
