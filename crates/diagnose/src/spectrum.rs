//! Where in frequency a model is wrong: the periodogram of its innovations, which is flat when it is right.
//!
//! ```text
//! I(f) = |Σ e_k·exp(−2πi·f·t_k)|² / Σ e_k²         mean 1 at every frequency for white e_k
//! ```
//!
//! Times as they are: a clock that jitters is no hindrance. Source: Scargle, Astrophysical Journal 263 (1982).

use crate::places::Row;
use serde::Serialize;

/// Frequencies that are looked at, Hz.
const SLOWEST_HZ: f64 = 0.03;
const FASTEST_HZ: f64 = 5.0;
/// Octaves are cut into so many bands.
const BANDS_AN_OCTAVE: f64 = 2.0;
/// A band belongs to the place of the gap while its power is above this share of the highest band's.
const BESIDE: f64 = 0.25;

/// A band of frequencies, and its share of the power that a right model would not have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Where it begins, Hz.
    pub from: f64,
    /// Where it ends, Hz.
    pub to: f64,
    /// Its share of the power above that of white noise.
    pub share: f64,
}

/// Frequencies and powers, two to an independent frequency.
pub(crate) fn periodogram(rows: &[Row]) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
    let span_s = (last.time_s - first.time_s).max(1.0);
    let mean = rows.iter().map(|row| row.pull).sum::<f64>() / rows.len() as f64;
    let power: f64 = rows.iter().map(|row| (row.pull - mean).powi(2)).sum::<f64>().max(1e-300);
    let step_hz = (0.5 / span_s).max((FASTEST_HZ - SLOWEST_HZ) / MOST_FREQUENCIES);
    let frequencies =
        std::iter::successors(Some(SLOWEST_HZ), |hz| Some(hz + step_hz)).take_while(|hz| *hz < FASTEST_HZ);
    let height = |hz: f64| {
        let turn = std::f64::consts::TAU * hz;
        let (s, c) = rows.iter().fold((0.0, 0.0), |(s, c), row| {
            let (sin, cos) = (turn * (row.time_s - first.time_s)).sin_cos();
            (s + (row.pull - mean) * sin, c + (row.pull - mean) * cos)
        });
        (hz, (s * s + c * c) / power)
    };
    frequencies.map(height).collect()
}

/// Frequencies of a periodogram at most.
const MOST_FREQUENCIES: f64 = 1500.0;

/// The band that holds most of the power that is more than noise; `None` if there is none.
pub(crate) fn band(periodogram: &[(f64, f64)]) -> Option<Band> {
    let number = |hz: f64| (BANDS_AN_OCTAVE * (hz / SLOWEST_HZ).log2()).floor();
    let bands: Vec<&[(f64, f64)]> = periodogram.chunk_by(|a, b| number(a.0) == number(b.0)).collect();
    let excess = |band: &&[(f64, f64)]| band.iter().map(|(_, power)| power - 1.0).sum::<f64>();
    let excesses: Vec<f64> = bands.iter().map(excess).collect();
    let total: f64 = excesses.iter().map(|excess| excess.max(0.0)).sum();
    let top = (0..bands.len()).max_by(|a, b| excesses[*a].total_cmp(&excesses[*b]))?;
    let beside = |k: &usize| excesses[*k] > BESIDE * excesses[top];
    let from = (0..=top).rev().take_while(beside).last()?;
    let to = (top..bands.len()).take_while(beside).last()?;
    let share = excesses[from..=to].iter().sum::<f64>() / total.max(1e-12);
    Some(Band { from: bands[from].first()?.0, to: bands[to].last()?.0, share }).filter(|_| excesses[top] > 0.0)
}

#[cfg(test)]
mod tests {
    use super::{band, periodogram};
    use crate::places::Row;
    use plant::Normal;

    fn rows(line: f64) -> Vec<Row> {
        let mut noise = Normal::new(3, 0);
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            let pull = noise.draw() + line * (std::f64::consts::TAU * 0.7 * time_s).sin();
            Row { row: k as usize, time_s, known: [0.0; 4], pull }
        };
        (0..4000).map(row).collect()
    }

    #[test]
    fn white_noise_has_power_one_on_average_and_a_line_is_found_in_its_band() {
        let white = periodogram(&rows(0.0));
        let mean = white.iter().map(|(_, power)| power).sum::<f64>() / white.len() as f64;
        // 400 independent frequencies of variance 1: five standard errors.
        assert!((mean - 1.0).abs() < 0.25, "{mean}");
        let found = band(&periodogram(&rows(0.5))).unwrap();
        assert!((found.from..found.to).contains(&0.7) && found.to < 1.0 && found.share > 0.6, "{found:?}");
    }
}
