//! The gap: the forecast errors of a model on a recording, compared with those by noise alone.
//!
//! ```text
//! E(h) = rms over all readings k of ( forecast made after reading k for the reading h later − that reading )
//! F(h) = rms of the standard deviation that the filter expects of the same forecasts by the model's own noise
//! stay put: the same errors when the forecast is reading k itself
//! free run: the forecasts of all readings in windows of 10 s, each from the state at its start
//! ```
//!
//! Readings that are no position of the ball were counted as empty before (`record::implausible`): one of them would be
//! the whole of E. What is left is off by no more than a pipe's length or so. A root that is not finite is `None`.
//!
//! A right model has E = F at every horizon. This holds in closed loop too: forecasts use the duty as recorded, and
//! only the noise after reading k can separate them from the readings.

use crate::filter::track::{Forecast, Track};
use crate::record::free_flight::settling_s;
use crate::record::recording::{Recording, Sample};
use plant::Model;
use serde::Serialize;

/// Horizons of the forecasts, seconds.
pub(crate) const HORIZONS_S: [f64; 3] = [0.1, 0.5, 1.0];
/// Length of a free run, seconds.
const FREE_RUN_S: f64 = 10.0;
/// The filter's first seconds depend on the prior, not on the model; less in a short flight.
const WARM_UP_S: f64 = 2.0;
/// Forecasts that start closer together than half the shortest horizon err alike.
const APART_S: f64 = 0.5 * HORIZONS_S[0];
/// Number of forecast steps that is enough for three digits; a longer recording starts its forecasts less often.
const ENOUGH_STEPS: usize = 10_000_000;

/// Forecast errors of a model on a recording: rms errors in mm. `None` where the recording is too short.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Forecast horizons, seconds.
    pub horizons_s: [f64; 3],
    /// Errors of the model.
    pub error_mm: [Option<f64>; 3],
    /// Errors of the forecast that the ball does not move.
    pub stay_put_mm: [Option<f64>; 3],
    /// Noise floor: errors by the model's noise alone.
    pub floor_mm: [Option<f64>; 3],
    /// Error of free runs of 10 s.
    pub free_run_10s_mm: Option<f64>,
    /// Noise floor of the free runs.
    pub floor_free_run_10s_mm: Option<f64>,
}

/// A running root mean square.
#[derive(Clone, Copy, Debug, Default)]
struct MeanSquare {
    sum: f64,
    count: f64,
}

impl MeanSquare {
    fn add(&mut self, square: f64) {
        self.sum += square;
        self.count += 1.0;
    }

    fn merge(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
    }

    fn root(self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.sum / self.count).sqrt()).filter(|root| root.is_finite())
    }
}

/// Errors of one kind of forecast.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    model: MeanSquare,
    stay_put: MeanSquare,
    floor: MeanSquare,
}

/// Sums of forecast errors, which can be added.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    horizons: [Errors; 3],
    free_run: Errors,
}

impl Tally {
    /// Mean square of the model at the longest horizon.
    pub(crate) fn square_at_1_s(&self) -> Option<f64> {
        let Errors { model, .. } = self.horizons[2];
        let square = model.sum / model.count;
        square.is_finite().then_some(square)
    }

    /// Mean squares of the model at the horizons.
    pub(crate) fn squares(&self) -> Option<[f64; 3]> {
        let squares = self.horizons.map(|errors| errors.model.sum / errors.model.count);
        squares.iter().all(|square| square.is_finite()).then_some(squares)
    }

    /// Mean square of the model in free runs.
    pub(crate) fn square_of_free_runs(&self) -> Option<f64> {
        let square = self.free_run.model.sum / self.free_run.model.count;
        square.is_finite().then_some(square)
    }

    /// The total of several.
    pub(crate) fn sum<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            for (into, from) in sum.horizons.iter_mut().zip(&one.horizons) {
                into.merge(from);
            }
            sum.free_run.merge(&one.free_run);
            sum
        })
    }

    /// The root mean squares.
    pub(crate) fn gap(&self) -> Gap {
        Gap {
            horizons_s: HORIZONS_S,
            error_mm: self.horizons.map(|errors| errors.model.root()),
            stay_put_mm: self.horizons.map(|errors| errors.stay_put.root()),
            floor_mm: self.horizons.map(|errors| errors.floor.root()),
            free_run_10s_mm: self.free_run.model.root(),
            floor_free_run_10s_mm: self.free_run.floor.root(),
        }
    }
}

impl Gap {
    /// Measures the gap between `model` and `recording`.
    #[must_use]
    pub fn measure(model: &Model, recording: &Recording) -> Self {
        Self::measure_where(model, recording, &|_| true)
    }

    /// The same with a noise floor of at most that of `other`, and at most the errors.
    pub(crate) fn with_floor_at_most(mut self, other: &Self) -> Self {
        let least = |all: [Option<f64>; 3]| all.into_iter().flatten().reduce(f64::min);
        for (at, floor) in self.floor_mm.iter_mut().enumerate() {
            *floor = least([*floor, other.floor_mm[at], self.error_mm[at]]);
        }
        let floors = [self.floor_free_run_10s_mm, other.floor_free_run_10s_mm, self.free_run_10s_mm];
        self.floor_free_run_10s_mm = least(floors);
        self
    }

    /// Measures the gap of the forecasts and free runs that start from rows for which `counts` holds.
    #[must_use]
    pub fn measure_where(model: &Model, recording: &Recording, counts: &dyn Fn(usize) -> bool) -> Self {
        Tally::sum(tallies(&Track::new(model, recording), &|row| counts(row).then_some(0)).iter()).gap()
    }
}

