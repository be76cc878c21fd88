//! The scored part of a diagnosis, from its document (`airball.diagnosis/2`).

use diagnose::Verdict;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The answer for a case.
#[derive(Clone, Debug, Deserialize)]
pub struct Answer {
    /// The verdict.
    #[serde(with = "Word")]
    pub verdict: Verdict,
    /// The selected effects, most important first.
    pub effects: Vec<NamedEffect>,
    /// Gain, drag and hover.
    #[serde(default)]
    pub parameters: BTreeMap<String, Interval>,
    /// The share of the gap that is closed.
    #[serde(default)]
    pub gap: AnsweredGap,
    /// The place of the gap.
    #[serde(default)]
    pub r#where: AnsweredPlace,
}

/// A selected effect.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct NamedEffect {
    /// Its name.
    pub name: String,
    /// `added`, `retuned` or `removed`.
    #[serde(default)]
    pub change: String,
    /// The probability that it, or one of those below, is present.
    pub probability: f64,
    /// Effects from which it is not distinguishable.
    #[serde(default)]
    pub indistinguishable_from: Vec<String>,
    /// Its values.
    #[serde(default)]
    pub parameters: BTreeMap<String, Interval>,
}

/// A value with its 90 % interval, where there is one.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub struct Interval {
    /// The value.
    pub value: f64,
    /// Lower end.
    #[serde(default)]
    pub low: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub high: Option<f64>,
}

/// The gap in an answer.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct AnsweredGap {
    /// The share that is closed at 1 s.
    #[serde(default)]
    pub closed: Option<Interval>,
}

/// The place in an answer.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct AnsweredPlace {
    /// Stages with their shares.
    #[serde(default)]
    pub stage: Vec<AnsweredStage>,
}

/// A stage and its share.
#[derive(Clone, Debug, Deserialize)]
pub struct AnsweredStage {
    /// The stage.
    pub name: String,
    /// Its share.
    pub share: f64,
}

/// The names of the verdicts: a new verdict does not compile until it is added here.
#[derive(Deserialize)]
#[serde(remote = "Verdict", rename_all = "snake_case")]
enum Word {
    NoGap,
    Parameters,
    Effect,
    Unexplained,
    InsufficientData,
}

impl Answer {
    /// The verdict as its document writes it.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self.verdict {
            Verdict::NoGap => "no_gap",
            Verdict::Parameters => "parameters",
            Verdict::Effect => "effect",
            Verdict::Unexplained => "unexplained",
            Verdict::InsufficientData => "insufficient_data",
        }
    }

    /// The stage with the largest share.
    #[must_use]
    pub fn stage(&self) -> Option<&str> {
        let stages = self.r#where.stage.iter();
        stages.max_by(|a, b| a.share.total_cmp(&b.share)).map(|stage| stage.name.as_str())
    }
}
