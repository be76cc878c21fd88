//! Where in frequency a model is wrong: the periodogram of its innovations, which is flat for a right model.
//!
//! ```text
//! I(f) = |Σ e_k·exp(−2πi·f·t_k)|² / Σ e_k²         mean 1 at every frequency for white e_k, exponential
//! P(band) = mean over its frequencies of Σ I of segments of the record       2m·P ~ χ²(2m), m = width·T, for white e_k
//! ```
//!
//! The times are the real ones, so sampling need not be uniform. Sources: Scargle, Astrophysical Journal 263 (1982);
//! averaging over segments: Bartlett, Biometrika 37 (1950).

use crate::residual::location::Row;
use crate::stats::chi_square::survival;
use serde::Serialize;

/// The lowest frequency, Hz, and the highest of a uniform periodogram.
const SLOWEST_HZ: f64 = 0.03;
const FASTEST_HZ: f64 = 5.0;
/// Largest number of frequencies of a uniform periodogram.
const MOST_FREQUENCIES: f64 = 1500.0;
/// Length of a segment in periods of the lowest frequency of the band.
const PERIODS: f64 = 16.0;
/// Bands per octave.
const BANDS_AN_OCTAVE: f64 = 2.0;
/// A band next to the highest one belongs to the result if its excess power is above this share of the highest.
const BESIDE: f64 = 0.25;

/// A band of frequencies, and its share of the power above that of white noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Lower end, Hz.
    pub from: f64,
    /// Upper end, Hz.
    pub to: f64,
    /// Its share of the power above that of white noise.
    pub share: f64,
    /// Probability of so much power in any band if the model is right.
    pub p_value: f64,
}

/// The innovations, their mean, and the sum of squares about it.
struct Power<'a> {
    rows: &'a [Row],
    mean: f64,
    total: f64,
    span_s: f64,
}

impl<'a> Power<'a> {
    /// `None` without rows.
    fn of(rows: &'a [Row]) -> Option<Self> {
        let (first, last) = (rows.first()?, rows.last()?);
        let mean = rows.iter().map(|row| row.standardised).sum::<f64>() / rows.len() as f64;
        let total = rows.iter().map(|row| (row.standardised - mean).powi(2)).sum::<f64>().max(1e-300);
        Some(Self { rows, mean, total, span_s: (last.time_s - first.time_s).max(1.0) })
    }

    /// Power of a segment of the rows at a frequency.
    fn at(&self, hz: f64, piece: &[Row]) -> f64 {
        let turn = std::f64::consts::TAU * hz;
        let start_s = piece.first().map_or(0.0, |row| row.time_s);
        let (s, c) = piece.iter().fold((0.0, 0.0), |(s, c), row| {
            let (sin, cos) = (turn * (row.time_s - start_s)).sin_cos();
            (s + (row.standardised - self.mean) * sin, c + (row.standardised - self.mean) * cos)
        });
        (s * s + c * c) / self.total
    }

    /// Mean power of a band of frequencies, over segments of [`PERIODS`] of its longest period.
    fn of_band(&self, from_hz: f64, to_hz: f64) -> f64 {
        let piece_s = (PERIODS / from_hz).min(self.span_s);
        let piece = |row: &Row| (row.time_s / piece_s).floor();
        let pieces: Vec<&[Row]> = self.rows.chunk_by(|a, b| piece(a) == piece(b)).collect();
        let frequencies: Vec<f64> = steps(from_hz, to_hz, 0.5 / piece_s).collect();
        let power = |hz: &f64| pieces.iter().map(|piece| self.at(*hz, piece)).sum::<f64>();
        frequencies.iter().map(power).sum::<f64>() / frequencies.len() as f64
    }
}

/// From `from` to below `to` in steps of `by`.
fn steps(from: f64, to: f64, by: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from), move |at| Some(at + by)).take_while(move |at| *at < to)
}

/// Frequencies and powers up to [`FASTEST_HZ`], two per independent frequency.
pub(crate) fn periodogram(rows: &[Row]) -> Vec<(f64, f64)> {
    let Some(power) = Power::of(rows) else { return Vec::new() };
    let step_hz = (0.5 / power.span_s).max((FASTEST_HZ - SLOWEST_HZ) / MOST_FREQUENCIES);
    steps(SLOWEST_HZ, FASTEST_HZ, step_hz).map(|hz| (hz, power.at(hz, rows))).collect()
}

