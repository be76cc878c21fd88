//! Where a model is wrong: the standardised innovations as a function of what was known before each reading.
//!
//! ```text
//! z(place) = Σ e_k·w_k / √Σ w_k²        e = ν/√S; w: 1 where the regressor lies in the place, 0 elsewhere
//! z(lag)   = the same                   w: the change of duty between `to` and `from` seconds before the reading
//! ```
//!
//! Places are sixths of the record by duty, height, velocity and time, and sixths of the time since a change of duty.
//! All of these are known before the reading. Under a right model the e_k are white with mean 0, also in closed loop,
//! and their signs are random. Random sign flips give the distribution of the largest |z| over all places. The p-value
//! comes from that distribution, so it needs no further correction for the number of places.
//! Source: Romano and Wolf, "Stepwise multiple testing", Econometrica 73 (2005).

use crate::filter::track::Track;
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use plant::{Model, Normal};
use serde::Serialize;

/// Places per regressor.
const PLACES: usize = 6;
/// The longest time since a change of duty, seconds.
const LONGEST_LAG_S: f64 = 1.5;
/// Sign flips. The smallest possible p-value is 1/(FLIPS + 1).
const FLIPS: usize = 999;

/// A place where the mean innovation differs from 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The regressor: `duty_percent`, `position_mm`, `velocity_mm_per_s`, `time_s`, or `lag_s`, the time since a change
    /// of duty.
    pub signal: &'static str,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Its share of the squared z of all places.
    pub share: f64,
    /// Probability of so large a |z| at any place if the model is right.
    pub p_value: f64,
}

/// What was known before a reading, and its innovation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) row: usize,
    pub(crate) time_s: f64,
    /// Duty, height, velocity, and time since the start of the flight.
    pub(crate) known: [f64; 4],
    /// The standardised innovation, limited for outliers.
    pub(crate) standardised: f64,
}

/// A place and the weights of its rows.
struct Weighed {
    signal: &'static str,
    from: f64,
    to: f64,
    /// Row numbers and their weights, √Σw² = 1.
    weights: Vec<(usize, f64)>,
}

impl Weighed {
    /// `None` if all weights are 0.
    fn new(signal: &'static str, [from, to]: [f64; 2], mut weights: Vec<(usize, f64)>) -> Option<Self> {
        let length = weights.iter().map(|(_, weight)| weight * weight).sum::<f64>().sqrt();
        weights.iter_mut().for_each(|(_, weight)| *weight /= length);
        (length > 0.0).then_some(Self { signal, from, to, weights })
    }

    fn z(&self, standardised: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().map(|(k, weight)| standardised(*k) * weight).sum()
    }
}

/// All places of these rows of a recording, the most significant first.
pub(crate) fn places_of(rows: &[Row], recording: &Recording) -> Vec<Place> {
    let evenly = |(signal, from, to, spot): Spot| {
        Weighed::new(SIGNALS[signal], [from, to], spot.into_iter().map(|k| (k, 1.0)).collect())
    };
    let weighed: Vec<Weighed> = spots(rows).into_iter().filter_map(evenly).chain(lags(rows, recording)).collect();
    let found: Vec<f64> = weighed.iter().map(|place| place.z(|k| rows[k].standardised).abs()).collect();
    let mut coins = Normal::new(0, 7);
    let largest: Vec<f64> = (0..FLIPS)
        .map(|_| {
            let flipped: Vec<f64> = rows
                .iter()
                .map(|row| if coins.uniform() < 0.5 { row.standardised } else { -row.standardised })
                .collect();
            weighed.iter().map(|place| place.z(|k| flipped[k]).abs()).fold(0.0, f64::max)
        })
        .collect();
    let all: f64 = found.iter().map(|z| z * z).sum();
    let place = |(place, z): (&Weighed, &f64)| Place {
        signal: place.signal,
        from: place.from,
        to: place.to,
        share: z * z / all.max(1e-12),
        p_value: (1.0 + largest.iter().filter(|other| *other >= z).count() as f64) / (FLIPS as f64 + 1.0),
    };
    let mut places: Vec<Place> = weighed.iter().zip(&found).map(place).collect();
    places.sort_by(|a, b| a.p_value.total_cmp(&b.p_value).then(b.share.total_cmp(&a.share)));
    places
}

/// The sixths of the time since a change of duty. Each row is weighted by the size of that change.
fn lags(rows: &[Row], recording: &Recording) -> impl Iterator<Item = Weighed> {
    let samples = recording.samples();
    // The duty of a row is written after its reading.
    let duty = |row: usize, ago_s: f64| {
        let before = &samples[recording.flight_of(row).start..row];
        let later = before.partition_point(|sample| sample.time_s <= samples[row].time_s - ago_s);
        before.get(later.saturating_sub(1)).map_or(0.0, |sample| sample.duty_percent)
    };
    let ends = (0..PLACES).map(|lag| [lag, lag + 1].map(|end| LONGEST_LAG_S * end as f64 / PLACES as f64));
    let weighed = ends.map(|[from, to]| {
        let moved = rows.iter().map(|row| duty(row.row, from) - duty(row.row, to));
        Weighed::new("lag_s", [from, to], moved.enumerate().collect())
    });
    weighed.collect::<Vec<_>>().into_iter().flatten()
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
    let known = before.into_iter().zip(track.into_innovations()).filter(|(_, s)| folds.counts(s.row));
    known
        .map(|(known, s)| Row { row: s.row, time_s: samples[s.row].time_s, known, standardised: s.standardised })
        .collect()
}

/// A place: index of the regressor, lower end, upper end, and row numbers.
pub(crate) type Spot = (usize, f64, f64, Vec<usize>);

/// The sixths of each regressor.
pub(crate) fn spots(rows: &[Row]) -> Vec<Spot> {
    (0..SIGNALS.len()).flat_map(|signal| sixths(rows, signal)).collect()
}

/// Six places of one regressor with equally many readings each.
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
    use super::{places_of, rows};
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use plant::effects::TransportDelay;
    use plant::{Effects, Model};
    use rayon::prelude::*;

    #[test]
    fn a_right_model_is_rejected_about_as_often_as_the_p_value_says() {
        let rejects = |seed: &u64| {
            let recording = record(&model(), *seed, 40);
            places_of(&rows(&model(), &recording, &Folds::new(&model(), &recording)), &recording)[0].p_value < 0.05
        };
        let rejected = (0..300).into_par_iter().filter(rejects).count();
        // 2 to 9 % of 300.
        assert!((6..=27).contains(&rejected), "{rejected}");
    }

    #[test]
    fn a_delay_that_the_model_lacks_is_found_in_the_time_since_the_duty_moved() {
        let delay = Effects { transport_delay: Some(TransportDelay { delay_s: 0.12 }), ..model().effects };
        let recording = record(&Model { effects: delay, ..model() }, 2, 60);
        let found = places_of(&rows(&model(), &recording, &Folds::new(&model(), &recording)), &recording);
        let lag = found.iter().find(|place| place.signal == "lag_s").unwrap();
        assert!(lag.p_value <= 0.01 && lag.from < 0.3, "{found:?}");
    }

    #[test]
    fn a_wrong_hover_is_found() {
        let wrong = Model { hover_duty_percent: 21.9, ..model() };
        let recording = record(&model(), 2, 60);
        let folds = Folds::new(&model(), &recording);
        assert!(places_of(&rows(&wrong, &recording, &folds), &recording)[0].p_value <= 0.01);
    }
}
