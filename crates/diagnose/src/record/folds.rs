//! Folds for cross-validation: the rows that count, cut into stretches, which are assigned to the folds in turn.
//!
//! Stretches are interleaved so that a drift or the phases of an experiment are in every fold; each is longer than the
//! memory of a filter. No stretch spans two flights. The innovation of a reading depends on all readings before it,
//! whichever fold they are in.

use crate::record::free_flight::in_free_flight;
use crate::record::recording::Recording;
use plant::Model;

/// Length of a stretch, seconds.
const STRETCH_S: f64 = 5.0;

/// The stretch of every row; it determines the row's fold.
#[derive(Clone, Debug, PartialEq)]
pub struct Folds {
    stretches: Vec<Option<usize>>,
    weight: f64,
}

impl Folds {
    /// Number of folds.
    pub const COUNT: usize = 4;

    /// Assigns the rows in free flight. A record too short for stretches of the usual length gets shorter ones.
    #[must_use]
    pub fn new(belief: &Model, recording: &Recording) -> Self {
        let counts = in_free_flight(belief, recording);
        let stretch_s = STRETCH_S.min(recording.duration_s() / (2.0 * Self::COUNT as f64)).max(1e-9);
        let mut stretches = Vec::with_capacity(counts.len());
        let mut first = 0;
        for flight in recording.flights() {
            let rows = &recording.samples()[flight.clone()];
            let start_s = rows.first().map_or(0.0, |first| first.time_s);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
            let stretch = |time_s: f64| first + ((time_s - start_s) / stretch_s) as usize;
            stretches
                .extend(rows.iter().zip(&counts[flight.clone()]).map(|(s, counts)| counts.then(|| stretch(s.time_s))));
            first = rows.last().map_or(first, |last| stretch(last.time_s) + 1);
        }
        Self { stretches, weight: 1.0 }
    }

    /// The same folds without the rows for which `keep` is false.
    #[must_use]
    pub(crate) fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept = self.stretches.iter().enumerate().map(|(row, stretch)| stretch.filter(|_| keep(row)));
        Self { stretches: kept.collect(), weight: self.weight }
    }

    /// The same folds with this weight of every reading.
    #[must_use]
    pub(crate) fn weighted(&self, weight: f64) -> Self {
        Self { weight, ..self.clone() }
    }

    /// The weight of every reading.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// The stretch of a row; `None` if the row does not count.
    #[must_use]
    pub fn stretch(&self, row: usize) -> Option<usize> {
        self.stretches.get(row).copied().flatten()
    }

    /// The fold of a row; `None` if the row does not count.
    #[must_use]
    pub fn of(&self, row: usize) -> Option<usize> {
        self.stretch(row).map(|stretch| stretch % Self::COUNT)
    }

    /// How many rows that count hold a reading.
    #[must_use]
    pub(crate) fn readings(&self, recording: &Recording) -> usize {
        let rows = recording.samples().iter().enumerate();
        rows.filter(|(row, sample)| sample.position_mm.is_some() && self.counts(*row)).count()
    }

    /// Whether a row counts.
    #[must_use]
    pub fn counts(&self, row: usize) -> bool {
        self.of(row).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::Folds;
    use crate::Recording;
    use crate::tests_support::{model, record};

    #[test]
    fn no_stretch_spans_two_flights_and_short_flights_fall_into_different_folds() {
        let flights = (0..8).map(|seed| record(&model(), seed, 7));
        let together = Recording::together(flights);
        let folds = Folds::new(&model(), &together);
        let of_flight = |number: usize| {
            let rows = together.flights()[number].clone();
            rows.filter_map(|row| folds.stretch(row)).collect::<std::collections::BTreeSet<usize>>()
        };
        for number in 1..8 {
            assert!(of_flight(number - 1).is_disjoint(&of_flight(number)), "flights {} and {number}", number - 1);
        }
        let each = |fold: usize| (0..together.samples().len()).filter(|row| folds.of(*row) == Some(fold)).count();
        let counts: [usize; Folds::COUNT] = std::array::from_fn(each);
        assert!(counts.iter().all(|count| *count > 200), "{counts:?}");
        // The start of every flight is not free flight.
        assert!(together.flights().iter().all(|flight| !folds.counts(flight.start) && folds.counts(flight.end - 1)));
    }
}
