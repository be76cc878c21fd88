//! The actions: the patch for the simulator, the correction on the rig, and the next flight.

use super::Report;
use super::effects::is_mended;
use crate::report::diagnosis::mend;
use crate::report::diagnosis::words::without_experiment;
use crate::report::kit::page::parts::{spoken, to_copy};
use crate::report::kit::patch::rounded;
use diagnose::Change;
use maud::{Markup, html};
use plant::Entry;

pub(super) fn simulator(report: &Report<'_>) -> Markup {
    let (patch, made) = (rounded(&report.found.patch_toml()), report.made);
    html! {
        @if patch.is_empty() {
            p { "The config model needs no change." }
        } @else {
            p { "The mended model as a config patch, which replaces these keys of the config:" }
            (to_copy("patch", "mended.toml", &patch))
            p {
                // Only a config with a control loop can be flown.
                @if report.compensation.is_some() {
                    "Try it with " (made.then("airball simulate --patch mended.toml")) ", and on another record with "
                } @else { "Try it on another record with " }
                (made.then("airball replay LOG --patch mended.toml")) "."
            }
        }
    }
}

pub(super) fn rig(report: &Report<'_>) -> Markup {
    let model = &report.found.mended.model;
    let there = report.found.effects.iter().filter(|named| named.change != Change::Removed);
    let entries: Vec<&Entry> =
        there.filter(|named| is_mended(report.found, named)).map(|named| named.candidate.entry).collect();
    let mend = |entry: &Entry| mend::words(entry, model, report.compensation, report.words);
    let mends: Vec<(String, String)> = entries.iter().map(|entry| (spoken(entry.name), mend(entry))).collect();
    let blocks: Vec<String> =
        entries.iter().filter_map(|entry| mend::patch(entry, model, report.compensation)).collect();
    html! {
        @if mends.is_empty() {
            p { "No effect was found that could be corrected on the rig." }
        } @else {
            p { "The patch above puts the effect into the simulator. To remove it from the rig instead:" }
            dl { @for (name, words) in mends { dt { (name) } dd { (words) } } }
            @for (k, block) in blocks.iter().enumerate() {
                (to_copy(&format!("rig-patch-{k}"), "compensation.toml", block))
            }
        }
    }
}

pub(super) fn next(report: &Report<'_>) -> Markup {
    let Report { found, advice, made, .. } = *report;
    html! {
        @if let Some(next) = &advice.experiment {
            p { strong { (spoken(next.name)) } ". " (next.reason) }
            @if !next.separates.is_empty() {
                p {
                    "It separates " (next.separates.iter().map(|name| spoken(name)).collect::<Vec<_>>().join(", "))
                    (format!(", by about {:.0} nats a minute.", next.expected_nats))
                }
            }
            (to_copy("next-file", "next.toml", &next.file))
            @let simulate = made.then("airball simulate --experiment next.toml");
            @if report.words.is_ball_pipe() {
                p { "Fly it with " (made.then("airball run --experiment next.toml")) ", or first with "
                    (simulate) "." }
            } @else {
                p { "See it simulated with " (simulate) ", and give your rig the same setpoints and inputs." }
            }
        } @else {
            p { (without_experiment(found)) }
        }
        @for finding in &advice.findings { p { (finding) "." } }
    }
}
