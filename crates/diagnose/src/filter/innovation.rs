//! The likelihood of a model's Kalman innovations, robust to outliers.
//!
//! ```text
//! p(ν) = (1 − ε)·N(ν; 0, S) + ε·N(ν; 0, κ²·S)        ε = 0.002, κ = 10
//! ```
//!
//! One outlier costs a model some 10 nats instead of thousands, and updates its filter only by its probability of being
//! no outlier. The contamination is the same in every model, so likelihoods of different models can be compared.
//! Source: Huber, *Robust Statistics*, the gross-error model.

use crate::filter::censored::Cell;
use crate::stats::log_sum::log_sum;

/// Share ε of outliers in every model.
const WILD_SHARE: f64 = 0.002;
/// Ratio κ of an outlier's standard deviation to a usual one.
const WILD_WIDTH: f64 = 10.0;
/// Standard deviation of a sensor's believed outliers about their size, as a share of the size.
const WILD_SCATTER: f64 = 0.1;

/// The innovation of a reading under a model; for a fan speed, rpm take the place of mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// The row of the reading.
    pub row: usize,
    /// ŷ: expected reading, mm.
    pub expected_mm: f64,
    /// S: variance of the innovation ν, mm².
    pub variance_mm2: f64,
    /// Information of the reading on ŷ, relative to a usual one: 1 for a usual one, 0 for an outlier.
    pub weight: f64,
    /// Standardised innovation, √S·∂ln p/∂ŷ: for a usual reading ν/√S, normal with variance 1 under a right model.
    pub standardised: f64,
    /// Variance score, 2·∂ln p/∂ln S at the same ν: for a usual reading ν²/S − 1.
    pub variance_score: f64,
    /// ln p(ν), nats.
    pub log_density: f64,
    /// The sensor repeated its last reading: there is no expectation.
    pub repeat: bool,
}

/// A reading, and the model's assumptions about its measurement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    pub(crate) row: usize,
    pub(crate) position_mm: f64,
    /// Probability and size of the outliers in the model.
    pub(crate) outliers: Option<(f64, f64)>,
    /// Step of a quantised sensor, mm, and the resolution of the file, mm.
    pub(crate) coarse: Option<(f64, f64)>,
}

impl Innovation {
    /// Counts the reading by this much.
    pub(crate) fn weigh(&mut self, by: f64) {
        for number in [&mut self.weight, &mut self.standardised, &mut self.variance_score, &mut self.log_density] {
            *number *= by;
        }
    }

    /// The innovation of a reading with this expectation and variance.
    pub(crate) fn of(reading: Reading, expected_mm: f64, variance_mm2: f64) -> Self {
        let deviation = variance_mm2.sqrt();
        let residual = (reading.position_mm - expected_mm) / deviation;
        match reading.coarse {
            Some((step, fine)) => {
                let half = 0.5 * step / deviation;
                let cell = Cell::between(residual - half, residual + half);
                let wide = Cell::between((residual - half) / WILD_WIDTH, (residual + half) / WILD_WIDTH);
                let good = cell.log_probability - fine.ln() + (1.0 - WILD_SHARE).ln();
                let log_density = log_sum(good, wide.log_probability - fine.ln() + WILD_SHARE.ln());
                let share = (good - log_density).exp();
                Self {
                    row: reading.row,
                    expected_mm,
                    variance_mm2,
                    weight: share * (1.0 - cell.spread),
                    standardised: share * cell.shift,
                    variance_score: share * (cell.spread + cell.shift * cell.shift - 1.0),
                    log_density,
                    repeat: false,
                }
            }
            None => Self::of_fine(reading, expected_mm, variance_mm2),
        }
    }

