//! What a diagnosis says of its logs themselves: how many, how long, and what each cannot answer.

use crate::next::Advice;
use diagnose::{Diagnosis, Finding};

/// What is said of the logs themselves.
#[derive(Clone, Copy, Debug)]
pub struct Logs<'a> {
    /// Their names.
    pub names: &'a [String],
    /// Their length together, seconds.
    pub duration_s: f64,
}

impl Logs<'_> {
    /// How many, and how long together; `None` for a single one.
    #[must_use]
    pub fn words(&self) -> Option<String> {
        let count = self.names.len();
        (count > 1).then(|| format!("{count} logs together, {:.1} s", self.duration_s))
    }
}

/// What each log cannot answer, with its name.
pub fn findings<'a>(found: &'a Diagnosis, logs: &Logs<'a>) -> impl Iterator<Item = (&'a str, &'a Finding)> {
    let names = logs.names;
    found.findings.iter().map(|noted| (names.get(noted.flight).map_or("", String::as_str), &noted.finding))
}

/// The same in sentences, by name where there are several logs, and what no experiment settles.
#[must_use]
pub fn sentences(found: &Diagnosis, advice: &Advice, logs: &Logs<'_>) -> Vec<String> {
    let several = logs.names.len() > 1;
    let sentence = |(name, finding)| if several { format!("{name}: {finding}") } else { format!("{finding}") };
    findings(found, logs).map(sentence).chain(advice.findings.iter().cloned()).collect()
}
