//! The page of a measurement: the result, its details, the patch, and the flight.

mod how;
mod said;

use super::plot::{flight, result};
use super::words::{Row, rows, said as in_words};
use crate::analysis::measurement::Found;
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{glossary, minus, number, table, to_copy, values};
use crate::report::kit::page::record::{Record, how_to_zoom};
use crate::report::kit::page::{Page, Section};
use crate::report::kit::plot::{Diagram, duty};
use config::Tables;
use diagnose::Recording;
use maud::{Markup, html};

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The measurement, by the command's name of it.
    pub what: &'a str,
    /// The name of the log.
    pub log: &'a str,
    /// The name of the config that was in force.
    pub config: &'a str,
    /// The content of that config.
    pub tables: &'a Tables,
    /// The rows of the log.
    pub recording: &'a Recording,
    /// What was found.
    pub found: &'a Found,
    /// It as a patch.
    pub patch: Patch<'a>,
}

/// The result as a patch.
#[derive(Clone, Copy)]
pub enum Patch<'a> {
    /// As a patch.
    Made(&'a str),
    /// A config holds no such number, or the config's value is not significantly different from the measured one.
    None,
    /// No patch, with the reason.
    Refused(&'a str),
}

/// The page of a measurement.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let record = Record { diagrams: vec![flight(report.recording), duty(report.recording)] };
    let sections = vec![
        Section::across("result", "What was measured", numbers(report)),
        Section::across("how", "How it was got", how::body(report.found)),
        Section::words("patch-section", "Believe it", patch(report)),
        Section::words("next", "What to do next", said::next(report)),
        Section::across(
            "record",
            "The whole flight",
            html! { (how_to_zoom()) (record.still(&[
                "Position over time: setpoint and position as read",
                "Duty over time",
            ])) },
        ),
        Section::words("words", "Words on this page", glossary(&said::words(report.found))),
    ];
    let from = vec![
        report.log.into(),
        format!("{:.1} s", report.recording.duration_s()),
        format!("config: {}", report.config),
    ];
    let (answer, first) = (said::answer(report.found), first(report));
    Page { kind: "measurement", from, made: report.made, answer: &answer, first, sections, record: &record }.render()
}

fn first(report: &Report<'_>) -> Markup {
    let line = |row: &Row| {
        let [value, interval] = said_of(row, "");
        (row.name.to_owned(), value, interval)
    };
    let numbers: Vec<_> = rows(report.found, report.tables).iter().map(line).collect();
    let diagram = result(report.recording, report.found);
    let words = said::figure(report.found);
    html! {
        p.lede { (minus(&said::lede(report.found))) }
        h2.unseen { "The result, and the picture that it was read off" }
        div.first {
            (values(&numbers))
            (figure(&Diagram { direct: true, ..diagram }, Size::FIRST, words, &html! { (words) "." }))
        }
    }
}

/// Value and interval as the page writes them.
fn said_of(row: &Row, absent: &str) -> [String; 2] {
    row.measured.map_or_else(
        || ["cannot tell".into(), absent.into()],
        |measured| in_words(measured, row.digits, row.unit).map(|words| minus(&words)),
    )
}

fn numbers(report: &Report<'_>) -> Markup {
    let all = rows(report.found, report.tables);
    let is_believed = all.iter().any(|row| row.believed.is_some());
    let row = |row: &Row| {
        let mut cells: Vec<Markup> = said_of(row, "–").iter().map(|words| html! { (words) }).collect();
        if is_believed {
            let verdict = match (row.measured, row.believed) {
                (Some(measured), Some(believed)) if measured.holds(believed) => "within the interval",
                (Some(_), Some(_)) => "outside it",
                _ => "–",
            };
            let believed = format!("{}{}", number(row.believed, row.digits), row.believed.map_or("", |_| row.unit));
            cells.extend([html! { (believed) }, html! { (verdict) }]);
        }
        (html! { (row.name) }, cells)
    };
    let mut heads = vec!["number", "measured", "90 % interval"];
    if is_believed {
        heads.extend(["config", "the config is"]);
    }
    html! {
        (table("What was measured, with 90 % intervals", &heads, &all.iter().map(row).collect::<Vec<_>>()))
        @for line in said::beside(report.found) { p { (line) } }
    }
}

fn patch(report: &Report<'_>) -> Markup {
    html! {
        @match report.patch {
            Patch::Made(text) => {
                p { "What was found as a patch. Later patches win over the config, and the rest of it stays as it is:" }
                (to_copy("patch", said::PATCH, text))
            }
            Patch::None => p { (said::no_patch(report.found)) },
            Patch::Refused(why) => p { "No patch can be made of this: " (why) "." },
        }
    }
}
