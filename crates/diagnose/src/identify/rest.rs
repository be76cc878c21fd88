//! A record without the rest that it begins and ends with.
//!
//! A rig that rests before its experiment, at an end or by friction, does not answer the input, which no linear plant
//! describes: a ball on the ground stays there under no thrust, as if gravity were nothing.

use crate::record::recording::{Recording, Sample};
use crate::stats::median::median;

/// A rest has at least so many readings, and of all at most this share: a rig that hardly moves shows what it shows.
/// All numbers here were chosen by hand; they matter only where the whole record does not show the sign.
const FEWEST: usize = 20;
const MOST: f64 = 0.5;
/// Readings within so many standard deviations of the noise are those of one place.
const NEAR: f64 = 5.0;
/// Median of the absolute value of a standard normal number.
const MEDIAN_ABSOLUTE: f64 = 0.6745;

/// `flight` without the rows in which the rig rests before its first motion and after its last. `None`: it has no such
/// rest.
pub(super) fn moving_part(flight: &Recording) -> Option<Recording> {
    let rows = flight.samples();
    let readings: Vec<(usize, f64)> =
        rows.iter().enumerate().filter_map(|(row, sample)| Some((row, sample.position_mm?))).collect();
    let near_mm = NEAR * noise_mm(&readings)?.max(flight.rounding_mm());
    let (before, after) = (at_rest(readings.iter(), near_mm), at_rest(readings.iter().rev(), near_mm));
    if before + after == 0 || (before + after) as f64 > MOST * readings.len() as f64 {
        return None;
    }
    let (first, last) = (readings[before].0, readings[readings.len() - 1 - after].0);
    let kept: Vec<Sample> = rows[first..=last].to_vec();
    Recording::new(kept).ok()
}

/// Number of the first of these readings that lie near one place; 0 where they are few.
fn at_rest<'a>(readings: impl Iterator<Item = &'a (usize, f64)> + Clone, near_mm: f64) -> usize {
    let Some(place) = median(readings.clone().take(FEWEST).map(|(_, mm)| *mm).collect()) else { return 0 };
    let count = readings.take_while(|(_, mm)| (mm - place).abs() <= near_mm).count();
    if count < FEWEST { 0 } else { count }
}

/// Standard deviation of a reading, from the second differences of successive ones, mm.
fn noise_mm(readings: &[(usize, f64)]) -> Option<f64> {
    let bent = readings.windows(3).map(|three| (three[0].1 - 2.0 * three[1].1 + three[2].1).abs()).collect();
    Some(median(bent)? / MEDIAN_ABSOLUTE / 6.0_f64.sqrt())
}