    fn of_fine(reading: Reading, expected_mm: f64, variance_mm2: f64) -> Self {
        let residual = reading.position_mm - expected_mm;
        let scale = -0.5 * (std::f64::consts::TAU * variance_mm2).ln();
        let (share, size_mm) = reading.outliers.unwrap_or_default();
        let good = scale - 0.5 * residual.powi(2) / variance_mm2 + (1.0 - WILD_SHARE).ln() + (1.0 - share).ln();
        let wide = -0.5 * (residual / WILD_WIDTH).powi(2) / variance_mm2;
        let wide = scale + wide - WILD_WIDTH.ln() + WILD_SHARE.ln();
        let odds = (wide - good).exp();
        // So far out that the odds exceed all numbers, the reading is an outlier.
        let (mut log_density, mut weight) =
            if odds.is_finite() { (good + odds.ln_1p(), (1.0 + odds).recip()) } else { (wide, 0.0) };
        if share > 0.0 {
            // Outliers scatter about their size.
            let variance = variance_mm2 + (WILD_SCATTER * size_mm).powi(2);
            let scale = -0.5 * (std::f64::consts::TAU * variance).ln() + ((1.0 - WILD_SHARE) * share / 2.0).ln();
            for side in [size_mm, -size_mm] {
                log_density = log_sum(log_density, scale - 0.5 * (residual - side).powi(2) / variance);
            }
            weight = (good - log_density).exp();
        }
        let e = residual / variance_mm2.sqrt();
        Self {
            row: reading.row,
            expected_mm,
            variance_mm2,
            weight,
            standardised: weight * e,
            variance_score: weight * (e * e - 1.0),
            log_density,
            repeat: false,
        }
    }

    /// A reading that repeats the last one, and ln p of that.
    #[must_use]
    pub(crate) fn of_repeat(row: usize, log_density: f64) -> Self {
        Self {
            row,
            expected_mm: 0.0,
            variance_mm2: 1.0,
            weight: 0.0,
            standardised: 0.0,
            variance_score: 0.0,
            log_density,
            repeat: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Innovation, Reading};

    fn innovation(residual: f64, outliers: Option<(f64, f64)>, coarse: Option<(f64, f64)>) -> Innovation {
        Innovation::of(Reading { row: 0, position_mm: residual, outliers, coarse }, 0.0, 4.0)
    }

    #[test]
    fn the_density_integrates_to_one() {
        let step = 0.01;
        for outliers in [None, Some((0.1, 30.0)), Some((1.0, 0.0))] {
            let density = |k| innovation(f64::from(k) * step, outliers, None).log_density.exp();
            let total: f64 = (-20_000..20_000).map(|k| density(k) * step).sum();
            assert!((total - 1.0).abs() < 1e-9, "{outliers:?}: {total}");
        }
    }

    #[test]
    fn the_probabilities_of_coarse_readings_add_up_to_one() {
        let density = |k: i32| innovation(7.0 * f64::from(k) + 2.0, None, Some((7.0, 0.5))).log_density.exp();
        let total: f64 = (-40..40).map(|k| density(k) * 0.5).sum();
        assert!((total - 1.0).abs() < 1e-6, "{total}");
    }

    #[test]
    fn pull_and_stretch_are_the_slopes_of_the_density() {
        for coarse in [None, Some((5.0, 1.0))] {
            for residual in [-3.0, 0.7, 2.5] {
                let reading = Reading { row: 0, position_mm: residual, outliers: None, coarse };
                let at = |expected: f64, variance: f64| Innovation::of(reading, expected, variance);
                let standardised = (at(1e-5, 4.0).log_density - at(-1e-5, 4.0).log_density) / 2e-5 * 2.0;
                let variance_score = (at(0.0, 4.0004).log_density - at(0.0, 3.9996).log_density) / 1e-4 * 2.0 / 2.0;
                let here = at(0.0, 4.0);
                // The slopes leave out the outliers' part of the density.
                assert!(
                    (here.standardised - standardised).abs() < 0.01
                        && (here.variance_score - variance_score).abs() < 0.01,
                    "{here:?} {standardised} {variance_score}"
                );
            }
        }
    }

    #[test]
    fn a_usual_reading_counts_fully_and_a_wild_one_hardly() {
        assert!(innovation(2.0, None, None).weight > 0.99);
        let wild = innovation(20.0, None, None);
        assert!(wild.weight < 1e-10 && wild.log_density > -13.0, "{wild:?}");
    }
}
