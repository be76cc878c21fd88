//! Recordings of a fast clock, decimated to the bandwidth of a rig of this kind.
//!
//! Every duty is kept: a fan does not respond to a duty that changes fast as it does to its mean. Readings are merged
//! into means up to a fiftieth of a second apart, because a ball in a pipe, or an arm, shows nothing faster. Each mean
//! has a variance that is smaller by the number of its readings. Readings are not dropped, because the controller
//! reacted to all of them: a filter without some of them would take the controller's reaction for an effect of the rig.
//! One of each `merged` readings is picked where their mean is not a valid reading: quantised or repeated readings,
//! outliers, or a path whose curvature shifts the mean by a good part of its noise.

use crate::record::reading_variance::reading_variance;
use crate::record::recording::{Recording, Sample};
use crate::stats::spread::spread;
use plant::Model;

/// A recording is decimated to so many readings a second: what a ball in a pipe, or an arm, does is slower.
const ENOUGH_HZ: f64 = 50.0;
/// Recordings with so many readings in total are decimated to this rate, however few remain. Chosen by hand.
const MANY_READINGS: usize = 20_000;
const MANY_HZ: f64 = 100.0;
/// The curvature of the path within a block moves the mean off the middle; at most this share of the mean's noise is
/// allowed.
const BENT: f64 = 0.3;
/// Share of the blocks that must hold a reading in every row.
const ENOUGH_WHOLE: f64 = 0.9;

/// What a recording is prepared for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A search among thousands of models.
    Diagnosis,
    /// A few fits or one evaluation.
    Fit,
}

impl Purpose {
    /// A recording is decimated as long as it keeps so many readings in total. For a diagnosis those of 80 s at 50 Hz,
    /// which are enough for the effects of a rig; chosen by hand. A fit can afford every reading that is not too many.
    const fn enough_readings(self) -> usize {
        match self {
            Self::Diagnosis => 4000,
            Self::Fit => MANY_READINGS,
        }
    }
}

/// How readings were merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Decimated {
    /// Number of readings merged into one.
    pub(crate) merged: usize,
    /// Whether it is their mean; otherwise one of them is picked.
    pub(crate) means: bool,
}

/// The decimated `flight`, one of `all`, of a rig that is believed to be `belief`, and how it was decimated; `None`
/// where it is used as it is. `smooth`: a mean of readings of a ball at rest is a valid reading.
pub(crate) fn decimated(
    flight: &Recording,
    all: &[Recording],
    belief: &Model,
    purpose: Purpose,
    smooth: bool,
) -> Option<(Decimated, Recording)> {
    let samples = flight.samples();
    let rate_hz = flight.readings() as f64 / flight.duration_s().max(1e-9);
    let all_readings: usize = all.iter().map(Recording::readings).sum();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let merged_to = |hz: f64| (rate_hz / hz).round() as usize;
    let of_many = if all_readings < MANY_READINGS { 1 } else { merged_to(MANY_HZ) };
    let merged = merged_to(ENOUGH_HZ).min(all_readings / purpose.enough_readings()).max(of_many);
    if merged < 2 {
        return None;
    }
    // An odd number has a middle row.
    let count = if (merged | 1) as f64 <= rate_hz / ENOUGH_HZ { merged | 1 } else { (merged - 1) | 1 };
    let sigma_mm = (reading_variance(belief) / count as f64).sqrt();
    let may_average = smooth && bend_mm(samples, belief, count, count as f64 / rate_hz) < BENT * sigma_mm;
    // The mean of three would be too slow: noisy readings stay as they are.
    if may_average && count == 1 {
        return None;
    }
    let means = if may_average { means(samples, count) } else { None };
    if let Some(rows) = means {
        let recording = Recording::new(rows).ok()?.of_means(count);
        return Some((Decimated { merged: count, means: true }, recording));
    }
    Recording::new(picked(samples, merged)).ok().map(|recording| (Decimated { merged, means: false }, recording))
}

/// The distance of the mean of a block of `count` rows from its middle, mm: a·T²/24, where a is the acceleration by the
/// spread of the blocks' mean duties. Changes of duty within a block bend no path.
fn bend_mm(samples: &[Sample], belief: &Model, count: usize, seconds: f64) -> f64 {
    let blocks =
        samples.chunks_exact(count).map(|block| block.iter().map(|row| row.duty_percent).sum::<f64>() / count as f64);
    belief.gain_mm_per_s2_per_percent.abs() * spread(blocks).unwrap_or(0.0) * seconds * seconds / 24.0
}

/// The rows, where the middle one of each `count` holds the mean of their readings if none is missing. `None`: readings
/// are missing in too many blocks.
fn means(samples: &[Sample], count: usize) -> Option<Vec<Sample>> {
    let mut rows: Vec<Sample> = samples.iter().map(unread).collect();
    let mut whole = 0;
    for (block, of_block) in samples.chunks_exact(count).enumerate() {
        let middle = count / 2;
        let sum: Option<f64> = of_block.iter().map(|row| row.position_mm).sum();
        if let Some(sum) = sum {
            let mean_mm = sum / count as f64;
            rows[block * count + middle] = Sample { position_mm: Some(mean_mm), ..of_block[middle] };
            whole += 1;
        }
    }
    (whole as f64 > ENOUGH_WHOLE * (samples.len() / count) as f64).then_some(rows)
}

