//! How long a slow sensor holds its readings, where it refreshes slower than the loop reads.
//!
//! ```text
//! hold = Σ gap_i / Σ n_i                      gap_i: time between readings that differ, s
//!                                             n_i = round(gap_i/hold): refreshes in it
//! C(h) = mean of cos(2π·gap_i/h)              of coarse readings: hold = argmax C(h)
//! C(hold) ≥ cos(π·row/hold)                   a gap is a multiple of the hold to within half a row
//! ```
//!
//! A refresh that gives the same reading again is hidden in a gap of several holds. Of fine readings most gaps are one
//! hold, so that the median begins the count, and gaps shorter than the hold are rare. Coarse readings hide most
//! refreshes, and repeat without a hold as well, but then the gaps are no multiples of one time.
//! Source: Mardia and Jupp, "Directional statistics" (2000), chapter 2: the mean resultant of directions whose mean is
//! known.

use crate::record::recording::Recording;
use std::f64::consts::{PI, TAU};

/// A hold is at least this many rows long.
const LEAST_ROWS: f64 = 1.5;
/// Of fine readings, gaps shorter than this share of the hold are rare: less than one in so many.
const SHORT: f64 = 0.6;
const RARE: usize = 20;
/// The loop sees a refresh up to a row late, and a tenth for the jitter of the clocks: of a hold below two rows, gaps
/// that differ from it by more are as rare.
const SEEN_LATE_ROWS: f64 = 1.1;
/// A hold beneath coarse readings is at least this many rows long: a shorter one is an alias of a longer one.
const LEAST_ROWS_OF_COARSE: f64 = 2.0;
/// Fewest gaps that show such a hold, and the share of the mean cosine above that real clocks keep: they wander. These
/// numbers and those below are chosen by hand: a wrong hold gains no log-likelihood, and is not named.
const FEWEST: usize = 50;
const SHARE: f64 = 0.75;
/// Shortest gap that counts: a share of all gaps are shorter. Gaps longer than so many of it are left out.
const SHORTER: usize = 20;
const LONGEST: f64 = 8.0;
/// The holds that are tried reach up to so many shortest gaps, in steps of this share. Of those whose mean cosine is at
/// least this share of the largest, the longest is the hold: of a clock in step with the loop, each part of it has one
/// as large.
const BEYOND: f64 = 1.5;
const STEP: f64 = 0.004;
const AS_REGULAR: f64 = 0.95;
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
    let row_s = recording.mean_reading_period_s();
    let mut gaps = gaps(recording);
    gaps.sort_by(f64::total_cmp);
    // Regular gaps are multiples of the hold for coarse and fine readings alike; of a clock that wanders, or a hold
    // below two rows, they are not.
    of_coarse(&gaps, row_s).or_else(|| of_fine(&gaps, row_s))
}

/// The times between readings that differ, seconds.
fn gaps(recording: &Recording) -> Vec<f64> {
    let mut gaps = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    let readings = recording.samples().iter().filter_map(|row| Some((row.time_s, row.position_mm?)));
    for (time_s, reading) in readings {
        match last {
            Some((_, before)) if before == reading => continue,
            Some((since_s, _)) => gaps.push(time_s - since_s),
            None => {}
        }
        last = Some((time_s, reading));
    }
    gaps
}

/// The hold of fine readings, from gaps by rising length.
fn of_fine(gaps: &[f64], row_s: f64) -> Option<Hold> {
    let hold = counted(gaps, *gaps.get(gaps.len() / 2)?, row_s);
    let late_s = SEEN_LATE_ROWS * row_s;
    let (least_s, most_s) = if hold.seconds < LEAST_ROWS_OF_COARSE * row_s {
        (hold.seconds - late_s, hold.seconds + late_s)
    } else {
        (SHORT * hold.seconds, f64::INFINITY)
    };
    let usual = gaps.partition_point(|gap| *gap < most_s) - gaps.partition_point(|gap| *gap < least_s);
    (hold.seconds > LEAST_ROWS * row_s && (gaps.len() - usual) * RARE < gaps.len()).then_some(hold)
}