/// Errors of the forecasts and free runs that start from each row, by its group.
pub(crate) fn tallies(track: &Track<'_>, group: &dyn Fn(usize) -> Option<usize>) -> Vec<Tally> {
    let recording = track.recording();
    let mut all: Vec<Tally> = Vec::new();
    let mut add = |group: usize, tally: Tally| {
        all.resize(all.len().max(group + 1), Tally::default());
        all[group] = Tally::sum([all[group], tally].iter());
    };
    horizons(track, recording, group, &mut |group, horizons| add(group, Tally { horizons, ..Tally::default() }));
    for run in runs(track, recording, &|row| group(row).is_some()) {
        let Some(group) = group(run.row) else { continue };
        let mut free_run = Errors::default();
        for forecast in run.forecasts {
            free_run.add(recording.samples()[forecast.row].position_mm, run.start_mm, forecast);
        }
        add(group, Tally { free_run, ..Tally::default() });
    }
    all
}

/// The readings from which forecasts start: apart from each other, and further where these would take too many steps.
fn starts<'a>(track: &'a Track, recording: &'a Recording) -> impl Iterator<Item = usize> + 'a {
    let per_s = |count: usize| count as f64 / recording.duration_s().max(1e-9);
    let (rows_per_s, readings_per_s) = (per_s(recording.samples().len()), per_s(track.readings()));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let [steps, apart] = [track.readings() as f64 * rows_per_s, APART_S * readings_per_s].map(|count| count as usize);
    let apart = apart.max(1);
    let samples = recording.samples();
    let begins_s = |row: usize| warm_from_s(&samples[recording.flight_of(row)]);
    let is_warm = move |k: &usize| track.reading(*k).is_some_and(|(row, time_s, _)| time_s >= begins_s(row));
    (0..track.readings()).filter(is_warm).step_by((steps / apart).div_ceil(ENOUGH_STEPS).max(1) * apart)
}

/// When the first forecast of a flight may start, seconds.
fn warm_from_s(flight: &[Sample]) -> f64 {
    flight.first().map_or(0.0, |first| first.time_s) + settling_s(flight, WARM_UP_S)
}

fn horizons(
    track: &Track,
    recording: &Recording,
    group: &dyn Fn(usize) -> Option<usize>,
    show: &mut dyn FnMut(usize, [Errors; 3]),
) {
    let samples = recording.samples();
    let (mut flight, mut half_period_s) = (0..0, 0.0);
    for from in starts(track, recording) {
        let Some((row, start_s, start_mm)) = track.reading(from) else { continue };
        let Some(group) = group(row) else { continue };
        if !flight.contains(&row) {
            flight = recording.flight_of(row);
            half_period_s = recording.reading_period_s(&flight) / 2.0;
        }
        let mut errors = [Errors::default(); 3];
        let mut horizon = 0;
        for forecast in track.forecasts(from) {
            let ahead_s = samples[forecast.row].time_s - start_s;
            while horizon < HORIZONS_S.len() && ahead_s >= HORIZONS_S[horizon] - half_period_s {
                // A reading more than half a period, or 2 % of the horizon, too late belongs to another horizon.
                let slack_s = half_period_s.max(0.02 * HORIZONS_S[horizon]) + 1e-9;
                if ahead_s <= HORIZONS_S[horizon] + slack_s {
                    errors[horizon].add(samples[forecast.row].position_mm, start_mm, forecast);
                }
                horizon += 1;
            }
            if horizon == HORIZONS_S.len() {
                break;
            }
        }
        show(group, errors);
    }
}

/// A free run: the forecasts of every reading over 10 s, from the state at its start.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRun {
    /// The row of the reading at its start.
    pub row: usize,
    /// That reading, mm.
    pub start_mm: f64,
    /// The forecasts of the readings after it.
    pub forecasts: Vec<Forecast>,
}

/// Successive free runs: as many as fit into each flight of the recording.
#[must_use]
pub fn free_runs(model: &Model, recording: &Recording) -> Vec<FreeRun> {
    runs(&Track::new(model, recording), recording, &|_| true)
}

/// Those that start from a row for which `counts` holds.
fn runs(track: &Track, recording: &Recording, counts: &dyn Fn(usize) -> bool) -> Vec<FreeRun> {
    let samples = recording.samples();
    let (mut next_s, mut last_s, mut flight) = (0.0, 0.0, 0..0);
    let mut runs = Vec::new();
    for from in 0..track.readings() {
        let Some((row, start_s, start_mm)) = track.reading(from) else { continue };
        if !flight.contains(&row) {
            flight = recording.flight_of(row);
            (next_s, last_s) = (warm_from_s(&samples[flight.clone()]), samples[flight.end - 1].time_s);
        }
        if start_s < next_s || start_s + FREE_RUN_S > last_s {
            continue;
        }
        next_s = start_s + FREE_RUN_S;
        if !counts(row) {
            continue;
        }
        let forecasts = track.forecasts(from).take_while(|f| samples[f.row].time_s <= next_s).collect();
        runs.push(FreeRun { row, start_mm, forecasts });
    }
    runs
}

impl Errors {
    fn merge(&mut self, other: &Self) {
        self.model.merge(other.model);
        self.stay_put.merge(other.stay_put);
        self.floor.merge(other.floor);
    }

    fn add(&mut self, reading_mm: Option<f64>, start_mm: f64, forecast: Forecast) {
        let Some(reading_mm) = reading_mm else { return };
        self.model.add((forecast.position_mm - reading_mm).powi(2));
        self.stay_put.add((start_mm - reading_mm).powi(2));
        if let Some(variance_mm2) = forecast.variance_mm2 {
            self.floor.add(variance_mm2);
        }
    }
}

#[cfg(test)]
mod tests;
