//! Blind scoring: how often the diagnosis is right about rigs whose effect was withheld from it.
//!
//! [`score`] takes the published truth of each case ([`Truth`], [`Bounds`]) and the earlier answer ([`Answer`], the
//! document of `diagnose --json`). The rules, each in one file:
//!
//! - `names`: an entry names an effect when the effect is its name or among those that it cannot be told from.
//! - `outcome`: the grade of a case's answer; one that is not right is listed as a loss.
//! - `intervals`: coverage of the 90 % intervals, and their width compared with the Cramér–Rao bound.
//! - `calibration`: whether 80 of 100 entries with a probability of 80 % are right.
//! - `closed`: the share of the gap that the true effects close, to compare with the claimed one.
//! - `shown`: the information of a record about the missing effect: the true model compared with its best rival.
//! - `proportion`: every share has a Wilson interval.
//!
//! `page` makes the tables.
//!
//! No file and no network access; the program `blind` of this crate runs `airball diagnose` on the cases, reads and
//! prints.

mod answer;
mod calibration;
mod closed;
mod clutter;
mod intervals;
mod names;
mod outcome;
mod page;
mod proportion;
mod score;
mod shown;
mod truth;

#[cfg(test)]
mod tests;
#[cfg(test)]
#[path = "../../diagnose/src/tests_support.rs"]
mod tests_support;

pub use answer::{Answer, Interval, NamedEffect};
pub use calibration::{Bin, Calibration};
pub use closed::{TrueShares, true_shares};
pub use intervals::{Numbers, ParameterScore};
pub use outcome::Outcome;
pub use page::{BlindDocument, page};
pub use proportion::Proportion;
pub use score::{Loss, Score, Share, score};
pub use shown::shown;
pub use truth::{Bounds, CaseTruth, Kind, TrueEffect, Truth, Values};

/// The data of a case: the withheld truth, and the answer.
#[derive(Clone, Debug)]
pub struct Case {
    /// The true rig.
    pub truth: CaseTruth,
    /// The bounds of its record, if they were computed.
    pub bounds: Option<Bounds>,
    /// The answer. `None`: the case could not be read.
    pub answer: Option<Answer>,
    /// The answer of a search without the true effect. `None`: it was not requested.
    pub left_out: Option<Answer>,
    /// The shares of the gap at 1 s that the true effects close.
    pub true_shares: Option<TrueShares>,
    /// Log-likelihood of the true model minus that of its best rival, nats, if it was computed.
    pub shown: Option<f64>,
    /// Length of the pipe, mm; an end stop at this height has no effect.
    pub pipe_length_mm: f64,
}

impl Case {
    /// Log-likelihood gain of a perfect diagnosis over refitted base parameters, nats.
    #[must_use]
    pub fn nats(&self) -> Option<f64> {
        self.bounds.as_ref().and_then(|bounds| bounds.nats)
    }
}
