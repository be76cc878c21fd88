//! The noise floor of the sensor: the scatter of its readings of a ball at rest.
//!
//! ```text
//! σ² = Σ (y − line)²/(n − 2) − step²/12      line: least squares over time, so that drift does not count as noise
//! n' = n/(1 + 2·Σ ρ_k²)                      ρ_k: autocorrelation, as far as it is significant
//! interval of σ from χ² with n' degrees of freedom
//! ```
//!
//! step²/12 is the variance of rounding (Sheppard). Readings further off than five robust standard deviations are
//! outliers. They are counted and left out. Source: Priestley, *Spectral Analysis and Time Series*, "variance of the
//! sample autocovariance".

use super::hold::{Hold, holds};
use super::{Estimate, MeasureError};
use crate::record::recording::Recording;
use crate::stats::median::median;
use serde::Serialize;

/// Smallest number of readings.
const FEWEST: usize = 100;
/// Settling time of fan and ball, seconds.
const SETTLE_S: f64 = 2.0;
/// Limit of outliers, in robust standard deviations; and the ratio of standard deviation to median deviation of normal
/// numbers.
const WILD: f64 = 5.0;
const MEDIAN_TO_DEVIATION: f64 = 1.4826;
/// An autocorrelation above this many standard errors is significant.
const BEYOND_DOUBT: f64 = 2.5;

/// The noise of a sensor with the ball at rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Standard deviation of one reading, without rounding, mm.
    pub sensor_mm: Estimate,
    /// Drift of the readings, mm/s.
    pub drift_mm_per_s: Estimate,
    /// Correlation of one reading with the next.
    pub correlation: f64,
    /// Smallest step between readings, mm.
    pub resolution_mm: f64,
    /// Mean position of the ball, mm, by these readings.
    pub position_mm: f64,
    /// Readings used.
    pub readings: usize,
    /// Outliers, left out.
    pub wild: usize,
}

/// The noise floor from the longest stretch with constant duty.
///
/// # Errors
/// [`MeasureError::NoRest`] gives the number of readings.
pub fn noise_floor(recording: &Recording) -> Result<NoiseFloor, MeasureError> {
    let longest = holds(recording).into_iter().max_by(|a, b| a.duration_s().total_cmp(&b.duration_s()));
    of_rest(longest.as_ref().map_or(&[], |hold| hold.after(SETTLE_S)), recording.resolution_mm())
}

/// The noise floor of readings of a ball at rest.
pub(super) fn of_hold(hold: &Hold, resolution_mm: f64) -> Result<NoiseFloor, MeasureError> {
    of_rest(hold.after(SETTLE_S), resolution_mm)
}

fn of_rest(all: &[(f64, f64)], resolution_mm: f64) -> Result<NoiseFloor, MeasureError> {
    let good = without_wild(all);
    if good.len() < FEWEST {
        return Err(MeasureError::NoRest { found: good.len(), needed: FEWEST });
    }
    let n = good.len() as f64;
    let mean = |pick: fn(&(f64, f64)) -> f64| good.iter().map(pick).sum::<f64>() / n;
    let (middle_s, position_mm) = (mean(|r| r.0), mean(|r| r.1));
    let spread: f64 = good.iter().map(|(t, _)| (t - middle_s).powi(2)).sum();
    let slope = good.iter().map(|(t, mm)| (t - middle_s) * (mm - position_mm)).sum::<f64>() / spread;
    let rest: Vec<f64> = good.iter().map(|(t, mm)| mm - position_mm - slope * (t - middle_s)).collect();
    let variance = rest.iter().map(|e| e * e).sum::<f64>() / (n - 2.0);
    let correlations = correlations(&rest);
    let inflation = |power: i32| 1.0 + 2.0 * correlations.iter().map(|rho| rho.powi(power)).sum::<f64>();
    let sensor = (variance - resolution_mm * resolution_mm / 12.0).max(0.0).sqrt();
    let deviation = Estimate::of_deviation(variance.sqrt(), (n - 2.0) / inflation(2));
    // The variance of rounding is known: the interval of the sum, scaled, is that of the noise.
    let own = sensor / variance.sqrt().max(f64::MIN_POSITIVE);
    Ok(NoiseFloor {
        sensor_mm: deviation.mapped(own, 0.0),
        drift_mm_per_s: Estimate::normal(slope, (variance * inflation(1).max(0.1) / spread).sqrt()),
        correlation: correlation(&rest, 1),
        resolution_mm,
        position_mm,
        readings: good.len(),
        wild: all.len() - good.len(),
    })
}

fn without_wild(all: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let Some(centre) = median(all.iter().map(|(_, mm)| *mm).collect()) else { return Vec::new() };
    let distance = median(all.iter().map(|(_, mm)| (mm - centre).abs()).collect());
    let deviation = distance.map_or(0.0, |distance| MEDIAN_TO_DEVIATION * distance);
    // The median deviation of a sensor coarser than its noise is 0.
    all.iter().filter(|(_, mm)| deviation <= 0.0 || (mm - centre).abs() <= WILD * deviation).copied().collect()
}

/// Autocorrelations from lag 1 up to the first that is not significant.
fn correlations(rest: &[f64]) -> Vec<f64> {
    let doubt = BEYOND_DOUBT / (rest.len() as f64).sqrt();
    (1..rest.len() / 4).map(|lag| correlation(rest, lag)).take_while(|rho| rho.abs() > doubt).collect()
}

fn correlation(rest: &[f64], lag: usize) -> f64 {
    let power: f64 = rest.iter().map(|e| e * e).sum();
    let together: f64 = rest.iter().zip(rest.iter().skip(lag)).map(|(a, b)| a * b).sum();
    if power > 0.0 { together / power } else { 0.0 }
}