/// The hold beneath coarse readings, from gaps by rising length.
fn of_coarse(gaps: &[f64], row_s: f64) -> Option<Hold> {
    let shortest = *gaps.get(gaps.len() / SHORTER)?;
    let gaps = &gaps[..gaps.partition_point(|gap| *gap < LONGEST * shortest)];
    let (cosine, hold_s) = most_regular(gaps, LEAST_ROWS_OF_COARSE * row_s, BEYOND * shortest)?;
    let is_regular = gaps.len() >= FEWEST && cosine >= SHARE * (PI * row_s / hold_s).cos();
    is_regular.then(|| counted(gaps, hold_s, row_s))
}

/// The hold near `hold_s`: the gaps over the refreshes in them.
fn counted(gaps: &[f64], mut hold_s: f64, row_s: f64) -> Hold {
    let count = |hold_s: f64| gaps.iter().map(|gap| (gap / hold_s).round().max(1.0)).sum::<f64>();
    for _ in 0..ROUNDS {
        hold_s = gaps.iter().sum::<f64>() / count(hold_s);
    }
    Hold { seconds: hold_s, sigma_s: row_s / (6.0 * count(hold_s)).sqrt() }
}

/// The hold of which the gaps are multiples most nearly, with its mean cosine; `None` if no hold is that long.
fn most_regular(gaps: &[f64], least_s: f64, most_s: f64) -> Option<(f64, f64)> {
    let cosine = |hold_s: f64| gaps.iter().map(|gap| (TAU * gap / hold_s).cos()).sum::<f64>() / gaps.len() as f64;
    let holds = std::iter::successors(Some(least_s), |hold_s| Some(hold_s * (1.0 + STEP)));
    // Equal times have no row and no end.
    let holds = holds.take_while(|hold_s| *hold_s < most_s).filter(|_| least_s > 0.0);
    let all: Vec<(f64, f64)> = holds.map(|hold_s| (cosine(hold_s), hold_s)).collect();
    let best = all.iter().map(|(cosine, _)| *cosine).fold(f64::MIN, f64::max);
    all.into_iter().rev().find(|(cosine, _)| *cosine >= AS_REGULAR * best)
}

#[cfg(test)]
mod tests {
    use super::hold;
    use crate::tests_support::{model, record};
    use plant::effects::{SensorQuantisation, StaleSamples};
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
    fn a_hold_of_less_than_two_rows_is_found() {
        for hold_s in [0.033, 0.036, 0.039] {
            let effects = Effects { stale_samples: Some(StaleSamples { hold_s }), ..model().effects };
            let found = hold(&record(&Model { effects, ..model() }, 3, 60)).unwrap();
            assert!((found.seconds - hold_s).abs() < 3.0 * found.sigma_s, "{found:?} of {hold_s} s");
        }
    }

    #[test]
    fn readings_that_differ_from_row_to_row_have_no_hold() {
        assert_eq!(hold(&record(&model(), 3, 60)), None);
    }

    #[test]
    fn a_hold_is_found_beneath_coarse_readings_and_coarse_readings_alone_have_none() {
        for step_mm in [3.0, 6.0, 14.0, 25.0] {
            let sensor_quantisation = Some(SensorQuantisation { step_mm });
            for stale_samples in [None, Some(StaleSamples { hold_s: 0.0757 })] {
                let effects = Effects { stale_samples, sensor_quantisation, ..model().effects };
                let found = hold(&record(&Model { effects, ..model() }, 3, 60));
                assert_eq!(found.is_some(), stale_samples.is_some(), "{found:?} in steps of {step_mm} mm");
                assert!(found.is_none_or(|found| (found.seconds - 0.0757).abs() < 4.0 * found.sigma_s), "{found:?}");
            }
        }
    }
}
