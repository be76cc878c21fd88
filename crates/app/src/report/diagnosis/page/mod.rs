//! The page of a diagnosis, in the order of the questions: what is wrong, where, which effect, how much of the gap is
//! closed, what to do.

mod effects;
mod gap;
mod location;
mod mending;
mod path;
mod summary;

use super::logs::{Logs, findings};
use crate::analysis::next_experiment::Advice;
use crate::report::diagnosis::plot::{over_time, runs};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::checks;
use crate::report::kit::page::record::{Record, events};
use crate::report::kit::page::{Page, Section};
use crate::report::kit::plot::{Timeline, commanded, duty};
use config::words::Words;
use control::compensation::Compensation;
use diagnose::ClosedLoop;
use diagnose::{Diagnosis, Series, SourceColumn, Verdict};
use maud::{Markup, html};
use plant::Model;

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// What the rig calls its position and its input.
    pub words: &'a Words,
    /// The diagnosis.
    pub found: &'a Diagnosis,
    /// The belief.
    pub belief: &'a Model,
    /// The closed loop before and after.
    pub closed_loop: &'a ClosedLoop,
    /// The next flight.
    pub advice: &'a Advice,
    /// The logs.
    pub logs: &'a Logs<'a>,
    /// The name of the config that holds the belief.
    pub config: &'a str,
    /// The compensation that was on in flight, if it is known.
    pub compensation: Option<&'a Compensation>,
    /// What happened during the flights.
    pub timeline: &'a Timeline,
    /// The data of the picture.
    pub picture: &'a Series,
}

/// The page of a diagnosis.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let record = record(report);
    let sections = match report.found.verdict {
        Verdict::InsufficientData => vec![
            Section::words("next", "What to fly next", mending::next(report)),
            Section::words("check", "What was checked", check(report)),
            Section::across("record", "The whole record", whole(report, &record)),
        ],
        _ => all_sections(report, &record),
    };
    let answer = report.found.verdict_in_words();
    with(report, &answer, sections, &record).render()
}

/// What is seen first of the page of a diagnosis.
#[must_use]
pub fn first_screen(report: &Report<'_>) -> String {
    let answer = report.found.verdict_in_words();
    with(report, &answer, Vec::new(), &Record { diagrams: Vec::new() }).render_first()
}

fn with<'a>(report: &Report<'a>, answer: &'a str, sections: Vec<Section>, record: &'a Record) -> Page<'a> {
    let logs = report.logs;
    let mut from = logs.names.to_vec();
    let rows = report.picture.recording.samples().len();
    let rate = format!("{:.0} rows per second", rows as f64 / logs.duration_s.max(f64::MIN_POSITIVE));
    from.extend([format!("{:.1} s", logs.duration_s), rate, format!("belief: {}", report.config)]);
    from.extend(zero(&logs.columns.position_mm));
    Page { kind: "diagnosis", from, made: report.made, answer, first: summary::body(report), sections, record }
}

/// Where the zero of the file's own column lies, if `[import]` moves it: every position on the page counts from there.
fn zero(position: &SourceColumn) -> Option<String> {
    let SourceColumn { quoted, offset, .. } = position;
    (*offset != 0.0).then(|| format!("0 of the column {quoted} is at {offset} mm"))
}

fn all_sections(report: &Report<'_>, record: &Record) -> Vec<Section> {
    vec![
        Section::across("where", "Where simulator and rig differ", location::body(report)),
        Section::across("which", "Which effect it is", effects::body(report)),
        Section::across("how-far", "How much of the gap is closed", gap::body(report)),
        Section::words("simulator", "Correct the simulator", mending::simulator(report)),
        Section::words("rig", "Correct the rig", mending::rig(report)),
        Section::words("next", "What to fly next", mending::next(report)),
        Section::words("check", "What the record can answer", check(report)),
        Section::across("record", "The whole record", whole(report, record)),
        Section::words("words", "Words on this page", words()),
    ]
}

fn record(report: &Report<'_>) -> Record {
    let Report { picture, found, .. } = report;
    let mut position = runs(picture);
    position.lines.insert(0, commanded(&picture.recording));
    let mut diagrams = vec![position, duty(&picture.recording)];
    // Without a significant place the curve of the force is that of chance.
    if location::shows_force(&picture.missing, &found.regions()) {
        let mut force = over_time(&picture.missing, &found.regions());
        force.lines.iter_mut().for_each(|line| line.label = "");
        diagrams.push(force);
    }
    Record { diagrams: diagrams.into_iter().map(|diagram| diagram.with_events(report.timeline)).collect() }
}

fn whole(report: &Report<'_>, record: &Record) -> Markup {
    html! {
        p {
            "Position, duty and, where forecast errors are significant, residual force over the time of the record. \
                Each \
             model is simulated from the recorded duty and restarted at the recorded position every 10 s."
        }
        (crate::report::kit::page::record::how_to_zoom())
        (record.still(&[
            "Position over time: setpoint, recorded, free runs as believed and mended",
            "Duty over time",
            "Residual force over time, with its standard deviation",
        ]))
        (events(report.timeline))
    }
}

fn check(report: &Report<'_>) -> Markup {
    let Report { advice, logs, .. } = report;
    let several = logs.names.len() > 1;
    let found: Vec<_> =
        findings(report.found, logs).map(|(name, one)| (if several { name } else { "" }, one)).collect();
    let others: Vec<String> = logs.findings_of_loop().chain(advice.findings.iter().cloned()).collect();
    html! {
        p {
            @if logs.names.len() == 1 { "One log of " } @else { (logs.names.len()) " logs, together " }
            (format!("{:.1} s", logs.duration_s)) ", "
            (report.picture.recording.samples().iter().filter(|row| row.position_mm.is_some()).count()) " readings used."
        }
        (checks(&found, |check| report.found.was_checked(check)))
        @if !others.is_empty() { ul { @for other in &others { li { (other) "." } } } }
    }
}

fn words() -> Markup {
    html! {
        dl {
            dt { "as believed" } dd { "The model of the config (nominal model), unchanged." }
            dt { "mended" } dd { "The same model with refitted parameters, and with those of the found effects \
                 that make its forecasts better (corrected model)." }
            dt { "noise alone" }
            dd { "The error that a correct model would have, from the noise of sensor and air. It is the lowest that \
                 can be reached." }
            dt { "held out" }
            dd {
                "The record is cut into stretches of 5 s, which are divided into four folds. Each fold is forecast by \
                 a model that was fitted to the "
                "other three (cross-validation)."
            }
            dt { "residual force" }
            dd { "The force that the model lacks for the recorded motion, divided by the moving mass, upward, \
                 mm/s²." }
            dt { "nats" }
            dd {
                "Unit of a log-likelihood difference: 6 nats are odds of 400 to 1. Gains are on held-out "
                "stretches."
            }
            dt { "±, intervals" } dd { "90 % intervals: they contain the true value nine times in ten." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::zero;
    use diagnose::{SourceColumn, SourceColumns};

    #[test]
    fn a_zero_that_the_import_moves_is_said_where_it_lies() {
        let own = SourceColumns::default().position_mm;
        let column = |offset| SourceColumn { quoted: "\"angle_rad\"".into(), offset, ..own.clone() };
        assert_eq!(zero(&column(4000.0)).as_deref(), Some("0 of the column \"angle_rad\" is at 4000 mm"));
        assert_eq!(zero(&column(0.0)), None);
    }
}
