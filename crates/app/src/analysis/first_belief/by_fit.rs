//! Input and position among columns whose names say nothing: the pair that a linear plant fits best. Columns that are
//! derived from the position, such as its speed, fit better than any input, and come last. A column whose speed is
//! another one is the position.
//!
//! Where position and setpoint are named and the input is not, such a column is the input if it fits better than the
//! distance from the setpoint, which drives a servo.

use super::derived::{input_is_rate, is_derived};
use super::roles::{Candidate, Named};
use super::scales::difference;
use super::words::{POSITIONS, SETPOINTS, SPEEDS};
use diagnose::linear::{Order, linear_fit};
use diagnose::{Recording, Sample};
use rows::{SheetColumn, held_if_sparse, spread_if_coarse};

const BY_FIT: &str = "of the columns without a telling name, the one that fits";
/// Most columns of which every pair is tried.
const MOST_TRIED: usize = 5;
/// Rows that a pair is tried on.
const TRIED_ROWS: usize = 4000;

/// The input and the position that fit best, of the columns whose names say nothing; `scale`: seconds per unit of the
/// time.
pub(super) fn by_fit(
    (time, scale): (&Candidate<'_>, f64),
    free: &[&Candidate<'_>],
    input: Option<&Named>,
    position: Option<&Named>,
) -> Option<(Named, Named)> {
    let times = seconds(time, scale);
    let allowed =
        |given: Option<&Named>, one: &Candidate<'_>| given.is_none_or(|named| named.column == one.column.name);
    let has_rate = |y: &Candidate<'_>| {
        let others = free.iter().take(MOST_TRIED).filter(|other| other.column.name != y.column.name);
        others.filter_map(|rate| recording(&times, rate, y)).any(|rows| input_is_rate(&rows))
    };
    let positions = free.iter().take(MOST_TRIED).filter(|y| allowed(position, y)).map(|y| (y, has_rate(y)));
    let positions: Vec<(&&Candidate<'_>, bool)> = positions.collect();
    let pairs =
        free.iter().take(MOST_TRIED).flat_map(|u| positions.iter().map(move |(y, has_rate)| (u, *y, *has_rate)));
    let pairs = pairs.filter(|(u, y, _)| u.column.name != y.column.name && allowed(input, u));
    let rated = pairs.filter_map(|(u, y, has_rate)| {
        let rows = recording(&times, u, y)?;
        let is_driven = !u.name.says(SPEEDS) && !is_derived(&rows);
        Some(((is_driven, has_rate), of_input(&rows)?, u, y))
    });
    let (.., u, y) = rated.max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
    let named = |one: &Candidate<'_>| Named { column: one.column.name.clone(), why: BY_FIT };
    Some((named(u), named(y)))
}

/// The column whose name says nothing that drives the position better than the distance from the setpoint does.
pub(super) fn drives_better_than_setpoint(
    (time, scale): (&Candidate<'_>, f64),
    free: &[&Candidate<'_>],
    position: &Candidate<'_>,
    setpoint: &Candidate<'_>,
) -> Option<Named> {
    let times = seconds(time, scale);
    let says_else = |one: &Candidate<'_>| [POSITIONS, SPEEDS, SETPOINTS].iter().any(|words| one.name.says(words));
    let may_drive = |one: &&&Candidate<'_>| !says_else(one) && !one.name.is_length_or_angle();
    let rated = free.iter().filter(may_drive).take(MOST_TRIED).filter_map(|u| {
        let rows = recording(&times, u, position).filter(|rows| !is_derived(rows))?;
        Some((of_input(&rows)?, u))
    });
    let (best, u) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let values = difference(setpoint.column, Some(position.column));
    let distance = SheetColumn { values, ..setpoint.column.clone() };
    let distance = Candidate { name: setpoint.name.clone(), column: &distance };
    let of_servo = recording(&times, &distance, position).and_then(|rows| of_input(&rows)).unwrap_or_default();
    (best > of_servo).then(|| Named { column: u.column.name.clone(), why: BY_FIT })
}

/// The first times, seconds.
fn seconds(time: &Candidate<'_>, scale: f64) -> Vec<Option<f64>> {
    let spread = spread_if_coarse(&time.column.values);
    let times = spread.as_deref().unwrap_or(&time.column.values).iter().take(TRIED_ROWS);
    times.map(|time| time.map(|time| scale * time)).collect()
}

/// By how much the input raises the log-likelihood, nats. The output may be a speed.
fn of_input(rows: &Recording) -> Option<f64> {
    let gains = [Order::First, Order::Second].map(|order| linear_fit(rows, order).map(|fit| fit.of_input));
    gains.into_iter().flatten().reduce(f64::max)
}

fn recording(times: &[Option<f64>], u: &Candidate<'_>, y: &Candidate<'_>) -> Option<Recording> {
    let [u, y] = [u, y].map(|one| &one.column.values);
    let held = held_if_sparse(u);
    let rows = times.iter().zip(held.as_ref().unwrap_or(u)).zip(y).take(TRIED_ROWS);
    let row = |((time_s, duty), position): ((&Option<f64>, &Option<f64>), &Option<f64>)| {
        Some(Sample { time_s: (*time_s)?, duty_percent: (*duty)?, position_mm: *position, ..Sample::default() })
    };
    Recording::new(rows.filter_map(row).collect()).ok()
}
