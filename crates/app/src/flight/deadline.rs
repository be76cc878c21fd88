//! Deadlines on an absolute grid: a late cycle is counted and does not shift the next.
//!
//! ```text
//! deadline k = start + k·period          lateness = wake-up − deadline
//! ```
//!
//! Deadlines that have passed when a cycle ends are skipped and counted as missed: a late loop does not catch up by
//! cycles without time between them.

use super::lateness::Histogram;
use serde::Serialize;

/// The grid, and the statistics of its cycles.
#[derive(Clone, Copy, Debug)]
pub struct Deadlines {
    start_s: f64,
    period_s: f64,
    late_after_s: f64,
    next: f64,
    /// Sum of the lateness of the cycles since the last punctual one, seconds.
    behind_s: f64,
    punctuality: Punctuality,
}

/// Statistics of the cycles' lateness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Punctuality {
    /// Cycles that ran.
    pub cycles: u64,
    /// Cycles that began late by more than the config allows.
    pub late: u64,
    /// Deadlines without a cycle.
    pub missed: u64,
    /// Largest lateness, seconds.
    pub worst_s: f64,
    /// Histogram of the lateness.
    pub lateness: Histogram,
}

impl Deadlines {
    /// A grid whose deadline 0 is `start_s`.
    #[must_use]
    pub fn new(start_s: f64, period_s: f64, late_after_s: f64) -> Self {
        Self { start_s, period_s, late_after_s, next: 0.0, behind_s: 0.0, punctuality: Punctuality::default() }
    }

    /// The deadline to sleep until, seconds.
    #[must_use]
    pub fn next_s(&self) -> f64 {
        self.start_s + self.next * self.period_s
    }

    /// Counts the wake-up at `now_s` and moves on to the first deadline that is still ahead of it.
    /// Returns the lateness, seconds.
    pub fn woke(&mut self, now_s: f64) -> f64 {
        let lateness_s = (now_s - self.next_s()).max(0.0);
        let skipped = (lateness_s / self.period_s).floor();
        self.next += 1.0 + skipped;
        self.behind_s = if skipped > 0.0 { self.behind_s + lateness_s } else { 0.0 };
        let seen = &mut self.punctuality;
        seen.cycles += 1;
        seen.late += u64::from(lateness_s > self.late_after_s);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number that is not negative"
        )]
        {
            seen.missed += skipped as u64;
        }
        seen.worst_s = seen.worst_s.max(lateness_s);
        seen.lateness.count(lateness_s);
        lateness_s
    }

    /// Total lateness of the latest consecutive cycles that each missed a deadline, seconds. It detects a single cycle
    /// that hangs as well as a loop that never keeps up.
    #[must_use]
    pub const fn behind_s(&self) -> f64 {
        self.behind_s
    }

    /// Statistics of the deadlines so far.
    #[must_use]
    pub const fn punctuality(&self) -> Punctuality {
        self.punctuality
    }
}

#[cfg(test)]
mod tests {
    use super::Deadlines;

    #[test]
    fn a_late_tick_is_counted_and_does_not_shift_the_next() {
        let mut deadlines = Deadlines::new(10.0, 0.02, 0.002);
        assert_eq!(deadlines.woke(10.0001), 10.0001 - 10.0);
        assert!((deadlines.woke(10.0250) - 0.005).abs() < 1e-9);
        assert!((deadlines.next_s() - 10.04).abs() < 1e-9);
        let seen = deadlines.punctuality();
        assert_eq!((seen.cycles, seen.late, seen.missed), (2, 1, 0));
        assert!((seen.worst_s - 0.005).abs() < 1e-9);
    }

    #[test]
    fn deadlines_that_passed_are_skipped_and_counted() {
        let mut deadlines = Deadlines::new(0.0, 0.02, 0.002);
        deadlines.woke(0.0);
        deadlines.woke(0.075);
        assert!((deadlines.next_s() - 0.08).abs() < 1e-9, "{}", deadlines.next_s());
        assert_eq!(deadlines.punctuality().missed, 2);
    }

    #[test]
    fn a_loop_falls_behind_by_one_long_pause_or_by_many_short_ones_in_a_row() {
        let mut deadlines = Deadlines::new(0.0, 0.02, 0.002);
        deadlines.woke(0.5);
        assert_eq!(deadlines.behind_s(), 0.5);
        deadlines.woke(deadlines.next_s() + 0.019);
        assert_eq!(deadlines.behind_s(), 0.0);
        for _ in 0..20 {
            deadlines.woke(deadlines.next_s() + 0.025);
        }
        assert!((deadlines.behind_s() - 0.5).abs() < 1e-9, "{}", deadlines.behind_s());
    }

    #[test]
    fn a_million_deadlines_do_not_drift() {
        let mut deadlines = Deadlines::new(0.0, 0.02, 0.002);
        for k in 0..1_000_000_u32 {
            deadlines.woke(f64::from(k) * 0.02 + 1e-4);
        }
        assert!((deadlines.next_s() - 20_000.0).abs() < 1e-6);
        assert_eq!(deadlines.punctuality().late, 0);
    }
}