/// The rows, with one of each `merged` readings.
fn picked(samples: &[Sample], merged: usize) -> Vec<Sample> {
    let mut readings_before: usize = 0;
    let pick = |row: &Sample| {
        let is_picked = readings_before.is_multiple_of(merged);
        readings_before += usize::from(row.position_mm.is_some());
        if is_picked { *row } else { unread(row) }
    };
    samples.iter().map(pick).collect()
}

/// A row without its reading. A tachometer and a second sensor keep theirs: their noise is found from one row to the
/// next.
fn unread(row: &Sample) -> Sample {
    Sample { position_mm: None, ..*row }
}

#[cfg(test)]
mod tests {
    use super::{Decimated, Purpose::Diagnosis, decimated};
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    /// 40 s at 1 kHz, each position equal to its time.
    fn fast(seen: impl Fn(u32) -> bool) -> Recording {
        let row = |k| Sample {
            time_s: 0.001 * f64::from(k),
            duty_percent: f64::from(k % 10) + f64::from(k / 100 % 10),
            position_mm: seen(k).then(|| 0.001 * f64::from(k)),
            ..Sample::default()
        };
        Recording::new((0..40_000).map(row).collect()).unwrap()
    }

    #[test]
    fn a_slow_recording_is_left_alone_and_a_fast_one_keeps_every_duty_and_some_readings() {
        let slow = record(&model(), 1, 20);
        assert!(decimated(&slow, slow.as_ref(), &model(), Diagnosis, true).is_none());
        let fast = fast(|_| true);
        for (smooth, merged) in [(false, 10), (true, 11)] {
            let (how, thin) = decimated(&fast, fast.as_ref(), &model(), Diagnosis, smooth).unwrap();
            assert_eq!(how, Decimated { merged, means: smooth });
            assert_eq!((thin.samples().len(), thin.readings()), (40_000, 40_000 / merged));
            assert_eq!(thin.mean_of(0), if smooth { merged } else { 1 });
            for (sample, full) in thin.samples().iter().zip(fast.samples()) {
                assert_eq!(sample.duty_percent, full.duty_percent);
                // The mean of a straight line lies on the line.
                assert!(sample.position_mm.is_none_or(|mm| (mm - sample.time_s).abs() < 1e-12));
            }
        }
    }

    #[test]
    fn readings_are_counted_where_only_some_rows_have_one_and_other_sensors_keep_every_row() {
        // 50 readings a second, at most as many as are needed: none is left out, however many rows lie between them.
        let slow = fast(|k| k % 20 == 0);
        assert!(decimated(&slow, slow.as_ref(), &model(), Diagnosis, true).is_none());
        // 500 a second, 20,000 in all: every tenth of them, though they are in every second row.
        let every_second = fast(|k| k % 2 == 1);
        let rows = every_second.samples().iter().map(|row| Sample {
            fan_rpm: Some(1e3 + row.time_s),
            position2_mm: Some(row.time_s),
            ..*row
        });
        let every_second = Recording::new(rows.collect()).unwrap();
        let (how, thin) = decimated(&every_second, every_second.as_ref(), &model(), Diagnosis, true).unwrap();
        assert_eq!(how, Decimated { merged: 5, means: false });
        assert_eq!(thin.readings(), 4000);
        assert!(thin.samples().iter().all(|row| row.fan_rpm.is_some() && row.position2_mm.is_some()));
    }

    #[test]
    fn readings_whose_path_bends_more_than_their_noise_are_picked() {
        let mut quiet = model();
        let fast = fast(|_| true);
        // 254.6 mm/s² per percent, blocks of 11 ms whose mean duties spread by 2.9 %: 0.0037 mm. Changes within a block
        // bend nothing.
        for (sensor_mm, means) in [(0.05, true), (0.03, false)] {
            quiet.noise.sensor_mm = sensor_mm;
            let (how, _) = decimated(&fast, fast.as_ref(), &quiet, Diagnosis, true).unwrap();
            assert_eq!(how.means, means, "{sensor_mm} mm");
        }
    }

    #[test]
    fn a_recording_keeps_4000_readings_and_noisy_ones_are_averaged_in_odd_numbers_or_kept() {
        let of = |rows: u32, hz: f64| {
            let row = |k| Sample { time_s: f64::from(k) / hz, position_mm: Some(0.0), ..Sample::default() };
            Recording::new((0..rows).map(row).collect()).unwrap()
        };
        let merged = |rows, hz, smooth| {
            let fast = of(rows, hz);
            decimated(&fast, fast.as_ref(), &model(), Diagnosis, smooth).map(|(how, _)| how.merged)
        };
        assert_eq!([7_999, 8_000, 80_000].map(|rows| merged(rows, 100.0, false)), [None, Some(2), Some(2)]);
        assert_eq!([8_000, 12_000].map(|rows| merged(rows, 1000.0, false)), [Some(2), Some(3)]);
        assert_eq!([(8_000, 100.0), (12_000, 150.0)].map(|(rows, hz)| merged(rows, hz, true)), [None, Some(3)]);
    }

    #[test]
    fn readings_with_too_many_holes_are_picked() {
        let holes = fast(|k| k % 12 != 5);
        let (how, thin) = decimated(&holes, holes.as_ref(), &model(), Diagnosis, true).unwrap();
        assert!(!how.means && thin.mean_of(0) == 1, "{how:?}");
    }
}
