//! Which rows count, and which of them are kept back together: stretches of the record dealt out in turn.
//!
//! Interleaved, so that a drift or a programme's phases fall into every fold; each stretch longer than a filter remembers.
//! The innovation of a reading already knows all readings before it, whichever fold they are in.

use crate::likelihood::in_free_flight;
use crate::recording::Recording;
use plant::Model;

/// Length of a stretch, seconds.
const STRETCH_S: f64 = 5.0;

/// The stretch of every row, and so its fold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folds {
    stretches: Vec<Option<usize>>,
}

impl Folds {
    /// How many folds there are.
    pub const COUNT: usize = 4;

    /// Deals out the rows in free flight. A record too short for stretches of their usual length gets shorter ones.
    #[must_use]
    pub fn new(belief: &Model, recording: &Recording) -> Self {
        let counts = in_free_flight(belief, recording);
        let stretch_s = STRETCH_S.min(recording.duration_s() / (2.0 * Self::COUNT as f64)).max(1e-9);
        let start_s = recording.samples().first().map_or(0.0, |first| first.time_s);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let stretch = |time_s: f64| ((time_s - start_s) / stretch_s) as usize;
        let rows = recording.samples().iter().zip(counts);
        Self { stretches: rows.map(|(sample, counts)| counts.then(|| stretch(sample.time_s))).collect() }
    }

    /// The stretch that a row is in; `None` if the row does not count.
    #[must_use]
    pub fn stretch(&self, row: usize) -> Option<usize> {
        self.stretches.get(row).copied().flatten()
    }

    /// The fold of a row; `None` if the row does not count.
    #[must_use]
    pub fn of(&self, row: usize) -> Option<usize> {
        self.stretch(row).map(|stretch| stretch % Self::COUNT)
    }

    /// Whether a row counts.
    #[must_use]
    pub fn counts(&self, row: usize) -> bool {
        self.of(row).is_some()
    }
}
