//! Where a model is wrong: the innovations against what was known before them.
//!
//! ```text
//! z(place) = Σ e_k / √n over the readings whose regressor lies in the place        e = ν/√S
//! ```
//!
//! Places are sixths of the record by duty, height, velocity and time, each known before the reading. Under a right model the e_k are
//! white with mean 0 whatever the loop does, and their signs are coin tosses: flipping them gives the distribution of the
//! largest |z| over all places, which is what a p-value is taken from, so that looking at many places costs nothing.
//! Whiteness is judged by the portmanteau of Ljung and Box over lags up to half a second.
//! Sources: Romano and Wolf, "Stepwise multiple testing", Econometrica 73 (2005); Ljung and Box, Biometrika 65 (1978).

use crate::likelihood::Surprise;
use crate::recording::Recording;
use crate::track::Track;
use plant::{Model, Normal};
use serde::Serialize;

/// Places by each regressor.
const PLACES: usize = 6;
/// Sign flips: the smallest p-value is one in so many.
const FLIPS: usize = 999;
/// Lags of the portmanteau, readings.
const LAGS: usize = 25;

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

/// Every place, the most significant first.
#[must_use]
pub fn places(model: &Model, recording: &Recording, counts: &[bool]) -> Vec<Place> {
    let rows = regressors(model, recording, counts);
    let spots: Vec<(usize, f64, f64, Vec<usize>)> = (0..4).flat_map(|signal| sixths(&rows, signal)).collect();
    let z = |spot: &[usize], sign: &dyn Fn(usize) -> f64| {
        spot.iter().map(|&k| sign(k) * rows[k].1).sum::<f64>() / (spot.len().max(1) as f64).sqrt()
    };
    let found: Vec<f64> = spots.iter().map(|spot| z(&spot.3, &|_| 1.0).abs()).collect();
    let mut coins = Normal::new(0, 7);
    let largest: Vec<f64> = (0..FLIPS)
        .map(|_| {
            let signs: Vec<f64> = rows.iter().map(|_| coins.draw().signum()).collect();
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

/// What was known before each reading that counts, and its standardised innovation.
fn regressors(model: &Model, recording: &Recording, counts: &[bool]) -> Vec<([f64; 4], f64)> {
    let samples = recording.samples();
    let track = Track::new(model, recording);
    let before: Vec<[f64; 4]> = track
        .states()
        .map(|(row, position, velocity)| [samples[row].duty_percent, position, velocity, samples[row].time_s])
        .collect();
    let known = before.into_iter().zip(track.into_surprises());
    known.filter(|(_, s)| counts[s.row]).map(|(known, s)| (known, s.weight * s.standardised())).collect()
}

/// Six places with equally many readings each, by one regressor.
fn sixths(rows: &[([f64; 4], f64)], signal: usize) -> Vec<(usize, f64, f64, Vec<usize>)> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|a, b| rows[*a].0[signal].total_cmp(&rows[*b].0[signal]));
    let value = |k: Option<&usize>| k.map_or(0.0, |k| rows[*k].0[signal]);
    order
        .chunks(rows.len().div_ceil(PLACES).max(1))
        .map(|chunk| (signal, value(chunk.first()), value(chunk.last()), chunk.to_vec()))
        .collect()
}

/// The portmanteau of the innovations that count: 0 on average for white ones, in standard deviations of its own.
#[must_use]
pub fn colour(surprises: &[Surprise], counts: &[bool]) -> f64 {
    let e: Vec<f64> = surprises.iter().filter(|s| counts[s.row]).map(|s| s.weight * s.standardised()).collect();
    let n = e.len() as f64;
    let power: f64 = e.iter().map(|e| e * e).sum();
    let correlation = |lag: usize| e.iter().zip(e.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / power.max(1e-12);
    let q: f64 = (1..=LAGS).map(|lag| correlation(lag).powi(2) * n * (n + 2.0) / (n - lag as f64)).sum();
    // χ² with LAGS degrees of freedom: mean LAGS, variance 2·LAGS.
    (q - LAGS as f64) / (2.0 * LAGS as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{colour, places};
    use crate::likelihood::{in_free_flight, surprises};
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    #[test]
    fn a_right_model_is_rejected_about_as_often_as_the_p_value_says() {
        let runs: u32 = 60;
        let rejected = (0..runs)
            .filter(|seed| {
                let recording = record(&model(), u64::from(*seed), 40);
                places(&model(), &recording, &in_free_flight(&model(), &recording))[0].p_value < 0.05
            })
            .count();
        // 5 % of 60 is 3; 9 or more has a chance of 0.4 %.
        assert!(rejected < 9, "{rejected} of {runs}");
    }

    #[test]
    fn a_wrong_hover_is_found_and_a_right_model_is_white() {
        let wrong = Model { hover_duty_percent: 21.9, ..model() };
        let recording = record(&model(), 2, 60);
        let counts = in_free_flight(&model(), &recording);
        assert!(places(&wrong, &recording, &counts)[0].p_value <= 0.01);
        assert!(colour(&surprises(&model(), &recording), &counts).abs() < 4.0);
        let without = Model { effects: Effects::default(), ..model() };
        assert!(colour(&surprises(&without, &recording), &counts) > 4.0);
    }
}
