//! A diagnosis in words, for a terminal.

use super::{ladder, mend, place, sizes};
use crate::report::kit::words::p_value;
use config::words::Words;
use control::compensation::Compensation;
use diagnose::{Change, Check, Closed, Diagnosis, NamedEffect, SourceColumns, Verdict};
use std::fmt::Write;

/// The advice after a record with too little information.
const FLY_ANOTHER: &str = "Fly at least 30 s in free flight with a moving setpoint.";

/// The same where units, signs or columns are wrong.
const MEND_FIRST: &str = "Correct units, signs or columns as said above, and diagnose it again.";

/// The same where the unit of the duty may be wrong.
const MEND_OR_FLY: &str = "If the duties are in another unit, correct it as said above; else fly at least 30 s in \
                           free flight with a moving setpoint.";

/// What to do before anything else after a record that cannot answer; `None` where it can. Terminal and page use it.
#[must_use]
pub fn first_of_all(found: &Diagnosis) -> Option<&'static str> {
    let may_be_unit = found.findings.iter().any(|noted| matches!(noted.finding.check(), Check::Units));
    let advice = if found.has_mistake() {
        MEND_FIRST
    } else if may_be_unit {
        MEND_OR_FLY
    } else {
        FLY_ANOTHER
    };
    (found.verdict == Verdict::InsufficientData).then_some(advice)
}

/// What to try where no effect of the catalogue explains the gap.
const OTHER_EFFECTS: &str = "`airball config effects > effects.toml` writes effects that the catalogue lacks, and \
                         `--effects effects.toml` tries them too; the guide \"Write an effect of your own\" shows how \
                         to add the equation of another.";

/// What to do where there is no experiment to fly next. Terminal and page use it.
#[must_use]
pub fn without_experiment(found: &Diagnosis) -> &'static str {
    let other_effects = (found.verdict == Verdict::Unexplained).then_some(OTHER_EFFECTS);
    first_of_all(found).or(other_effects).unwrap_or("No further experiment is needed.")
}

/// The same as [`words_of`] for a ball pipe.
#[must_use]
pub fn words(found: &Diagnosis, compensation: Option<&Compensation>) -> String {
    words_of(found, compensation, &Words::default(), &SourceColumns::default())
}

/// The result in a sentence, then a line for each finding. `compensation`: the one of the recorded flight; `rig`: its
/// words, which decide how an effect is corrected; `columns`: those of the log.
#[must_use]
pub fn words_of(
    found: &Diagnosis,
    compensation: Option<&Compensation>,
    rig: &Words,
    columns: &SourceColumns,
) -> String {
    let mut words = format!("{}.", found.verdict_in_words());
    if let Some(advice) = first_of_all(found) {
        return format!("{words} {advice}");
    }
    for named in &found.effects {
        let _ = write!(words, "\n{}", effect(named, found, compensation, rig, columns));
    }
    for place in found.regions().iter().take(3) {
        let _ = write!(words, "\nwrong {} ({})", place::words(place, columns), p_value(place.p_value));
    }
    if let Some(residual) = found.residual_in_words() {
        let _ = write!(words, "\n{residual}");
    }
    if let Some(formula) = found.formula_in_words() {
        let _ = write!(words, "\n{formula}");
    }
    if let Some(left_out) = found.left_out_in_words() {
        let _ = write!(words, "\n{left_out}");
    }
    let _ = write!(words, "\n{}", ladder::table(found, rig));
    if let Some(Closed { value, low, high }) = found.closed {
        let [value, low, high] = [value, low, high].map(whole_percent);
        let _ = write!(words, "\n{value} % of the gap is closed ({low} to {high} %)");
    }
    if let Some(numbers) = found.numbers_in_words() {
        let _ = write!(words, "\n{numbers}");
    }
    if found.verdict == Verdict::Unexplained {
        let _ = write!(words, "\n{OTHER_EFFECTS}");
    }
    words
}

/// The line of an effect; below it its signature and its correction, unless it is absent.
fn effect(
    named: &NamedEffect,
    found: &Diagnosis,
    compensation: Option<&Compensation>,
    rig: &Words,
    columns: &SourceColumns,
) -> String {
    let (entry, line) = (named.candidate.entry, found.effect_in_words(named));
    if named.change == Change::Removed {
        return line;
    }
    let mend = mend::words(entry, &found.mended.model, compensation, rig);
    let sizes = sizes::in_the_log(named, found, columns).map(|sizes| format!("\n{:22} that is {sizes}", ""));
    let sizes = sizes.unwrap_or_default();
    format!("{line}{sizes}\n{:22} in a log: {}\n{:22} mend: {mend}", "", entry.in_a_log, "")
}

/// A share in whole percent; what rounds to 0 has no sign.
pub fn whole_percent(share: f64) -> String {
    format!("{:.0}", (100.0 * share).round() + 0.0)
}

#[cfg(test)]
mod tests {
    use super::whole_percent;

    #[test]
    fn a_share_that_rounds_to_nothing_has_no_sign() {
        assert_eq!([-0.004, 0.004, -0.006, 0.996].map(whole_percent), ["0", "0", "-1", "100"]);
    }
}
