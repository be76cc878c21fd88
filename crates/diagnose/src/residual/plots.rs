//! Data for residual plots: the spectrum of the innovations, and their correlation with earlier duties.
//!
//! ```text
//! power(band)  = mean of I(f) over a third of an octave            I(f): see `spectrum`, 1 for white innovations
//! r(lag)       = Σ e_k·(u(k − lag) − ū) / √(Σ e²·Σ (u − ū)²)       0 for a right model; 95 % within ±1.96/√n
//! ```
//!
//! The duty before a reading is known before it. Under a right model the innovation is independent of it, in closed
//! loop too. A dead time or lag that the model lacks shows as a peak at that lag.
//! Source: Ljung, *System Identification*, chapter "Model Validation".

use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::residual::location::{Row, rows};
use crate::residual::spectrum::periodogram;
use plant::Model;

/// Bands per octave.
const BANDS_AN_OCTAVE: f64 = 3.0;
/// The longest lag, seconds.
const LONGEST_S: f64 = 1.5;
/// Standard deviations on either side that contain 95 % of a normal distribution.
const OF_95_PERCENT: f64 = 1.96;

/// Spectrum and cross-correlation of the innovations of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResidualPlots {
    /// Middle of each band, Hz, and its power relative to white noise.
    pub spectrum: Vec<(f64, f64)>,
    /// Lag, seconds, and the correlation of the innovation with the duty at that lag.
    pub after_duty: Vec<(f64, f64)>,
    /// Limit that the correlation of a right model exceeds at 1 of 20 lags.
    pub by_chance: f64,
}

impl ResidualPlots {
    /// The plots of `model` for the rows that count.
    #[must_use]
    pub fn of(model: &Model, recording: &Recording, folds: &Folds) -> Self {
        let rows = rows(model, recording, folds);
        let by_chance = OF_95_PERCENT / (rows.len().max(1) as f64).sqrt();
        Self { spectrum: bands(&periodogram(&rows)), after_duty: after_duty(&rows), by_chance }
    }
}

fn bands(periodogram: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let number = |hz: f64| (BANDS_AN_OCTAVE * hz.log2()).floor();
    let middle = |band: &[(f64, f64)]| {
        let mean = |of: fn(&(f64, f64)) -> f64| band.iter().map(of).sum::<f64>() / band.len() as f64;
        (mean(|point| point.0), mean(|point| point.1))
    };
    periodogram.chunk_by(|a, b| number(a.0) == number(b.0)).map(middle).collect()
}

fn after_duty(rows: &[Row]) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
    let n = rows.len() as f64;
    let period_s = (last.time_s - first.time_s) / n;
    let mean = |of: fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / n;
    let (duty, standardised) = (mean(|row| row.known[0]), mean(|row| row.standardised));
    let power = |of: &dyn Fn(&Row) -> f64| rows.iter().map(|row| of(row).powi(2)).sum::<f64>();
    let scale = (power(&|row| row.known[0] - duty) * power(&|row| row.standardised - standardised)).sqrt().max(1e-300);
    let correlation = |lag: usize| {
        let pairs = rows.iter().zip(rows.iter().skip(lag));
        pairs.map(|(before, now)| (before.known[0] - duty) * (now.standardised - standardised)).sum::<f64>() / scale
    };
    let lags = (0..rows.len()).map(|lag| (lag, lag as f64 * period_s));
    lags.take_while(|(_, lag_s)| *lag_s <= LONGEST_S).map(|(lag, lag_s)| (lag_s, correlation(lag))).collect()
}

#[cfg(test)]
mod tests {
    use super::ResidualPlots;
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    #[test]
    fn a_right_model_leaves_white_noise_and_a_missing_lag_leaves_power_and_what_duty_foretells() {
        let recording = record(&model(), 4, 80);
        let left = |model: &Model| ResidualPlots::of(model, &recording, &Folds::new(model, &recording));
        let beyond = |left: &ResidualPlots| {
            let out = left.after_duty.iter().filter(|(_, r)| r.abs() > left.by_chance).count();
            out as f64 / left.after_duty.len() as f64
        };
        let (right, wrong) = (left(&model()), left(&Model { effects: Effects::default(), ..model() }));
        let most = |left: &ResidualPlots| left.spectrum.iter().map(|(_, power)| *power).fold(0.0, f64::max);
        assert!(beyond(&right) < 0.2 && beyond(&wrong) > 0.5, "{} and {}", beyond(&right), beyond(&wrong));
        assert!(most(&wrong) > 2.0 * most(&right), "{} and {}", most(&wrong), most(&right));
        assert!(right.spectrum.is_sorted_by_key(|band| band.0) && right.spectrum.len() > 15);
    }
}
