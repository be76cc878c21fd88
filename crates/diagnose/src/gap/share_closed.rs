//! The share of the gap at 1 s that the fitted model closes, with its 90 % interval.
//!
//! ```text
//! closed = (E_nominal² − E_mended²) / (E_nominal² − F²)      on held-out stretches, not clipped
//! ```
//!
//! The interval is a block bootstrap. F is that of the whole record.

use crate::gap::bootstrap::{interval, square};
use crate::gap::forecast_error::Tally;
use crate::thresholds::OPEN_GAP;
use serde::Serialize;

/// A share of the gap, with its 90 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Closed {
    /// The share.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Closed {
    /// Of a step from the model `before` to the model `after`: from their errors and those of the belief, by stretch,
    /// and the mean square by noise alone, mm². `None`: there is no gap to close.
    pub(crate) fn of(nominal: &[Tally], [before, after]: [&[Tally]; 2], floor: f64) -> Option<Self> {
        let count = [nominal, before, after].map(<[Tally]>::len).into_iter().min()?;
        let share = |at: &[usize]| Some((square(before, at)? - square(after, at)?) / (square(nominal, at)? - floor));
        let all: Vec<usize> = (0..count).collect();
        if !is_open(square(nominal, &all)?, floor) {
            return None;
        }
        let value = share(&all)?;
        let [low, high] = interval(count, share).unwrap_or([value; 2]);
        Some(Self { value, low: low.min(value), high: high.max(value) })
    }
}

/// Whether the mean square error exceeds the noise floor by enough to be a gap.
#[must_use]
pub fn is_open(before: f64, floor: f64) -> bool {
    before.sqrt() >= OPEN_GAP * floor.sqrt()
}

/// The share of the gap that is closed, from the mean squares before, after and of the noise floor.
#[must_use]
pub fn share_closed(before: f64, after: f64, floor: f64) -> f64 {
    (before - after) / (before - floor)
}

#[cfg(test)]
mod tests {
    use super::Closed;
    use crate::filter::track::Track;
    use crate::gap::forecast_error::{Tally, tallies};
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    #[test]
    fn the_right_model_closes_all_of_the_gap_and_the_belief_itself_none() {
        let recording = record(&model(), 5, 80);
        let by_stretch = |model: &Model| tallies(&Track::new(model, &recording), &|row| Some(row / 250));
        let belief = by_stretch(&Model { effects: Effects::default(), ..model() });
        let right = by_stretch(&model());
        let floor = |all: &[Tally]| Tally::sum(all.iter()).gap().floor_mm[2].unwrap().powi(2);
        let closed = Closed::of(&belief, [&belief, &right], floor(&right)).unwrap();
        assert!(closed.value > 0.85 && closed.high > 0.95 && closed.high - closed.low < 0.5, "{closed:?}");
        // A fitted model that equals the belief closes nothing.
        let none = Closed::of(&belief, [&belief, &belief], floor(&right)).unwrap();
        assert!(none.value == 0.0 && none.low == 0.0 && none.high == 0.0, "{none:?}");
        // Errors below the noise floor leave no gap to close.
        let mut turbulent = model();
        turbulent.noise.acceleration_psd_mm2_per_s3 *= 4.0;
        let turbulent = by_stretch(&turbulent);
        assert_eq!(Closed::of(&turbulent, [&turbulent, &turbulent], floor(&turbulent)), None);
    }
}