/// A band: its ends, its power above that of noise, and the probability of that power.
struct Part {
    from_hz: f64,
    to_hz: f64,
    excess: f64,
    chance: f64,
}

/// The band with most of the power above that of noise, up to half the sampling rate; `None` if no band has more.
pub(crate) fn band(rows: &[Row]) -> Option<Band> {
    let power = Power::of(rows)?;
    let fastest_hz = 0.5 * rows.len() as f64 / power.span_s;
    let wider = 2f64.powf(1.0 / BANDS_AN_OCTAVE);
    let starts = std::iter::successors(Some(SLOWEST_HZ), |hz| Some(hz * wider)).take_while(|hz| *hz < fastest_hz);
    let parts: Vec<Part> = starts.map(|hz| part(&power, hz, (hz * wider).min(fastest_hz))).collect();
    let total: f64 = parts.iter().map(|part| part.excess.max(0.0)).sum();
    let top = (0..parts.len()).max_by(|a, b| parts[*a].excess.total_cmp(&parts[*b].excess))?;
    let beside = |k: &usize| parts[*k].excess > BESIDE * parts[top].excess;
    let from = (0..=top).rev().take_while(beside).last()?;
    let to = (top..parts.len()).take_while(beside).last()?;
    let own = &parts[from..=to];
    let share = own.iter().map(|part| part.excess).sum::<f64>() / total.max(1e-12);
    // Bonferroni: one test per band.
    let least = own.iter().map(|part| part.chance).fold(1.0, f64::min);
    let p_value = (parts.len() as f64 * least).min(1.0);
    Some(Band { from: parts[from].from_hz, to: parts[to].to_hz, share, p_value }).filter(|_| parts[top].excess > 0.0)
}

fn part(power: &Power<'_>, from_hz: f64, to_hz: f64) -> Part {
    let mean = power.of_band(from_hz, to_hz);
    let independent = (to_hz - from_hz) * power.span_s;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number; a cast saturates")]
    let degrees = 2 * independent.round().max(1.0) as usize;
    Part { from_hz, to_hz, excess: (mean - 1.0) * independent, chance: survival(degrees, degrees as f64 * mean) }
}

#[cfg(test)]
mod tests {
    use super::{band, periodogram};
    use crate::residual::location::Row;
    use plant::Normal;

    /// White noise with a sine of amplitude `line`.
    fn rows(hz: f64, seed: u64, line: f64) -> Vec<Row> {
        let mut noise = Normal::new(seed, 0);
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            let standardised = noise.draw() + line * (std::f64::consts::TAU * hz * time_s).sin();
            Row { row: k as usize, time_s, known: [0.0; 4], standardised }
        };
        (0..4000).map(row).collect()
    }

    #[test]
    fn white_noise_has_power_one_on_average_and_a_line_is_found_in_its_band() {
        let white = periodogram(&rows(0.7, 3, 0.0));
        let mean = white.iter().map(|(_, power)| power).sum::<f64>() / white.len() as f64;
        // 400 independent frequencies of variance 1: five standard errors.
        assert!((mean - 1.0).abs() < 0.25, "{mean}");
        let found = band(&rows(0.7, 3, 0.5)).unwrap();
        assert!((found.from..found.to).contains(&0.7) && found.to < 1.0 && found.share > 0.6, "{found:?}");
        assert!(found.p_value < 1e-6, "{found:?}");
    }

    #[test]
    fn a_line_beyond_the_slow_frequencies_of_a_ball_is_found_as_well() {
        let found = band(&rows(17.0, 3, 0.5)).unwrap();
        assert!((found.from..found.to).contains(&17.0) && found.share > 0.5 && found.p_value < 1e-3, "{found:?}");
    }

    #[test]
    fn noise_has_a_band_of_a_small_p_value_no_more_often_than_it_says() {
        let short = |seed: u64| rows(0.7, seed, 0.0)[..1000].to_vec();
        let small = (0..300).filter(|seed| band(&short(*seed)).is_some_and(|band| band.p_value < 0.05)).count();
        // 5 % of 300 is 15. The probability of 25 or more is 1 %.
        assert!(small < 25, "{small}");
    }
}
