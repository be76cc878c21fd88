//! How long a slow sensor holds its readings, where it refreshes slower than the loop reads.
//!
//! ```text
//! hold = Σ gap_i / Σ n_i      gap_i: time between readings that differ, s; n_i = round(gap_i/hold): refreshes in it
//! ```
//!
//! A refresh that gives the same reading again is hidden in a gap of two holds.

use crate::record::recording::Recording;

/// A hold is at least this many rows long; gaps shorter than this share of it must be rare.
const LEAST_ROWS: f64 = 1.5;
const SHORT: f64 = 0.6;
const RARE: usize = 20;
/// Iterations of counting refreshes and dividing by their number.
const ROUNDS: usize = 4;

/// How long readings are held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hold {
    /// The hold, seconds.
    pub(crate) seconds: f64,
    /// Its standard deviation, seconds: the length of a gap is known to within a row.
    pub(crate) sigma_s: f64,
}

/// The hold that the readings show; `None` if they do not repeat regularly.
pub(crate) fn hold(recording: &Recording) -> Option<Hold> {
    let rows = recording.samples();
    let period_s = recording.duration_s() / recording.readings().max(1) as f64;
    let mut gaps = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    for (time_s, reading) in rows.iter().filter_map(|row| Some((row.time_s, row.position_mm?))) {
        match last {
            Some((_, before)) if before == reading => continue,
            Some((since_s, _)) => gaps.push(time_s - since_s),
            None => {}
        }
        last = Some((time_s, reading));
    }
    gaps.sort_by(f64::total_cmp);
    let mut hold_s = *gaps.get(gaps.len() / 2)?;
    let count = |hold_s: f64| gaps.iter().map(|gap| (gap / hold_s).round().max(1.0)).sum::<f64>();
    for _ in 0..ROUNDS {
        hold_s = gaps.iter().sum::<f64>() / count(hold_s);
    }
    let short = gaps.iter().filter(|gap| **gap < SHORT * hold_s).count();
    let is_hold = hold_s > LEAST_ROWS * period_s && short * RARE < gaps.len();
    is_hold.then(|| Hold { seconds: hold_s, sigma_s: period_s / (6.0 * count(hold_s)).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::hold;
    use crate::tests_support::{model, record};
    use plant::effects::StaleSamples;
    use plant::{Effects, Model};

    #[test]
    fn the_hold_of_a_slow_sensor_is_read_off_its_readings() {
        for hold_s in [0.05, 0.073, 0.1, 0.21] {
            let effects = Effects { stale_samples: Some(StaleSamples { hold_s }), ..model().effects };
            let found = hold(&record(&Model { effects, ..model() }, 3, 60)).unwrap();
            assert!((found.seconds - hold_s).abs() < 3.0 * found.sigma_s, "{found:?} of {hold_s} s");
            assert!(found.sigma_s < 0.02 * hold_s, "{found:?}");
        }
    }

    #[test]
    fn readings_that_differ_from_row_to_row_have_no_hold() {
        assert_eq!(hold(&record(&model(), 3, 60)), None);
    }
}
