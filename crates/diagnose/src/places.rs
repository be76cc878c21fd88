//! Where a model is wrong: the innovations against what was known before them.
//!
//! ```text
//! z(place) = Σ e_k / √n over the readings whose regressor lies in the place        e = ν/√S
//! ```
//!
//! Places are sixths of the record by duty, height, velocity and time, each known before the reading. Under a right model the e_k are
//! white with mean 0 whatever the loop does, and their signs are coin tosses: flipping them gives the distribution of the
//! largest |z| over all places, which is what a p-value is taken from, so that looking at many places costs nothing.
//! Source: Romano and Wolf, "Stepwise multiple testing", Econometrica 73 (2005).

use crate::folds::Folds;
use crate::recording::Recording;
use crate::track::Track;
use plant::{Model, Normal};
use serde::Serialize;

/// Places by each regressor.
const PLACES: usize = 6;
/// Sign flips: the smallest p-value is one in so many.
const FLIPS: usize = 999;

/// A place where the innovations are not 0 on average.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The regressor: `duty_percent`, `position_mm`, `velocity_mm_per_s` or `time_s`.
    pub signal: &'static str,
    /// Where the place begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Its share of the squared z of all places.
    pub share: f64,
    /// Chance of so large a z anywhere if the model were right.
    pub p_value: f64,
}

/// What was known before a reading, and its innovation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) row: usize,
    pub(crate) time_s: f64,
    /// Duty, height, velocity, and time since the start of the flight.
    pub(crate) known: [f64; 4],
    /// The innovation in deviations, as far as it is no wild one.
    pub(crate) pull: f64,
}

/// Every place, the most significant first.
#[must_use]
pub fn places(model: &Model, recording: &Recording, folds: &Folds) -> Vec<Place> {
    places_of(&rows(model, recording, folds))
}

/// Every place of these rows, the most significant first.
pub(crate) fn places_of(rows: &[Row]) -> Vec<Place> {
    let spots = spots(rows);
    let z = |spot: &[usize], sign: &dyn Fn(usize) -> f64| {
        spot.iter().map(|&k| sign(k) * rows[k].pull).sum::<f64>() / (spot.len().max(1) as f64).sqrt()
    };
    let found: Vec<f64> = spots.iter().map(|spot| z(&spot.3, &|_| 1.0).abs()).collect();
    let mut coins = Normal::new(0, 7);
    let largest: Vec<f64> = (0..FLIPS)
        .map(|_| {
            let signs: Vec<f64> = rows.iter().map(|_| if coins.uniform() < 0.5 { 1.0 } else { -1.0 }).collect();
            spots.iter().map(|spot| z(&spot.3, &|k| signs[k]).abs()).fold(0.0, f64::max)
        })
        .collect();
    let all: f64 = found.iter().map(|z| z * z).sum();
    let mut places: Vec<Place> = spots
        .iter()
        .zip(&found)
        .map(|((signal, from, to, _), z)| Place {
            signal: SIGNALS[*signal],
            from: *from,
            to: *to,
            share: z * z / all.max(1e-12),
            p_value: (1.0 + largest.iter().filter(|other| *other >= z).count() as f64) / (FLIPS as f64 + 1.0),
        })
        .collect();
    places.sort_by(|a, b| a.p_value.total_cmp(&b.p_value).then(b.share.total_cmp(&a.share)));
    places
}

const SIGNALS: [&str; 4] = ["duty_percent", "position_mm", "velocity_mm_per_s", "time_s"];

/// Each reading that counts, with what was known before it.
pub(crate) fn rows(model: &Model, recording: &Recording, folds: &Folds) -> Vec<Row> {
    let samples = recording.samples();
    let track = Track::new(model, recording);
    let before: Vec<[f64; 4]> = track
        .states()
        .map(|(row, position, velocity)| {
            let since_start_s = samples[row].time_s - samples[recording.flight_of(row).start].time_s;
            [samples[row].duty_percent, position, velocity, since_start_s]
        })
        .collect();
    let known = before.into_iter().zip(track.into_surprises()).filter(|(_, s)| folds.counts(s.row));
    known.map(|(known, s)| Row { row: s.row, time_s: samples[s.row].time_s, known, pull: s.pull }).collect()
}

/// A place: which of what was known, from, to, and which rows.
pub(crate) type Spot = (usize, f64, f64, Vec<usize>);

/// The sixths by each of what was known.
pub(crate) fn spots(rows: &[Row]) -> Vec<Spot> {
    (0..SIGNALS.len()).flat_map(|signal| sixths(rows, signal)).collect()
}

/// Six places with equally many readings each, by one of what was known.
fn sixths(rows: &[Row], signal: usize) -> Vec<Spot> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|a, b| rows[*a].known[signal].total_cmp(&rows[*b].known[signal]));
    let value = |k: Option<&usize>| k.map_or(0.0, |k| rows[*k].known[signal]);
    order
        .chunks(rows.len().div_ceil(PLACES).max(1))
        .map(|chunk| (signal, value(chunk.first()), value(chunk.last()), chunk.to_vec()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::places;
    use crate::folds::Folds;
    use crate::tests_support::{model, record};
    use plant::Model;

    #[test]
    fn a_right_model_is_rejected_about_as_often_as_the_p_value_says() {
        let runs: u32 = 60;
        let rejected = (0..runs)
            .filter(|seed| {
                let recording = record(&model(), u64::from(*seed), 40);
                places(&model(), &recording, &Folds::new(&model(), &recording))[0].p_value < 0.05
            })
            .count();
        // 5 % of 60 is 3; 9 or more has a chance of 0.4 %.
        assert!(rejected < 9, "{rejected} of {runs}");
    }

    #[test]
    fn a_wrong_hover_is_found() {
        let wrong = Model { hover_duty_percent: 21.9, ..model() };
        let recording = record(&model(), 2, 60);
        let folds = Folds::new(&model(), &recording);
        assert!(places(&wrong, &recording, &folds)[0].p_value <= 0.01);
    }
}
