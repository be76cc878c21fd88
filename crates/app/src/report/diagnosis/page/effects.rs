//! The effects: those that were selected, with their parameters, and every candidate.

use super::Report;
use crate::report::diagnosis::{mend, sizes};
use crate::report::kit::page::parts::{number, spoken, stage, table, three_digits};
use diagnose::thresholds::{FIRST_EFFECT, INDISTINGUISHABLE, SECOND_EFFECT, SHARE_OF_OMITTED};
use diagnose::{Change, Diagnosis, Interval, NamedEffect, Scored, chance_in_words};
use maud::{Markup, html};
use plant::Effects;

/// The heads of the table of a search.
const HEADS: [&str; 6] = ["effect", "stage", "gain, nats", "evidence, nats", "probability in this search", "verdict"];

pub(super) fn body(report: &Report<'_>) -> Markup {
    let found = report.found;
    html! {
        @for named in &found.effects { (one(report, named)) }
        @if found.effects.is_empty() { p { "No effect was named." } }
        @if let Some((first, later)) = found.rounds.split_first() {
            h3 { "Every effect that was tried" }
            p {
                "Each effect of the catalogue was fitted together with gain, drag and hover and scored on held-out \
                 stretches; those that the "
                "screening rejected were not fitted in full. Evidence is the held-out gain, at most the gain in sample \
                 less one nat per parameter. An effect is named if its evidence "
                "is at least " (FIRST_EFFECT) " nats; a second one needs " (SECOND_EFFECT) " nats and \
                    " (format!("{:.0} \
                     %", 100.0 * SHARE_OF_OMITTED)) " \
                     of the remaining misfit. The probability in a search compares the effects of that search with each \
                     other and with none; the probability beside a name above counts all searches."
            }
            (tried(report, "Tried with the config model", first))
            @for (k, round) in later.iter().enumerate() {
                details {
                    summary { "Search " (k + 2) ", with what was found before it" }
                    (tried(report, &format!("Tried in search {}", k + 2), round))
                }
            }
        }
    }
}

/// Whether the mended model has the effect; without it, that model may forecast better.
pub(super) fn is_mended(found: &Diagnosis, named: &NamedEffect) -> bool {
    found.mended.model.effects.values(named.candidate.entry.name).is_some()
}

fn one(report: &Report<'_>, named: &NamedEffect) -> Markup {
    let entry = named.candidate.entry;
    let change = match named.change {
        Change::Added => "new",
        Change::Retuned => "in the config, of another size",
        Change::Removed => "in the config, and not found",
    };
    let is_left_out = named.change != Change::Removed && !is_mended(report.found, named);
    let width = report.found.difference(entry).map(|(difference, [value, low, high])| {
        (difference.key, Interval { value, low: Some(low), high: Some(high), at_bound: None })
    });
    let rows: Vec<(Markup, Vec<Markup>)> = report
        .found
        .effect_parameters(named)
        .into_iter()
        .chain(width)
        .map(|(key, interval)| {
            (html! { code { (key) } }, vec![html! { (three_digits(interval.value)) }, ends(&interval)])
        })
        .collect();
    html! {
        article.effect {
            h3 { (spoken(entry.name)) span.tag { (change) } span.tag { (chance_in_words(named.probability)) " sure" } }
            @if is_left_out { p { "The mended model is without it: with it, forecasts are no better." } }
            div.facts {
            (table(&format!("Numbers of the {}", spoken(entry.name)), &["number", "value", "90 % interval"], &rows))
            dl {
                @if let Some(sizes) = sizes::in_the_log(named, report.found, report.logs.columns) {
                    dt { "In the columns of the log" } dd { code { (sizes) } }
                }
                @if named.change != Change::Removed {
                    dt { "In a log" } dd { (entry.in_a_log) }
                    dt { "Correct it on the rig" } dd { (mend::words(entry, &report.found.mended.model, report.compensation, report.words)) }
                }
                dt { "Indistinguishable from" }
                dd {
                    @if named.indistinguishable_from.is_empty() { "No other effect explains the record as well." }
                    @for other in &named.indistinguishable_from { p { strong { (spoken(other)) } ": " (why(report, entry.name, other)) } }
                }
            }
            }
        }
    }
}

