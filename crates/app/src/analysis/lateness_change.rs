//! Whether the cycles of one flight began later than those of another by more than chance.
//!
//! ```text
//! q_i      95 % quantile of the lateness in block i of a flight, ms        10 blocks a flight
//! z        (mean q_after − mean q_before) / √(s²_before/10 + s²_after/10)
//! ```
//!
//! Latenesses of neighbouring cycles have causes in common; blocks are nearly independent.

use serde::Serialize;

/// Blocks of a flight.
const BLOCKS: usize = 10;
/// The quantile of a block.
const SHARE: f64 = 0.95;
/// Standard deviations of a difference that chance does not make: 3.5 of Student's t with some ten degrees of freedom
/// is 1 in 200.
const BEYOND: f64 = 3.5;

/// The lateness of the cycles of two flights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LatenessChange {
    /// 95 % of the cycles before began no later than this, ms: mean over the blocks.
    pub before_ms: f64,
    /// The same after.
    pub after_ms: f64,
    /// Standard deviation of the difference, ms.
    pub deviation_ms: f64,
    /// Whether the difference is larger than chance makes it.
    pub is_beyond_chance: bool,
}

impl LatenessChange {
    /// Of the latenesses of the cycles of two flights, seconds; `None`: one of them has too few cycles.
    #[must_use]
    pub fn of(before: &[f64], after: &[f64]) -> Option<Self> {
        let ((before_ms, a), (after_ms, b)) = (blocks(before)?, blocks(after)?);
        let deviation_ms = a.hypot(b);
        let is_beyond_chance = (after_ms - before_ms).abs() > BEYOND * deviation_ms;
        Some(Self { before_ms, after_ms, deviation_ms, is_beyond_chance })
    }
}

/// Mean of the blocks' quantiles, and its standard deviation, ms.
fn blocks(cycles: &[f64]) -> Option<(f64, f64)> {
    let length = cycles.len() / BLOCKS;
    if length < BLOCKS {
        return None;
    }
    let quantile = |block: &[f64]| {
        let mut late: Vec<f64> = block.iter().map(|late_s| 1e3 * late_s).collect();
        late.sort_by(f64::total_cmp);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length")]
        let at = (SHARE * (late.len() - 1) as f64) as usize;
        late[at]
    };
    let all: Vec<f64> = cycles.chunks_exact(length).take(BLOCKS).map(quantile).collect();
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    let variance = all.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Some((mean, (variance / count).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::LatenessChange;

    fn cycles(late_s: f64, seed: u32) -> Vec<f64> {
        let jitter = |k: u32| f64::from((k * 7919 + seed * 104_729) % 1000) * 1e-6;
        (0..3000).map(|k| late_s + jitter(k)).collect()
    }

    #[test]
    fn a_later_clock_is_seen_and_the_jitter_of_the_same_one_is_not() {
        let same = LatenessChange::of(&cycles(1e-4, 1), &cycles(1e-4, 2)).unwrap();
        assert!(!same.is_beyond_chance, "{same:?}");
        let later = LatenessChange::of(&cycles(1e-4, 1), &cycles(6e-4, 2)).unwrap();
        assert!(later.is_beyond_chance && (later.after_ms - later.before_ms - 0.5).abs() < 0.05, "{later:?}");
        assert_eq!(LatenessChange::of(&[], &cycles(0.0, 1)), None);
    }
}
