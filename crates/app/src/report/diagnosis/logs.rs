//! Statements about the logs of a diagnosis: their number, their length, and what each cannot answer.

use crate::analysis::log_errors::LogErrors;
use crate::analysis::loop_deviations::Upstream;
use crate::analysis::next_experiment::Advice;
use diagnose::{Diagnosis, Finding, SourceColumns};

/// The logs of a diagnosis.
#[derive(Clone, Copy, Debug)]
pub struct Logs<'a> {
    /// Their names.
    pub names: &'a [String],
    /// The columns that they were read from.
    pub columns: &'a SourceColumns,
    /// Their length together, seconds.
    pub duration_s: f64,
    /// Deviations of the loop from its config, with the number of the log.
    pub upstream: &'a [(usize, Upstream)],
    /// The forecast errors of each, where there are several.
    pub errors: &'a [LogErrors],
    /// What the belief is, where nobody wrote it.
    pub belief: Option<&'static str>,
}

impl<'a> Logs<'a> {
    /// Their number and total length; `None` for a single one.
    #[must_use]
    pub fn words(&self) -> Option<String> {
        let count = self.names.len();
        (count > 1).then(|| format!("{count} logs together, {:.1} s", self.duration_s))
    }

    /// The stages before the plant where the loop of a log deviated from its config, with the log-likelihood gain of
    /// each, nats.
    #[must_use]
    pub fn deviations(&self) -> Vec<(&'static str, f64)> {
        self.upstream.iter().map(|(_, stage)| (stage.name, stage.nats)).collect()
    }

    /// The same in sentences, with the log's name where there are several logs, after what the belief is.
    pub fn findings_of_loop(&self) -> impl Iterator<Item = String> {
        let of_loop = self.upstream().map(|(name, stage)| self.named(name, stage.finding.clone()));
        self.belief.map(Into::into).into_iter().chain(of_loop)
    }

    /// A finding after the name of its log where there are several.
    fn named(&self, name: &str, finding: String) -> String {
        if self.names.len() > 1 { format!("{name}: {finding}") } else { finding }
    }

    /// Deviations of the loop from its config, with the name of the log.
    pub fn upstream(&self) -> impl Iterator<Item = (&'a str, &'a Upstream)> {
        let names = self.names;
        self.upstream.iter().map(|(number, stage)| (names.get(*number).map_or("", String::as_str), stage))
    }
}

/// What each log cannot answer, with its name.
pub fn findings<'a>(found: &'a Diagnosis, logs: &Logs<'a>) -> impl Iterator<Item = (&'a str, &'a Finding)> {
    let names = logs.names;
    found.findings.iter().map(|noted| (names.get(noted.flight).map_or("", String::as_str), &noted.finding))
}

/// The same in sentences, with the log's name where there are several logs, and the questions that no experiment
/// decides.
#[must_use]
pub fn sentences(found: &Diagnosis, advice: &Advice, logs: &Logs<'_>) -> Vec<String> {
    let of_rows = findings(found, logs).map(|(name, finding)| logs.named(name, finding.in_columns(logs.columns)));
    of_rows.chain(logs.findings_of_loop()).chain(advice.findings.iter().cloned()).collect()
}
