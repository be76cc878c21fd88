//! The page of a comparison of two logs: what changed, and the free runs of both models on both records.

use super::document::{Comparison, SideEntry};
use super::words::{answer, effects, row};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{bars, glossary, minus, number, table};
use crate::report::kit::page::record::{Record, how_to_zoom};
use crate::report::kit::page::stretch::worst;
use crate::report::kit::page::{Page, Section};
use crate::report::kit::palette::{MENDED, NOMINAL};
use crate::report::kit::plot::{Diagram, commanded, forecasts, recorded};
use diagnose::{Changes, Side};
use maud::{Markup, html};

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The name of the config that holds the belief.
    pub config: &'a str,
    /// What changed.
    pub found: &'a Comparison,
    /// The records and models.
    pub changes: &'a Changes,
}

/// The page.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let found = report.found;
    let diagrams: Vec<Diagram> = report.changes.sides.iter().map(runs).collect();
    let record = Record { diagrams };
    let sections = vec![
        Section::across("numbers", "Numbers of the rig", numbers(found)),
        Section::across("runs", "Both models on both records", both(report)),
        Section::across("rig", "The rig before and after", sides(found)),
        Section::across("record", "The whole records", whole(&record)),
        Section::words("words", "Words on this page", glossary(&WORDS)),
    ];
    let mut from: Vec<String> = found.sides.iter().map(|side| side.name.clone()).collect();
    from.push(format!("belief: {}", report.config));
    let (answer, first) = (answer(found), first(report));
    Page { kind: "comparison", from, made: report.made, answer: &answer, first, sections, record: &record }.render()
}

fn first(report: &Report<'_>) -> Markup {
    let found = report.found;
    let changed = found.numbers.iter().filter(|one| one.is_beyond_chance).count();
    let [[own, other], _] = found.error_mm.unwrap_or_default().map(|side| side);
    let rows = [("model of before", "nominal", own), ("model of after", "mended", other)];
    let floor = report.changes.sides[0].gaps[0].floor_mm[2];
    html! {
        p.lede {
            (changed) " of " (found.numbers.len()) " numbers changed beyond chance (5 % over all of them together). "
        }
        h2.unseen { "The record before, and both models" }
        div.first {
            div.gap { (bars("Error of the position 1 s ahead on the record before, rms", "mm", &rows, floor)) }
            (stretch(&report.changes.sides[0], "before", Size::FIRST))
        }
    }
}

fn numbers(found: &Comparison) -> Markup {
    let one = |one: &diagnose::NumberChange| {
        let [name, before, after, difference, said] = row(one, found.numbers.len());
        let said = if one.is_beyond_chance {
            html! { strong { (said) } }
        } else {
            html! { (said) }
        };
        let cells = [before, after, difference].map(|cell| html! { (minus(&cell)) });
        (html! { code { (name) } }, cells.into_iter().chain([said]).collect())
    };
    let rows: Vec<(Markup, Vec<Markup>)> = found.numbers.iter().map(one).collect();
    html! {
        p { "One model with the effects of both sides, fitted to each record. Differences have 90 % intervals." }
        (table("Numbers before and after", &["number", "before", "after", "difference", "judgement"], &rows))
    }
}

/// A record, and the free runs of both models on it.
fn runs(side: &Side) -> Diagram {
    let [before, after] = &side.runs;
    let lines = vec![
        commanded(&side.recording),
        recorded(&side.recording),
        forecasts("model of before", NOMINAL, &side.recording, before),
        forecasts("model of after", MENDED, &side.recording, after),
    ];
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}

/// The part of a record where the model of the other side errs most.
fn stretch(side: &Side, name: &str, size: Size) -> Markup {
    let other = if name == "before" { &side.runs[1] } else { &side.runs[0] };
    let Some(part) = worst(&side.recording, other) else {
        return html! { p.nothing { "No 10 s of free flight are in the record " (name) " to draw." } };
    };
    let alt =
        format!("Position from {:.0} to {:.0} s of the record {name}, and free runs of both models", part.0, part.1);
    let caption = html! {
        "The record " (name) ", and both models simulated from its duty, restarted at the recorded position every 10 \
            s. \
         Shown is where the model of the other side errs most."
    };
    figure(&Diagram { direct: true, ..runs(side).within(part) }, size, &alt, &caption)
}

fn both(report: &Report<'_>) -> Markup {
    let [before, after] = &report.changes.sides;
    let cell = |value: Option<f64>| html! { (number(value, 2)) };
    let names = ["model of before", "model of after"];
    let row = |at: usize| {
        let of = |side: &Side| [cell(side.gaps[at].error_mm[2]), cell(side.gaps[at].free_run_10s_mm)];
        (html! { (names[at]) }, of(before).into_iter().chain(of(after)).collect())
    };
    let floor = |side: &Side, at: usize| [cell(side.gaps[at].floor_mm[2]), cell(side.gaps[at].floor_free_run_10s_mm)];
    let noise = (html! { "noise alone" }, floor(before, 0).into_iter().chain(floor(after, 1)).collect());
    let rows: Vec<(Markup, Vec<Markup>)> = vec![row(0), row(1), noise];
    let heads = ["model", "before, 1 s", "before, free run", "after, 1 s", "after, free run"];
    html! {
        (stretch(after, "after", Size::WIDE))
        (table("Errors of the position, rms, mm", &heads, &rows))
    }
}

fn sides(found: &Comparison) -> Markup {
    let row = |name: &str, of: &dyn Fn(&SideEntry) -> String| {
        (html! { (name) }, found.sides.iter().map(|side| html! { (of(side)) }).collect())
    };
    let mut rows: Vec<(Markup, Vec<Markup>)> = vec![
        row("verdict", &|side| side.verdict.replace('_', " ")),
        row("effects that were named", &|side| effects(side).replace('_', " ")),
        row("error of the belief 1 s ahead, mm", &|side| number(side.error_mm, 2)),
        row("overshoot, % of the step", &|side| number(side.overshoot_percent, 0)),
        row("settled, s", &|side| number(side.settling_s, 2)),
    ];
    if let Some(late) = found.lateness {
        let both = [late.before_ms, late.after_ms].map(|ms| html! { (number(Some(ms), 3)) });
        let name = if late.is_beyond_chance {
            "95 % of the cycles began within, ms: changed"
        } else {
            "95 % of the cycles began within, ms"
        };
        rows.push((html! { (name) }, both.into()));
    }
    table("Each record by itself", &["figure", "before", "after"], &rows)
}

fn whole(record: &Record) -> Markup {
    html! {
        (how_to_zoom())
        (record.still(&[
            "Position over the record before, and free runs of both models",
            "Position over the record after, and free runs of both models",
        ]))
    }
}

const WORDS: [(&str, &str); 4] = [
    ("model of before, model of after", "The belief with the effects of both sides, fitted to one record."),
    (
        "beyond chance",
        "If nothing changed, any number of the list would be called changed in 1 of 20 such comparisons.",
    ),
    ("noise alone", "The error that a correct model would have, from the noise of sensor and air."),
    ("free run", "The model simulated for 10 s from the recorded duty alone."),
];
