//! Whether innovations follow from what was known before them: ridge regression on places and on what came before.
//!
//! ```text
//! gain = Σ over folds of ½·Σ( e² − (e − x·w)² )      w = (XᵀX + ρ·I)⁻¹·Xᵀe on the other folds
//! ```
//!
//! x: in which place of duty, height, speed and time the reading lies, and means of past innovations.
//! Source: Hoerl and Kennard, "Ridge regression", Technometrics 12 (1970).

use crate::folds::Folds;
use crate::places::{Row, Spot};
use nalgebra::{DMatrix, DVector};

/// Windows of past innovations: their ends, in readings before.
const WINDOWS: [usize; 9] = [1, 2, 4, 7, 12, 20, 35, 60, 100];
/// Ridge: as if each coefficient had been seen to be 0 in so many readings.
const RIDGE: f64 = 30.0;

/// Nats that the regression gains on folds kept back; below 0 where there is nothing to know.
pub(crate) fn regressed(rows: &[Row], spots: &[Spot], folds: &Folds) -> f64 {
    let features = places_and_past(rows, spots);
    let width = features.first().map_or(0, Vec::len);
    let fold_of: Vec<usize> = rows.iter().map(|row| folds.of(row.row).unwrap_or_default()).collect();
    let mut parts = vec![(DMatrix::<f64>::zeros(width, width), DVector::<f64>::zeros(width)); Folds::COUNT];
    for ((x, row), fold) in features.iter().zip(rows).zip(&fold_of) {
        let (squares, products) = &mut parts[*fold];
        for i in 0..width {
            products[i] += x[i] * row.pull;
            for j in 0..=i {
                squares[(i, j)] += x[i] * x[j];
            }
        }
    }
    let mut nats = 0.0;
    for fold in 0..Folds::COUNT {
        let Some(weights) = weights_without(fold, &parts) else { continue };
        for ((x, row), _) in features.iter().zip(rows).zip(&fold_of).filter(|(_, own)| **own == fold) {
            let guess: f64 = x.iter().zip(weights.iter()).map(|(x, w)| x * w).sum();
            nats += 0.5 * (row.pull * row.pull - (row.pull - guess).powi(2));
        }
    }
    nats
}

fn weights_without(fold: usize, parts: &[(DMatrix<f64>, DVector<f64>)]) -> Option<DVector<f64>> {
    let width = parts.first().map_or(0, |(_, products)| products.len());
    let mut squares = DMatrix::<f64>::identity(width, width) * RIDGE;
    let mut products = DVector::zeros(width);
    for (_, (s, p)) in parts.iter().enumerate().filter(|(other, _)| *other != fold) {
        squares += s;
        products += p;
    }
    squares.fill_upper_triangle_with_lower_triangle();
    squares.cholesky().map(|factor| factor.solve(&products))
}

/// Places of duty, height, speed and time, and means of past innovations.
fn places_and_past(rows: &[Row], spots: &[Spot]) -> Vec<Vec<f64>> {
    let width = spots.len() + WINDOWS.len() - 1;
    let mut features = vec![vec![0.0; width]; rows.len()];
    for (at, (.., place)) in spots.iter().enumerate() {
        for &k in place {
            features[k][at] = 1.0;
        }
    }
    let mut sums = vec![0.0];
    for row in rows {
        sums.push(sums.last().copied().unwrap_or_default() + row.pull);
    }
    for (k, feature) in features.iter_mut().enumerate() {
        for (at, window) in WINDOWS.windows(2).enumerate() {
            let (from, to) = (k.saturating_sub(window[1]), (k + 1).saturating_sub(window[0]).min(k));
            let length = (window[1] - window[0]) as f64;
            feature[spots.len() + at] = (sums[to] - sums[from.min(to)]) / length.sqrt();
        }
    }
    features
}
