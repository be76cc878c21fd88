//! Calibration of the probabilities.
//!
//! ```text
//! Brier score = mean of (probability − 1 where the entry names a true effect, 0 where not)²
//! ```
//!
//! Every entry of every answer counts, also on rigs without an effect and outside the catalogue.

use crate::Case;
use crate::outcome::is_there;
use serde::Serialize;

/// Number of bins of equal width.
const BINS: usize = 10;

/// The calibration of the probabilities.
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    /// Entries that were scored.
    pub entries: usize,
    /// Brier score: 0 is perfect, 0.25 results from a constant probability of 50 %.
    pub brier: Option<f64>,
    /// Probabilities in bins of equal width.
    pub bins: Vec<Bin>,
}

/// Entries with probabilities from `from` to `to`.
#[derive(Clone, Debug, Serialize)]
pub struct Bin {
    /// Lower end.
    pub from: f64,
    /// Upper end; it is included in the last bin only.
    pub to: f64,
    /// Entries in it.
    pub entries: usize,
    /// Their mean probability.
    pub mean_probability: Option<f64>,
    /// The share of right ones.
    pub share_right: Option<f64>,
}

impl Calibration {
    /// Scores all entries of all answers.
    pub(crate) fn of(cases: &[Case]) -> Self {
        let all: Vec<(f64, bool)> = cases.iter().flat_map(claims).collect();
        let brier = mean(all.iter().map(|(p, right)| (p - f64::from(u8::from(*right))).powi(2)));
        Self { entries: all.len(), brier, bins: (0..BINS).map(|k| bin(k, &all)).collect() }
    }
}

/// The probability of each entry, and whether it is right.
fn claims(case: &Case) -> Vec<(f64, bool)> {
    let entries = case.answer.iter().flat_map(|answer| &answer.effects);
    entries.map(|entry| (entry.probability, is_there(entry, case))).collect()
}

fn bin(k: usize, all: &[(f64, bool)]) -> Bin {
    let edge = |k: usize| k as f64 / BINS as f64;
    let (from, to) = (edge(k), edge(k + 1));
    let last = k + 1 == BINS;
    let own: Vec<&(f64, bool)> = all.iter().filter(|(p, _)| *p >= from && (*p < to || last)).collect();
    Bin {
        from,
        to,
        entries: own.len(),
        mean_probability: mean(own.iter().map(|(p, _)| *p)),
        share_right: mean(own.iter().map(|(_, right)| f64::from(u8::from(*right)))),
    }
}

/// The mean; `None` of nothing.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}
