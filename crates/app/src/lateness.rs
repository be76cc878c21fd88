//! How late the cycles began, as a histogram: counts in fixed steps, without memory that grows.
//!
//! ```text
//! step k:   edge[k−1] < lateness ≤ edge[k]      10 µs to 100 ms, three steps a decade; the last one is open
//! ```
//!
//! A quantile is the upper edge of its step: at most 2.5 times too large, never too small.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Upper edges of the steps, microseconds.
const EDGES_US: [f64; 13] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3, 20e3, 50e3, 100e3];

/// The counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Histogram {
    counts: [u64; EDGES_US.len() + 1],
}

/// What a person asks of a histogram, microseconds; where a quantile lies beyond 100 ms it is the largest lateness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Half of the cycles are not later.
    pub p50_us: f64,
    /// 99 in 100 are not.
    pub p99_us: f64,
    /// 999 in 1000 are not.
    pub p99_9_us: f64,
    /// None is.
    pub max_us: f64,
}

impl fmt::Display for Quantiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { p50_us, p99_us, p99_9_us, max_us } = self;
        write!(
            f,
            "half within {p50_us:.0} µs, 99 % within {p99_us:.0} µs, 99.9 % within {p99_9_us:.0} µs, all within {max_us:.0} µs"
        )
    }
}

impl Histogram {
    /// Counts a cycle.
    pub fn count(&mut self, lateness_s: f64) {
        let step = EDGES_US.iter().position(|edge_us| lateness_s * 1e6 <= *edge_us).unwrap_or(EDGES_US.len());
        self.counts[step] += 1;
    }

    /// The quantiles, where the largest lateness was `worst_s`.
    #[must_use]
    pub fn quantiles(&self, worst_s: f64) -> Quantiles {
        let max_us = 1e6 * worst_s;
        let total: u64 = self.counts.iter().sum();
        let quantile = |per_mille: u64| {
            let mut below = 0;
            let step = self.counts.iter().position(|count| {
                below += count;
                below * 1000 >= total * per_mille
            });
            step.and_then(|step| EDGES_US.get(step)).map_or(max_us, |edge_us| edge_us.min(max_us))
        };
        Quantiles { p50_us: quantile(500), p99_us: quantile(990), p99_9_us: quantile(999), max_us }
    }
}

#[cfg(test)]
mod tests {
    use super::Histogram;

    #[test]
    fn quantiles_are_the_upper_edges_of_their_steps() {
        let mut histogram = Histogram::default();
        (0..900).for_each(|_| histogram.count(30e-6));
        (0..95).for_each(|_| histogram.count(150e-6));
        (0..4).for_each(|_| histogram.count(3e-3));
        histogram.count(0.25);
        let quantiles = histogram.quantiles(0.25);
        assert_eq!((quantiles.p50_us, quantiles.p99_us, quantiles.p99_9_us), (50.0, 200.0, 5000.0));
        assert_eq!(quantiles.max_us, 250_000.0);
    }

    #[test]
    fn no_quantile_is_beyond_the_largest_and_none_of_nothing_is_anything() {
        let mut histogram = Histogram::default();
        assert_eq!(histogram.quantiles(0.0).p99_us, 0.0);
        histogram.count(12e-6);
        assert_eq!(histogram.quantiles(12e-6).p50_us, 12.0);
    }
}
