//! Whether one column is derived from another: in another unit, from another origin, as its rate or its integral.
//! Neither drives the other then.
//!
//! ```text
//! copy       y = a + c·u + e               Var e < 0.1 % of Var y
//! rate       y = a + b·t + c·∫u dt + e     Var e < 10 % of Var (y − a − b·t)
//!            c = 10ᵏ times a ratio of units of angle, within 3 %, above 0
//! integral   the same with u and y exchanged
//! ```
//!
//! Without its last line the second form is also that of a motor, whose speed follows its voltage.

use super::scales::integral;
use diagnose::{Recording, Sample};
use std::f64::consts::{LN_10, PI};

/// The largest share of the variance that a copy leaves, by its rounding; chosen by hand.
const OF_COPY: f64 = 1e-3;
/// The same of a rate: a filter of the speed with a lag τ leaves (ωτ)² of a motion at ω, which allows 50 ms at 1 Hz.
const OF_RATE: f64 = 0.1;
/// Ratios of units of angle, up to a power of ten: the same, degrees and radians, turns per minute and radians, degrees
/// or turns per second.
const RATIOS: [f64; 6] = [1.0, 180.0 / PI, PI / 180.0, PI / 30.0, 6.0, 1.0 / 60.0];
/// Largest relative distance from such a ratio: less than the 4.7 % between the nearest two, 1 and 10·π/30.
const NEAR: f64 = 0.03;

/// Whether the input of a record is derived from its position, or the position from the input.
pub(super) fn is_derived(recording: &Recording) -> bool {
    let [t, u, y] = columns(recording);
    unexplained_share(&centred(&y), &centred(&u)) < OF_COPY || is_rate(&t, &u, &y) || is_rate(&t, &y, &u)
}

/// Whether the input of a record is the rate of its position.
pub(super) fn input_is_rate(recording: &Recording) -> bool {
    let [t, u, y] = columns(recording);
    is_rate(&t, &u, &y)
}

/// Time, input and position of the rows that have all three.
fn columns(recording: &Recording) -> [Vec<f64>; 3] {
    let known = |row: &Sample| Some([row.time_s, row.duty_percent, row.position_mm?]);
    let rows: Vec<[f64; 3]> = recording.samples().iter().filter_map(known).collect();
    [0, 1, 2].map(|column| rows.iter().map(|row| row[column]).collect())
}

/// Whether `u` is the rate of `y`.
fn is_rate(t: &[f64], u: &[f64], y: &[f64]) -> bool {
    let [times, rates] = [t, u].map(|values| values.iter().copied().map(Some).collect::<Vec<_>>());
    let integral: Vec<f64> = integral(&rates, &times, 1.0).into_iter().flatten().collect();
    let [t, integral, y] = [centred(t), centred(&integral), centred(y)];
    let (integral, y) = (residual(&integral, &t), residual(&y, &t));
    unexplained_share(&y, &integral) < OF_RATE && is_ratio_of_units(slope(&y, &integral))
}

/// Whether a number is the ratio of two units of length or angle, up to a power of ten.
fn is_ratio_of_units(ratio: f64) -> bool {
    let decades = |known: &f64| (ratio / known).log10();
    RATIOS.iter().map(decades).any(|decades| (decades - decades.round()).abs() < NEAR.ln_1p() / LN_10)
}

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| value - mean).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn slope(y: &[f64], x: &[f64]) -> f64 {
    dot(y, x) / dot(x, x)
}

/// The residual of the least-squares line through the origin.
fn residual(y: &[f64], x: &[f64]) -> Vec<f64> {
    let slope = slope(y, x);
    y.iter().zip(x).map(|(y, x)| y - slope * x).collect()
}

/// The share of the sum of squares of `y` in that residual. NaN where one of them is constant.
fn unexplained_share(y: &[f64], x: &[f64]) -> f64 {
    let residual = residual(y, x);
    dot(&residual, &residual) / dot(y, y)
}

#[cfg(test)]
mod tests {
    use super::{input_is_rate, is_derived};
    use diagnose::{Recording, Sample};

    fn record(input: impl Fn(f64) -> f64, position: impl Fn(f64) -> f64) -> Recording {
        let row = |k: u32| {
            let time_s = 0.01 * f64::from(k);
            Sample { time_s, duty_percent: input(time_s), position_mm: Some(position(time_s)), ..Sample::default() }
        };
        Recording::new((0..1000).map(row).collect()).unwrap()
    }

    #[test]
    fn a_speed_a_copy_in_another_unit_and_an_integral_are_derived_and_a_force_and_a_voltage_are_not() {
        let y = |t: f64| 3.0 * (2.0 * t).sin() + (5.0 * t).cos();
        let speed = |t: f64| 6.0 * (2.0 * t).cos() - 5.0 * (5.0 * t).sin();
        let force = |t: f64| -12.0 * (2.0 * t).sin() - 25.0 * (5.0 * t).cos();
        assert!(is_derived(&record(speed, y)) && input_is_rate(&record(speed, y)));
        assert!(is_derived(&record(|t| speed(t - 0.03), y)), "filtered");
        assert!(is_derived(&record(|t| speed(t).to_degrees(), y)), "in degrees per second");
        assert!(is_derived(&record(y, speed)) && !input_is_rate(&record(y, speed)), "the other way round");
        assert!(is_derived(&record(|t| 4.0 - 0.1 * y(t), y)), "a control error");
        assert!(!is_derived(&record(force, y)));
        assert!(!is_derived(&record(|t| 0.42 * speed(t), y)), "a voltage of a fast motor");
        assert!(!is_derived(&record(|_| 1.0, y)), "constant");
    }
}
