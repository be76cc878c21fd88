//! Recordings of a fast clock, thinned to what a rig of this kind can show.
//!
//! Every duty is kept, since what a fan makes of a duty that chatters is not what it makes of its mean; of the readings, those that are a
//! hundredth of a second apart. A ball in a pipe, or an arm, does not show more than that.

use crate::recording::{Recording, Sample};

/// Recordings with fewer rows together are taken as they are.
const MANY_ROWS: usize = 20_000;
/// Rows a second that are enough.
const ENOUGH_HZ: f64 = 100.0;
/// The same where rows are many even so, and how many that is.
const FEWER_HZ: f64 = 50.0;
const VERY_MANY_ROWS: f64 = 400_000.0;

/// Which of how many readings is kept, and the thinned flight, one of `all`; `None` where it is used as it is.
pub(crate) fn thinned(flight: &Recording, all: &[Recording]) -> Option<(usize, Recording)> {
    let samples = flight.samples();
    let rate_hz = samples.len() as f64 / flight.duration_s().max(1e-9);
    let (all_rows, all_s) =
        all.iter().fold((0, 0.0), |(rows, s), one| (rows + one.samples().len(), s + one.duration_s()));
    let enough = if all_s * ENOUGH_HZ > VERY_MANY_ROWS { FEWER_HZ } else { ENOUGH_HZ };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let merged = (rate_hz / enough) as usize;
    if all_rows < MANY_ROWS || merged < 2 {
        return None;
    }
    let rows = samples.iter().enumerate().map(|(k, row)| if k.is_multiple_of(merged) { *row } else { unread(row) });
    Recording::new(rows.collect()).ok().map(|recording| (merged, recording))
}

/// A row without what was measured in it.
fn unread(row: &Sample) -> Sample {
    Sample { position_mm: None, position2_mm: None, fan_rpm: None, ..*row }
}

#[cfg(test)]
mod tests {
    use super::thinned;
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    #[test]
    fn a_slow_recording_is_left_alone_and_a_fast_one_keeps_every_duty_and_some_readings() {
        let slow = record(&model(), 1, 20);
        assert!(thinned(&slow, slow.as_ref()).is_none());
        let row = slow.samples()[0];
        let fast = (0..40_000).map(|k| Sample { time_s: 0.001 * f64::from(k), duty_percent: f64::from(k % 10), ..row });
        let fast = Recording::new(fast.map(|s| Sample { position_mm: Some(s.time_s), ..s }).collect()).unwrap();
        let (merged, thin) = thinned(&fast, fast.as_ref()).unwrap();
        assert_eq!((merged, thin.samples().len(), thin.readings()), (10, 40_000, 4000));
        for (k, (sample, full)) in thin.samples().iter().zip(fast.samples()).enumerate() {
            assert_eq!(sample.duty_percent, full.duty_percent);
            assert_eq!(sample.position_mm, full.position_mm.filter(|_| k % 10 == 0));
        }
    }
}
