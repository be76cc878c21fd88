//! Recordings of a fast clock, thinned to what a rig of this kind can show.
//!
//! Rows are merged: the reading of the first is kept, and the duty is the mean over the time that each was in force. A ball in a pipe, or an
//! arm, does not follow what happens within a hundredth of a second; what the merging leaves out is a delay of a fraction of that.

use crate::recording::{Recording, Sample};

/// Recordings with fewer rows together are taken as they are.
const MANY_ROWS: usize = 20_000;
/// Rows a second that are enough.
const ENOUGH_HZ: f64 = 100.0;
/// The same where rows are many even so, and how many that is.
const FEWER_HZ: f64 = 50.0;
const VERY_MANY_ROWS: f64 = 400_000.0;

/// How many rows become one, and the thinned flight, one of `all`; `None` where it is used as it is.
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
    let rows = samples.chunks(merged).map(|rows| merge(rows, samples)).collect();
    Recording::new(rows).ok().map(|recording| (merged, recording))
}

fn merge(rows: &[Sample], all: &[Sample]) -> Sample {
    let first = rows[0];
    // Each duty is in force until the next row, which may be the first of the next chunk.
    let last_step_s = all.get(1).map_or(1.0, |second| second.time_s - all[0].time_s);
    let ends = rows.iter().skip(1).map(|row| row.time_s).chain(rows.last().map(|row| row.time_s + last_step_s));
    let (sum, span) = rows.iter().zip(ends).fold((0.0, 0.0), |(sum, span), (row, end_s)| {
        let held_s = end_s - row.time_s;
        (sum + held_s * row.duty_percent, span + held_s)
    });
    Sample { duty_percent: if span > 0.0 { sum / span } else { first.duty_percent }, ..first }
}

#[cfg(test)]
mod tests {
    use super::thinned;
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    #[test]
    fn a_slow_recording_is_left_alone_and_a_fast_one_keeps_readings_and_mean_duty() {
        let slow = record(&model(), 1, 20);
        assert!(thinned(&slow, slow.as_ref()).is_none());
        let row = slow.samples()[0];
        let fast = (0..40_000).map(|k| Sample { time_s: 0.001 * f64::from(k), duty_percent: f64::from(k % 10), ..row });
        let fast = Recording::new(fast.map(|s| Sample { position_mm: Some(s.time_s), ..s }).collect()).unwrap();
        let (merged, thin) = thinned(&fast, fast.as_ref()).unwrap();
        assert_eq!((merged, thin.samples().len()), (10, 4000));
        for (k, sample) in thin.samples().iter().enumerate() {
            assert!(
                (sample.duty_percent - 4.5).abs() < 1e-9 && sample.position_mm == fast.samples()[10 * k].position_mm
            );
        }
    }
}
