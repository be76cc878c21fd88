//! A share of cases with its Wilson interval.
//!
//! ```text
//! (p + z²/2n ± z·√(p(1−p)/n + z²/4n²)) / (1 + z²/n)      p = count/n, z = 1.96 for 95 %
//! ```
//!
//! Valid at 0 and at n, where the interval from √(p(1−p)/n) has no width.
//! Source: Wilson, JASA 22 (1927); Newcombe, Statistics in Medicine 17 (1998), method 3.

use serde::Serialize;

/// Normal deviate of a two-sided 95 % interval.
const Z: f64 = 1.959_963_984_540_054;

/// A count of cases out of a number of cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Proportion {
    /// Cases that meet the condition.
    pub count: usize,
    /// All cases.
    pub n: usize,
    /// `count / n`; `None` without cases.
    pub share: Option<f64>,
    /// Lower end of the 95 % interval of the share.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Proportion {
    /// `count` of `n`.
    #[must_use]
    pub fn new(count: usize, n: usize) -> Self {
        if n == 0 {
            return Self { count, n, share: None, low: 0.0, high: 1.0 };
        }
        let (p, n_cases, z2) = (count as f64 / n as f64, n as f64, Z * Z);
        let centre = p + z2 / (2.0 * n_cases);
        let half = Z * (p * (1.0 - p) / n_cases + z2 / (4.0 * n_cases * n_cases)).sqrt();
        let end = |end: f64| (end / (1.0 + z2 / n_cases)).clamp(0.0, 1.0);
        Self { count, n, share: Some(p), low: end(centre - half), high: end(centre + half) }
    }

    /// Counts those that are true.
    pub fn of(all: impl IntoIterator<Item = bool>) -> Self {
        let (mut count, mut n) = (0, 0);
        for is_so in all {
            count += usize::from(is_so);
            n += 1;
        }
        Self::new(count, n)
    }
}

#[cfg(test)]
mod tests {
    use super::Proportion;

    #[test]
    fn the_intervals_are_those_of_newcombe_1998() {
        // Table I, method 3.
        for (count, n, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let found = Proportion::new(count, n);
            assert!((found.low - low).abs() < 5e-5 && (found.high - high).abs() < 5e-5, "{found:?}");
        }
    }

    #[test]
    fn nothing_asked_is_nothing_known() {
        let found = Proportion::of([]);
        assert_eq!((found.share, found.low, found.high), (None, 0.0, 1.0));
    }

    #[test]
    fn all_of_a_few_do_not_prove_all() {
        let found = Proportion::of([true; 12]);
        assert_eq!((found.count, found.n, found.high), (12, 12, 1.0));
        assert!((0.75..0.77).contains(&found.low), "{found:?}");
    }
}
