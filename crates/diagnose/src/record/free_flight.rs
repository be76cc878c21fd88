//! Free flight: the rows where the ball touches no end of the pipe, and has not for some time.

use crate::record::recording::{Recording, Sample};
use plant::Model;
use std::ops::Range;

/// Time after the start, or after the ball rested at an end of the pipe, until the filter has settled, seconds.
pub const SETTLING_S: f64 = 1.5;
/// The same at most, as a share of a flight: a rig that moves for a second is recorded for as long. Chosen by hand.
const SETTLING_SHARE: f64 = 0.1;

/// The time that a filter takes to settle at the start of these rows, seconds: `at_most`, less in a short flight.
pub(crate) fn settling_s(flight: &[Sample], at_most_s: f64) -> f64 {
    let length_s = flight.last().zip(flight.first()).map_or(0.0, |(last, first)| last.time_s - first.time_s);
    at_most_s.min(SETTLING_SHARE * length_s)
}

/// A ball nearer to an end than this share of the pipe, 10 mm of 600, or than so many standard deviations of its sensor,
/// may touch it.
const NEAR: f64 = 1.0 / 60.0;
const NEAR_SIGMAS: f64 = 5.0;

/// The distance from an end, mm, within which a ball may touch it.
pub(crate) fn near_end_mm(model: &Model) -> f64 {
    (NEAR * model.pipe_length_mm).max(NEAR_SIGMAS * model.noise.sensor_mm)
}

/// Whether a ball at height `mm` rests at an end of the pipe.
pub(crate) fn is_at_end(model: &Model, mm: f64) -> bool {
    let (near_mm, (bottom, top)) = (near_end_mm(model), model.pipe_mm());
    mm < bottom + near_mm || mm > top - near_mm
}

/// Which rows count in a comparison of models: those where the ball has been in free flight for some time. At an end
/// the state is not normally distributed, and a filter that assumes so gives biased parameters.
#[must_use]
pub fn in_free_flight(model: &Model, recording: &Recording) -> Vec<bool> {
    let of_flight = |flight: &Range<usize>| {
        let rows = &recording.samples()[flight.clone()];
        let settling_s = settling_s(rows, SETTLING_S);
        let mut quiet_from_s = rows.first().map_or(0.0, |first| first.time_s) + settling_s;
        let counts = rows.iter().map(move |sample| {
            if sample.position_mm.is_some_and(|mm| is_at_end(model, mm)) {
                quiet_from_s = sample.time_s + settling_s;
            }
            sample.time_s >= quiet_from_s
        });
        counts.collect::<Vec<bool>>()
    };
    recording.flights().iter().flat_map(of_flight).collect()
}
