//! Residual tests of an identified model: whether its innovations are white and independent of earlier duties.
//!
//! ```text
//! e_k = ν_k/√S_k     x_k: e_{k−1} … e_{k−20} (whiteness), or means of the duty over windows of the past (input)
//! χ² = ( RSS of e on D − RSS of e on D and x ) / mean e²        D = ∂ŷ/∂θ/√S: the part of e that the fit explained
//! ```
//!
//! This is a score test. With D in both regressions the degrees of freedom are those of x alone. The p-value is right
//! for a fitted model, in closed loop too, because the duty of a row does not depend on later innovations.
//! Sources: Ljung, *System Identification*, 2nd edition, section 16.6; Breusch, "Testing for autocorrelation in dynamic
//! linear models" (1978).

use crate::filter::innovation::Innovation;
use crate::filter::track::innovations;
use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::stats::chi_square::survival;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Lags of the whiteness test, readings.
const LAGS: usize = 20;
/// Ends of the windows of duty before a reading, in readings.
const WINDOWS: [usize; 9] = [0, 1, 3, 6, 11, 19, 34, 59, 99];
/// Smallest eigenvalue of the regressors that counts, as a share of the largest.
const NO_DIRECTION: f64 = 1e-9;
/// Standard deviations on either side that contain 95 % of a normal distribution.
const BAND: f64 = 1.96;

/// A test: its χ², degrees of freedom and p-value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Test {
    /// χ².
    pub chi_square: f64,
    /// Degrees of freedom.
    pub degrees: usize,
    /// Probability of such a χ² or more if the model is right.
    pub p_value: f64,
}

/// The residual tests of a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidualTests {
    /// Test against earlier innovations.
    pub whiteness: Test,
    /// Test against earlier duties.
    pub input: Test,
    /// Autocorrelation at 1, 2, … readings.
    pub autocorrelation: Vec<f64>,
    /// Correlation with the duty 1, 2, … readings before.
    pub with_input: Vec<f64>,
    /// Limit that white innovations keep at 95 % of the lags.
    pub band: f64,
}

/// A reading that counts.
struct Row {
    e: f64,
    /// D: sensitivity of e to each fitted parameter.
    slopes: Vec<f64>,
    /// Earlier e, latest first; 0 before the flight.
    past: Vec<f64>,
    /// Earlier duties minus their mean.
    duty: Vec<f64>,
    windows: Vec<f64>,
}

impl ResidualTests {
    /// Tests the innovations of `fit` on the rows that count.
    #[must_use]
    pub fn of(fit: &Fit, recording: &Recording, folds: &Folds) -> Self {
        let rows = rows(fit, recording, folds);
        let power = rows.iter().map(|row| row.e * row.e).sum::<f64>() / rows.len().max(1) as f64;
        let test = |of: fn(&Row) -> &[f64]| test(&rows, of, power);
        let correlation = |of: fn(&Row) -> &[f64], lag: usize| {
            let product: f64 = rows.iter().map(|row| row.e * of(row)[lag]).sum();
            let square: f64 = rows.iter().map(|row| of(row)[lag].powi(2)).sum();
            product / (square * power * rows.len() as f64).sqrt().max(1e-300)
        };
        let all = |of: fn(&Row) -> &[f64]| (0..LAGS).map(|lag| correlation(of, lag)).collect();
        Self {
            whiteness: test(|row| &row.past),
            input: test(|row| &row.windows),
            autocorrelation: all(|row| &row.past),
            with_input: all(|row| &row.duty),
            band: BAND / (rows.len().max(1) as f64).sqrt(),
        }
    }
}

/// The innovations of readings, without those of fan speeds, which follow them.
fn readings(all: &[Innovation]) -> &[Innovation] {
    let end = all.windows(2).position(|pair| pair[1].row <= pair[0].row).map_or(all.len(), |at| at + 1);
    &all[..end]
}

