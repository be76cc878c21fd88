//! A very long flight in parts: stretches of its rows, spread evenly over it, so that time and memory of a diagnosis
//! stay bounded.
//!
//! Stretches, not single rows: a filter needs every duty between two readings.

use crate::record::recording::Recording;

/// Most rows of all flights together that a diagnosis uses: more than an hour at 50 rows a second.
pub const MOST_ROWS: usize = 200_000;
/// Rows that are used of more: half, since a search takes time in proportion, and 33 minutes at 50 rows a second show
/// what a rig lacks as well as 66 do.
const USED_ROWS: usize = 100_000;
/// Most stretches of a flight.
const MOST_STRETCHES: usize = 8;
/// Fewest rows of a stretch.
const FEWEST_ROWS: usize = 2_000;

/// Stretches of `flight`, which is one of several with `all_rows` rows together; `None` where all rows are used.
pub(crate) fn stretches(flight: &Recording, all_rows: usize) -> Option<Vec<Recording>> {
    let rows = flight.samples().len();
    if all_rows <= MOST_ROWS {
        return None;
    }
    // Its share of the rows, in whole numbers.
    let share = usize::try_from(USED_ROWS as u128 * rows as u128 / all_rows as u128).unwrap_or(USED_ROWS);
    let used = share.max(FEWEST_ROWS);
    if rows <= used {
        return None;
    }
    let count = (used / FEWEST_ROWS).clamp(1, MOST_STRETCHES);
    let (length, every) = (used / count, rows / count);
    // In the middle of each part: take-off and landing are the ends.
    let stretch = |part: usize| {
        let start = part * every + (every - length) / 2;
        Recording::new(flight.samples().get(start..start + length)?.to_vec()).ok()
    };
    let whole: Vec<Recording> = (0..count).filter_map(stretch).collect();
    (!whole.is_empty()).then_some(whole)
}

#[cfg(test)]
mod tests {
    use super::{MOST_ROWS, MOST_STRETCHES, USED_ROWS, stretches};
    use crate::record::check::Finding;
    use crate::record::decimate::Purpose;
    use crate::record::prepare::Prepared;
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    /// A flight, again and again.
    fn long(rows: usize) -> Recording {
        let flight = record(&model(), 1, 40);
        let flown = flight.samples();
        let row = |k: usize| Sample { time_s: k as f64 * 0.02, ..flown[500 + k % (flown.len() - 500)] };
        Recording::new((0..rows).map(row).collect()).unwrap()
    }

    #[test]
    fn a_very_long_record_is_used_in_stretches_over_all_of_it_and_the_rest_is_said() {
        let flights = [long(3 * MOST_ROWS)];
        let prepared = Prepared::of(&flights, &model(), Purpose::Diagnosis);
        let samples = prepared.recording.samples();
        assert!(samples.len() <= USED_ROWS && samples.len() > 9 * USED_ROWS / 10, "{}", samples.len());
        assert_eq!(prepared.recording.flights().len(), MOST_STRETCHES);
        let said = prepared.findings.iter().find_map(|found| match found.finding {
            Finding::Stretches { rows, used, count } => Some((found.flight, rows, used, count)),
            _ => None,
        });
        assert_eq!(said, Some((0, 3 * MOST_ROWS, samples.len(), MOST_STRETCHES)));
        assert!(prepared.can_answer);
    }

    #[test]
    fn stretches_are_spread_evenly_and_shared_among_flights() {
        let flight = long(MOST_ROWS);
        assert!(stretches(&flight, MOST_ROWS).is_none());
        let parts = stretches(&flight, 4 * MOST_ROWS).unwrap();
        let rows: usize = parts.iter().map(|part| part.samples().len()).sum();
        assert_eq!((parts.len(), rows), (MOST_STRETCHES, USED_ROWS / 4));
        let starts: Vec<f64> = parts.iter().map(|part| part.samples()[0].time_s).collect();
        assert!(starts.windows(2).all(|pair| (pair[1] - pair[0] - 500.0).abs() < 0.1), "{starts:?}");
    }

    #[test]
    fn a_short_flight_beside_a_long_one_is_used_whole() {
        let (short, all_rows) = (long(2_000), 30 * MOST_ROWS);
        assert!(stretches(&short, all_rows).is_none());
    }
}
