//! Input and position among columns whose names say nothing: the pair that a linear plant fits best.

use super::roles::{Candidate, Named};
use diagnose::linear::{Order, linear_fit};
use diagnose::{Recording, Sample};
use rows::{is_coarse, spread};

const BY_FIT: &str = "of the columns without a telling name, the one that fits";
/// Most columns of which every pair is tried.
const MOST_TRIED: usize = 5;
/// Rows that a pair is tried on.
const TRIED_ROWS: usize = 4000;

/// The input and the position that fit best, of the columns whose names say nothing.
pub(super) fn by_fit(
    time: &Candidate<'_>,
    free: &[&Candidate<'_>],
    input: Option<&Named>,
    position: Option<&Named>,
) -> Option<(Named, Named)> {
    let allowed =
        |given: Option<&Named>, one: &Candidate<'_>| given.is_none_or(|named| named.column == one.column.name);
    let pairs = free.iter().take(MOST_TRIED).flat_map(|u| free.iter().take(MOST_TRIED).map(move |y| (u, y)));
    let pairs = pairs.filter(|(u, y)| u.column.name != y.column.name && allowed(input, u) && allowed(position, y));
    let rated = pairs.filter_map(|(u, y)| {
        let fit = linear_fit(&recording(time, u, y)?, Order::Second)?;
        Some((fit.of_input, u, y))
    });
    let (_, u, y) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let named = |one: &Candidate<'_>| Named { column: one.column.name.clone(), why: BY_FIT };
    Some((named(u), named(y)))
}

fn recording(time: &Candidate<'_>, u: &Candidate<'_>, y: &Candidate<'_>) -> Option<Recording> {
    let [time, u, y] = [time, u, y].map(|one| &one.column.values);
    let rows = time.iter().zip(u).zip(y).take(TRIED_ROWS);
    let row = |((time_s, duty), position): ((&Option<f64>, &Option<f64>), &Option<f64>)| {
        Some(Sample { time_s: (*time_s)?, duty_percent: (*duty)?, position_mm: *position, ..Sample::default() })
    };
    let mut samples: Vec<Sample> = rows.filter_map(row).collect();
    let mut times: Vec<f64> = samples.iter().map(|sample| sample.time_s).collect();
    if is_coarse(&times) {
        spread(&mut times);
        samples.iter_mut().zip(times).for_each(|(sample, time_s)| sample.time_s = time_s);
    }
    Recording::new(samples).ok()
}
