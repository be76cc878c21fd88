//! A single input far from all others, from which no unit and no plant can be found.

use crate::record::recording::{Recording, Sample};

/// An input is no input of the rig that is so many times as far from all others as these are from each other: ten
/// times is beyond what any experiment does once.
const FAR: f64 = 10.0;

/// The row of an input that is too far from all others, and its distance in their range.
pub(super) fn input_outlier(recording: &Recording) -> Option<(usize, f64)> {
    let rows = recording.samples();
    let ordered = |a: &&Sample, b: &&Sample| a.duty_percent.total_cmp(&b.duty_percent);
    let ends = [rows.iter().min_by(ordered)?.duty_percent, rows.iter().max_by(ordered)?.duty_percent];
    let outliers = ends.into_iter().filter_map(|end| {
        let at = rows.iter().position(|sample| sample.duty_percent == end)?;
        let others = rows.iter().enumerate().filter(|(row, _)| *row != at).map(|(_, sample)| sample.duty_percent);
        let (low, high) = others.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), u| (low.min(u), high.max(u)));
        // Halves, so that no difference is infinite.
        let (away, range) = ((0.5 * end - 0.5 * high).max(0.5 * low - 0.5 * end), 0.5 * high - 0.5 * low);
        (range > 0.0 && away > FAR * range).then_some((at + 1, away / range))
    });
    outliers.max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::input_outlier;
    use crate::tests_support::{model, shaken};
    use crate::{Recording, Sample};

    fn with_one(row: usize, duty_percent: f64) -> Option<(usize, f64)> {
        let mut rows: Vec<Sample> = shaken(&model(), 2, 20).samples().to_vec();
        rows[row].duty_percent = duty_percent;
        input_outlier(&Recording::new(rows).unwrap())
    }

    #[test]
    fn a_single_input_far_from_all_others_is_found_with_its_row_and_no_other_is() {
        assert_eq!(input_outlier(&shaken(&model(), 2, 20)), None);
        for (row, duty_percent) in [(0, 1e3), (400, -1e6), (999, 1e308), (7, f64::MAX), (7, f64::MIN)] {
            let found = with_one(row, duty_percent);
            assert!(found.is_some_and(|(at, times)| at == row + 1 && times > 10.0), "{duty_percent:e}: {found:?}");
        }
        assert_eq!(with_one(300, 30.0), None);
    }
}