fn rows(fit: &Fit, recording: &Recording, folds: &Folds) -> Vec<Row> {
    let nudged: Vec<Vec<Innovation>> = fit
        .parameters
        .iter()
        .map(|parameter| innovations(&parameter.stepped(&fit.model, Parameter::DIFFERENCE), recording))
        .collect();
    let seen = readings(&fit.innovations);
    let samples = recording.samples();
    let mean = samples.iter().map(|s| s.duty_percent).sum::<f64>() / samples.len().max(1) as f64;
    let mut rows = Vec::with_capacity(seen.len());
    let (mut flight, mut standardised_before, mut duties) = (0..0, Vec::new(), Vec::new());
    for (k, s) in seen.iter().enumerate() {
        if !flight.contains(&s.row) {
            flight = recording.flight_of(s.row);
            (standardised_before, duties) = (Vec::new(), Vec::new());
        }
        let before = |all: &[f64], lag: usize| all.len().checked_sub(lag).map_or(0.0, |at| all[at]);
        if folds.counts(s.row) && !s.repeat {
            let slope = |other: &Vec<Innovation>| {
                (other[k].expected_mm - s.expected_mm) / Parameter::DIFFERENCE / s.variance_mm2.sqrt()
            };
            rows.push(Row {
                e: s.standardised,
                slopes: nudged.iter().map(slope).collect(),
                past: (1..=LAGS).map(|lag| before(&standardised_before, lag)).collect(),
                duty: (1..=LAGS).map(|lag| before(&duties, lag)).collect(),
                windows: WINDOWS.windows(2).map(|ends| window(&duties, ends[0], ends[1])).collect(),
            });
        }
        standardised_before.push(if s.repeat { 0.0 } else { s.standardised });
        duties.push(samples[s.row].duty_percent - mean);
    }
    rows
}

/// The mean of `all` between `from` and `to` values before the end.
fn window(all: &[f64], from: usize, to: usize) -> f64 {
    let part = &all[all.len().saturating_sub(to)..all.len().saturating_sub(from)];
    part.iter().sum::<f64>() / (to - from) as f64
}

fn test(rows: &[Row], of: fn(&Row) -> &[f64], power: f64) -> Test {
    let own = rows.first().map_or(0, |row| row.slopes.len());
    let (without, rank) = explained(rows, |row| row.slopes.clone());
    let (with, full_rank) = explained(rows, |row| [&row.slopes[..own], of(row)].concat());
    let (chi_square, degrees) = ((with - without).max(0.0) / power.max(1e-300), full_rank.saturating_sub(rank));
    Test { chi_square, degrees, p_value: survival(degrees, chi_square) }
}

/// The part of Σe² that a regression on `x` explains, and the rank of `x`.
fn explained(rows: &[Row], x: impl Fn(&Row) -> Vec<f64>) -> (f64, usize) {
    let width = rows.first().map_or(0, |row| x(row).len());
    let (mut squares, mut products) = (DMatrix::<f64>::zeros(width, width), DVector::<f64>::zeros(width));
    for row in rows {
        let x = DVector::from_vec(x(row));
        products.axpy(row.e, &x, 1.0);
        squares.ger(1.0, &x, &x, 1.0);
    }
    // Each regressor is normalised, so that small units are not taken for weak directions.
    if !squares.iter().chain(&products).all(|number| number.is_finite()) {
        return (0.0, 0);
    }
    let size = squares.diagonal().map(|square| if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 });
    let scale = DMatrix::from_diagonal(&size);
    let eigen = (&scale * squares * &scale).symmetric_eigen();
    let along = eigen.eigenvectors.transpose() * (scale * products);
    let strongest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let kept = along.iter().zip(eigen.eigenvalues.iter()).filter(|(_, value)| **value > NO_DIRECTION * strongest);
    kept.fold((0.0, 0), |(sum, rank), (product, value)| (sum + product * product / value, rank + 1))
}