pub(super) fn ends(interval: &Interval) -> Markup {
    html! {
        @if let Some((low, high)) = interval.low.zip(interval.high) { (three_digits(low)) " to " (three_digits(high)) }
        @else { "not determined" }
        @if let Some(bound) = interval.at_bound { " (at " (three_digits(bound)) ", the bound of the search)" }
    }
}

/// Why two effects are not distinguishable.
fn why(report: &Report<'_>, name: &str, other: &str) -> String {
    let gain = |of: &str| {
        let rounds = report.found.rounds.iter();
        rounds
            .filter(|round| round.first().is_some_and(|best| best.name == name || best.name == other))
            .find_map(|round| round.iter().find(|one| one.name == of))
            .map(|one| one.held_out_gain)
    };
    let gains = gain(name).zip(gain(other));
    let nats = gains.map_or(String::new(), |(a, b)| format!(": {a:.1} and {b:.1} nats"));
    let twins = Effects::built_in(name).filter(|entry| entry.twins.contains(&other));
    let is_near = gains.is_none_or(|(a, b)| (a - b).abs() < INDISTINGUISHABLE);
    match twins.and_then(|entry| entry.acts.late) {
        Some(late) => format!("{}{nats}", late.why_twins()),
        None if !is_near => format!(
            "which of the two explains more differs from stretch to stretch, so that the difference may be \
             chance{nats} (Vuong's test)"
        ),
        None => format!(
            "both explain the held-out stretches about equally well{nats}; differences below {INDISTINGUISHABLE} nats \
             may be chance"
        ),
    }
}

fn tried(report: &Report<'_>, caption: &str, round: &[Scored]) -> Markup {
    let effects = &report.found.mended.model.effects;
    let named = |name: &str| report.found.effects.iter().find(|named| named.candidate.entry.name == name);
    let like = |name: &str| report.found.effects.iter().find(|named| named.indistinguishable_from.contains(&name));
    let mut all: Vec<(&Scored, Option<f64>)> = round.iter().zip(report.found.chances(round)).collect();
    all.sort_by(|a, b| b.0.held_out_gain.total_cmp(&a.0.held_out_gain));
    let (all, rejected): (Vec<_>, Vec<_>) = all.into_iter().partition(|(one, _)| one.in_full);
    let rejected: Vec<String> = rejected.iter().map(|(one, _)| spoken(one.name)).collect();
    let best = all.first().map(|(one, _)| one.name);
    let rows: Vec<(Markup, Vec<Markup>)> = all
        .into_iter()
        .map(|(one, likely)| {
            let is_best = best == Some(one.name);
            let said = match (named(one.name), like(one.name)) {
                (Some(_), _) if is_best => html! { strong { "named" } },
                (Some(_), _) => html! { "explains less here, named in another search" },
                (_, Some(best)) => html! { "indistinguishable from " (spoken(best.candidate.entry.name)) },
                _ if is_best && one.penalised_gain >= FIRST_EFFECT => {
                    html! { "explains most here, not needed in the end" }
                }
                _ => html! { "explains less" },
            };
            let chance = likely.map_or_else(|| "–".into(), chance_in_words);
            (
                html! { (spoken(one.name)) },
                vec![
                    html! { (stage(effects, one.name)) },
                    html! { (number(Some(one.held_out_gain), 1)) },
                    html! { (number(Some(one.penalised_gain), 1)) },
                    html! { (chance) },
                    said,
                ],
            )
        })
        .collect();
    html! {
        @if rows.is_empty() {
            p { (caption) ": none was fitted in full." }
        } @else {
            (table(caption, &HEADS, &rows))
        }
        @if !rejected.is_empty() { p { "Rejected by the screening: " (rejected.join(", ")) "." } }
    }
}
