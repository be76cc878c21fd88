//! Gain schedule: another gain at another height.
//!
//! ```text
//! gains(h) = factor(h) · gains        straight lines between the rows, held beyond the first and the last
//! ```
//!
//! The fan's force falls with height through leaks and losses, so that the loop's gain does. The integral is kept as
//! its part of the control value, so that a factor that changes does not move it. Source: Åström & Wittenmark,
//! *Adaptive Control*, "Gain scheduling".

use crate::check::{OutOfRange, within};

/// The most rows of a schedule.
pub const MAX_ROWS: usize = 16;

/// A factor over height.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Schedule {
    /// Heights, mm, rising; at most [`MAX_ROWS`].
    pub height_mm: heapless::Vec<f64, MAX_ROWS>,
    /// The factor on the gains at each of them.
    pub factor: heapless::Vec<f64, MAX_ROWS>,
}

impl Schedule {
    /// Checks that heights rise and every factor is sensible.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number that is not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_ROWS")]
        let (rows, factors) = (self.height_mm.len() as f64, self.factor.len() as f64);
        within("length of height_mm", rows, 1.0, MAX_ROWS as f64)?;
        within("length of factor", factors, rows, rows)?;
        let mut lowest = -1e4;
        for height in &self.height_mm {
            within("height_mm", *height, lowest, 1e4)?;
            lowest = height + 1.0;
        }
        self.factor.iter().try_for_each(|factor| within("factor", *factor, 0.05, 20.0))
    }

    /// The factor at `height_mm`.
    #[must_use]
    pub fn factor(&self, height_mm: f64) -> f64 {
        let rows = || self.height_mm.iter().copied().zip(self.factor.iter().copied());
        let mut below = None;
        for (height, factor) in rows() {
            if height_mm < height {
                return below.map_or(factor, |(from_mm, from)| {
                    from + (factor - from) * (height_mm - from_mm) / (height - from_mm)
                });
            }
            below = Some((height, factor));
        }
        below.map_or(1.0, |(_, factor)| factor)
    }
}

#[cfg(test)]
mod tests {
    use super::Schedule;

    fn schedule(heights: &[f64], factors: &[f64]) -> Schedule {
        Schedule { height_mm: heights.iter().copied().collect(), factor: factors.iter().copied().collect() }
    }

    #[test]
    fn the_factor_runs_straight_between_rows_and_is_held_beyond_them() {
        let rows = schedule(&[100.0, 300.0, 500.0], &[0.8, 1.0, 1.6]);
        let got = [0.0, 100.0, 200.0, 300.0, 400.0, 500.0, 900.0].map(|height| rows.factor(height));
        for (got, exact) in got.into_iter().zip([0.8, 0.8, 0.9, 1.0, 1.3, 1.6, 1.6]) {
            assert!((got - exact).abs() < 1e-12, "{got}, exact {exact}");
        }
    }

    #[test]
    fn rows_that_do_not_rise_or_do_not_pair_are_refused() {
        assert_eq!(schedule(&[300.0, 100.0], &[1.0, 1.0]).check().unwrap_err().key, "height_mm");
        assert_eq!(schedule(&[100.0, 300.0], &[1.0]).check().unwrap_err().key, "length of factor");
        assert_eq!(schedule(&[100.0], &[f64::NAN]).check().unwrap_err().key, "factor");
    }
}
