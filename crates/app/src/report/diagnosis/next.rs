//! The next flight, in words.

use crate::analysis::next_experiment::Advice;

/// The experiment and the questions that none decides, one line each.
#[must_use]
pub fn words(advice: &Advice) -> Vec<String> {
    let experiment = advice.experiment.iter().map(|next| {
        format!("next: fly \"{}\", which --next-out FILE writes for --experiment FILE. {}", next.name, next.reason)
    });
    experiment.chain(advice.findings.iter().cloned()).collect()
}
