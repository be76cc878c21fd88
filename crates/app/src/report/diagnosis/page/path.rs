//! The signal path, with the stages where simulator and rig differ: each with its effects, and how much of the gap
//! these close in the ladder.

use super::Report;
use crate::report::diagnosis::words::whole_percent;
use crate::report::kit::page::parts::{minus, spoken, stage};
use diagnose::{Rung, StageShare};
use maud::{Markup, html};

/// The elements of the signal path: name in words, and whether it is a stage, which can be wrong, or a signal.
const PATH: [(&str, bool); 9] = [
    ("setpoint", false),
    ("controller", true),
    ("compensation", true),
    ("duty", false),
    ("actuator", true),
    ("air", true),
    ("ball", true),
    ("sensor", true),
    ("position", false),
];

pub(super) fn body(report: &Report<'_>) -> Markup {
    let shares = report.found.stage_shares(&report.logs.deviations());
    let share = |name: &str| shares.iter().find(|stage| stage.name == if name == "duty" { "timing" } else { name });
    html! {
        figure.path {
            ol {
                @for (name, is_stage) in PATH {
                    @let own = named(report, name);
                    @let is_guilty = share(name).is_some() || !own.is_empty();
                    @let suspects = suspects(report, name);
                    @let class = if is_guilty { "guilty" } else if !suspects.is_empty() { "suspect" } else { "" };
                    li class=(format!("{} {class}", if is_stage { "stage" } else { "signal" })) {
                        span.name { (name) }
                        @if is_guilty {
                            strong { (blame(report, name, &own)) }
                            @if let Some(part) = part(report, &own, share(name)) { span.share { (part) } }
                        } @else if !suspects.is_empty() {
                            strong { "or " (suspects.join(", ")) }
                        }
                    }
                }
            }
            figcaption {
                span { "estimate, back to the controller" }
            }
        }
    }
}

/// The effects that were found at a stage.
fn named(report: &Report<'_>, at: &str) -> Vec<&'static str> {
    let found = report.found.effects.iter().map(|named| named.candidate.entry.name);
    found.filter(|name| stage(&report.found.mended.model.effects, name) == at).collect()
}

/// The error at a wrong stage, in a word or two.
fn blame(report: &Report<'_>, at: &str, own: &[&str]) -> String {
    let left_out = report.found.left_out();
    let word = |name: &&str| {
        let not = if left_out.contains(name) { " (not in the mended model)" } else { "" };
        format!("{}{not}", spoken(name))
    };
    match at {
        "controller" => "other controller".into(),
        "duty" => "late".into(),
        _ if own.is_empty() => "unexplained".into(),
        _ => own.iter().map(word).collect::<Vec<_>>().join(", "),
    }
}

/// How much the effects of a stage close in the mended model; of a stage without one, its share of the evidence.
fn part(report: &Report<'_>, own: &[&str], share: Option<&StageShare>) -> Option<String> {
    if own.is_empty() {
        return share.map(|stage| format!("{:.0} % of the evidence", 100.0 * stage.share));
    }
    let left_out = report.found.left_out();
    let kept = |rung: &&Rung| rung.name.is_some_and(|name| own.contains(&name) && !left_out.contains(&name));
    let closed: Vec<f64> = report.found.ladder.iter().filter(kept).filter_map(|rung| Some(rung.share?.value)).collect();
    let sum: f64 = closed.iter().sum();
    (!closed.is_empty()).then(|| minus(&format!("closes {} % of the gap", whole_percent(sum))))
}

/// The effects of a stage that are not distinguishable from those that were selected.
fn suspects(report: &Report<'_>, at: &str) -> Vec<String> {
    let others = report.found.effects.iter().flat_map(|named| &named.indistinguishable_from);
    others.filter(|name| stage(&report.found.mended.model.effects, name) == at).map(|name| spoken(name)).collect()
}
