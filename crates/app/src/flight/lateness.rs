//! Lateness of the cycles as a histogram: counts in fixed steps, with constant memory.
//!
//! ```text
//! step k:   edge[k−1] < lateness ≤ edge[k]      10 µs to 100 ms, three steps a decade; the last one is open
//! ```
//!
//! A quantile is the upper edge of its step: at most 2.5 times too large above the first step, never too small.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Upper edges of the steps, microseconds.
const EDGES_US: [f64; 13] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3, 20e3, 50e3, 100e3];
const STEPS: usize = EDGES_US.len() + 1;

/// The counts, and the largest lateness. Other modules read it as [`Lateness`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(into = "Lateness")]
pub struct Histogram {
    counts: [u64; STEPS],
    max_us: f64,
}

/// What a person asks of a histogram, microseconds; where a quantile lies beyond 100 ms it is the largest lateness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
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

/// A histogram as it leaves the program: with its edges, so that nobody has to know them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Lateness {
    /// What a person asks of it.
    #[serde(flatten)]
    pub quantiles: Quantiles,
    /// Upper edges of the steps, microseconds. The last step has none.
    pub edges_us: Vec<f64>,
    /// Cycles in each step: one more than there are edges.
    pub counts: Vec<u64>,
}

impl From<Histogram> for Lateness {
    fn from(histogram: Histogram) -> Self {
        Self { quantiles: histogram.quantiles(), edges_us: EDGES_US.to_vec(), counts: histogram.counts.to_vec() }
    }
}

impl fmt::Display for Histogram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Quantiles { p50_us, p99_us, p99_9_us, max_us } = self.quantiles();
        write!(
            f,
            "half within {p50_us:.0} µs, 99 % within {p99_us:.0} µs, 99.9 % within {p99_9_us:.0} µs, all within {max_us:.0} µs"
        )
    }
}

impl Histogram {
    /// Counts a cycle.
    pub fn count(&mut self, lateness_s: f64) {
        let late_us = 1e6 * lateness_s;
        let step = EDGES_US.iter().position(|edge_us| late_us <= *edge_us).unwrap_or(EDGES_US.len());
        self.counts[step] += 1;
        self.max_us = self.max_us.max(late_us);
    }

    /// Whether any cycle was late: in virtual time none is.
    #[must_use]
    pub fn says_something(&self) -> bool {
        self.max_us > 0.0
    }

    /// The quantiles.
    #[must_use]
    pub fn quantiles(&self) -> Quantiles {
        let max_us = self.max_us;
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
    use super::{Histogram, Lateness};

    #[test]
    fn all_counts_leave_the_program_with_their_edges() {
        let mut histogram = Histogram::default();
        [5e-6, 10e-6, 30e-6, 0.25].into_iter().for_each(|lateness_s| histogram.count(lateness_s));
        let text = serde_json::to_string(&histogram).unwrap();
        let read: Lateness = serde_json::from_str(&text).unwrap();
        assert_eq!((read.counts.len(), read.edges_us.len(), read.quantiles), (14, 13, histogram.quantiles()));
        assert_eq!((read.counts[0], read.counts[2], read.counts[13]), (2, 1, 1));
        assert_eq!((read.edges_us[0], read.edges_us[12], read.counts.iter().sum::<u64>()), (10.0, 100e3, 4));
    }

    #[test]
    fn quantiles_are_the_upper_edges_of_their_steps() {
        let mut histogram = Histogram::default();
        (0..900).for_each(|_| histogram.count(30e-6));
        (0..95).for_each(|_| histogram.count(150e-6));
        (0..4).for_each(|_| histogram.count(3e-3));
        histogram.count(0.25);
        let quantiles = histogram.quantiles();
        assert_eq!((quantiles.p50_us, quantiles.p99_us, quantiles.p99_9_us), (50.0, 200.0, 5000.0));
        assert_eq!(quantiles.max_us, 250_000.0);
    }

    #[test]
    fn no_quantile_is_beyond_the_largest_and_none_of_nothing_is_anything() {
        let mut histogram = Histogram::default();
        assert_eq!(histogram.quantiles().p99_us, 0.0);
        histogram.count(12e-6);
        assert_eq!(histogram.quantiles().p50_us, 12.0);
    }
}
