//! Free flight: the rows where the ball touches no end of the pipe, and has not for some time.

use crate::record::recording::Recording;
use plant::Model;
use std::ops::Range;

/// Time after the start, or after the ball rested at an end of the pipe, until the filter has settled, seconds.
const FORGET_S: f64 = 1.5;
/// A ball nearer to an end than this, mm, or five standard deviations of its sensor, rests there.
const AT_END_MM: f64 = 10.0;

/// Whether a ball at height `mm` rests at an end of the pipe.
pub(crate) fn is_at_end(model: &Model, mm: f64) -> bool {
    let near_mm = AT_END_MM.max(5.0 * model.noise.sensor_mm);
    mm < near_mm || mm > model.pipe_length_mm - near_mm
}

/// Which rows count in a comparison of models: those where the ball has been in free flight for some time. At an end
/// the state is not normally distributed, and a filter that assumes so gives biased parameters.
#[must_use]
pub fn in_free_flight(model: &Model, recording: &Recording) -> Vec<bool> {
    let of_flight = |flight: &Range<usize>| {
        let rows = &recording.samples()[flight.clone()];
        let mut quiet_from_s = rows.first().map_or(0.0, |first| first.time_s) + FORGET_S;
        let counts = rows.iter().map(move |sample| {
            if sample.position_mm.is_some_and(|mm| is_at_end(model, mm)) {
                quiet_from_s = sample.time_s + FORGET_S;
            }
            sample.time_s >= quiet_from_s
        });
        counts.collect::<Vec<bool>>()
    };
    recording.flights().iter().flat_map(of_flight).collect()
}
