//! Blind scoring: how often the diagnosis is right about rigs whose effect was withheld from it.
//!
//! [`score`] takes what is known of each case after its seal was opened ([`Truth`], [`Bounds`]) and what was answered
//! before ([`Answer`], the document of `diagnose --json`). The rules, each in one file:
//!
//! - `names`: an entry names an effect when the effect is its name or among those that it cannot be told from.
//! - `outcome`: what a case's answer is worth, in a word; what is not right is listed as a loss.
//! - `intervals`: whether 90 % intervals hold the truth, and how wide they are beside the Cramér–Rao bound.
//! - `calibration`: whether what was 80 % sure is right in 80 of 100.
//! - `closed`: the share of the gap that the true effects close, to hold the claimed one against.
//! - `shown`: how much a record shows of what is missing: the true model beside its best rival.
//! - `proportion`: every share comes with its Wilson interval.
//!
//! `page` puts it all into tables.
//!
//! Does no file and no network access; the program `blind` of this crate runs `airball diagnose` on the cases, reads
//! and prints.

mod answer;
mod calibration;
mod closed;
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
mod tests_support;

pub use answer::{Answer, Interval, NamedEffect};
pub use calibration::{Bin, Calibration};
pub use closed::closed_of_truth;
pub use intervals::{Numbers, ParameterScore};
pub use outcome::Outcome;
pub use page::{BlindDocument, page};
pub use proportion::Proportion;
pub use score::{Loss, Score, Share, score};
pub use shown::shown;
pub use truth::{Bounds, CaseTruth, Kind, TrueEffect, Truth, Values};

/// Everything that is known of a case: what was withheld, and what was answered.
#[derive(Clone, Debug)]
pub struct Case {
    /// What the rig is.
    pub truth: CaseTruth,
    /// What its record could tell at best, if that was worked out.
    pub bounds: Option<Bounds>,
    /// What was answered. `None`: the case could not be read.
    pub answer: Option<Answer>,
    /// What was answered when the search was not allowed to name the true effect. `None`: that was not asked.
    pub left_out: Option<Answer>,
    /// The share of the gap at 1 s that the true effects close.
    pub closed_of_truth: Option<f64>,
    /// Nats by which the true model beats its best rival, where that was worked out.
    pub shown: Option<f64>,
    /// Length of the pipe, mm; an end stop there is none.
    pub pipe_length_mm: f64,
}

impl Case {
    /// Nats that a perfect diagnosis gains beyond refitted base parameters.
    #[must_use]
    pub fn nats(&self) -> Option<f64> {
        self.bounds.as_ref().and_then(|bounds| bounds.nats)
    }
}
