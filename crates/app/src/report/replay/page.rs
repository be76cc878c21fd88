//! The page of a replay: how far a model is from a log, per horizon.

use super::gap::{AS_GOOD_AS_NOISE, nearer, sentence};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{bars, findings, number, table};
use crate::report::kit::page::record::Record;
use crate::report::kit::page::{Page, Section};
use crate::report::kit::plot::{Diagram, commanded, duty};
use crate::report::replay::plot::{errors_of, free_runs_of};
use diagnose::{FreeRun, Gap, Recording};
use maud::{Markup, html};

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The name of the log.
    pub log: &'a str,
    /// The name of the config that holds the model.
    pub config: &'a str,
    /// The rows of the log.
    pub recording: &'a Recording,
    /// The findings of the check of the record.
    pub findings: &'a [String],
    /// Whether units, signs or columns are wrong.
    pub is_mistaken: bool,
    /// The gap.
    pub gap: &'a Gap,
    /// Free runs of the model.
    pub runs: &'a [FreeRun],
    /// A second model: the name of its patch, its gap, its free runs.
    pub against: Option<Against<'a>>,
}

/// A second model of a replay.
#[derive(Clone, Copy)]
pub struct Against<'a> {
    /// The name of its patch.
    pub patch: &'a str,
    /// Its gap.
    pub gap: &'a Gap,
    /// Its free runs.
    pub runs: &'a [FreeRun],
}

/// The page of a replay.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let position = || {
        let lines = vec![commanded(report.recording)];
        let runs = free_runs_of(report.recording, report.runs, report.against.map(|other| other.runs));
        Diagram { lines: lines.into_iter().chain(runs.lines).collect(), ..runs }
    };
    let errors = errors_of(report.recording, report.runs, report.against.map(|other| other.runs));
    let record = Record { diagrams: vec![position(), errors, duty(report.recording)] };
    let sections = vec![
        Section::across("horizons", "How far ahead it holds", horizons(report)),
        Section::words("check", "What the record can answer", findings(report.findings)),
        Section::across("record", "The whole record", whole(&record)),
    ];
    let from =
        vec![report.log.into(), format!("{:.1} s", report.recording.duration_s()), format!("model: {}", report.config)];
    let answer = match report.against {
        Some(other) => nearer(report.gap, other.gap, other.patch).trim_end_matches('.').to_owned(),
        None => answer(report.gap),
    };
    Page {
        kind: "replay",
        from,
        made: report.made,
        answer: &answer,
        first: first(report, position()),
        sections,
        record: &record,
    }
    .render()
}

fn answer(gap: &Gap) -> String {
    match (gap.error_mm[2], gap.floor_mm[2]) {
        (Some(error), Some(floor)) if error < AS_GOOD_AS_NOISE * floor => {
            "A second ahead the simulator is as near to the rig as noise allows".into()
        }
        (Some(error), Some(floor)) => {
            format!("A second ahead the simulator errs {:.1} times as far as noise alone makes it", error / floor)
        }
        _ => "This record is too short to say how far the simulator is from the rig".into(),
    }
}

fn first(report: &Report<'_>, position: Diagram) -> Markup {
    let gap = report.gap;
    let rows = [("the ball stays put", "setpoint", gap.stay_put_mm[2]), ("simulator", "nominal", gap.error_mm[2])];
    let other = report.against.map(|other| ("with the patch", "mended", other.gap.error_mm[2]));
    let rows: Vec<_> = rows.into_iter().chain(other).chain([("noise alone", "setpoint", gap.floor_mm[2])]).collect();
    let caption = html! {
        "Recorded position, and the model simulated from the recorded duty, restarted at the recorded position every \
         10 s."
    };
    let alt = "Position over the record: setpoint, recorded, and free runs of the simulator";
    html! {
        p.lede { (sentence(gap, report.recording, report.is_mistaken)) }
        h2.unseen { "The gap" }
        div.first {
            div.gap { (bars("Error of the position 1 s ahead, rms", "mm", &rows, gap.floor_mm[2])) }
            (figure(&Diagram { direct: true, ..position }, Size::FIRST, alt, &caption))
        }
    }
}

fn horizons(report: &Report<'_>) -> Markup {
    let gap = report.gap;
    let row = |head: String, values: [Option<f64>; 3], other: Option<Option<f64>>| {
        let ratio = values[1].zip(values[2]).map(|(error, floor)| error / floor);
        let cells = values.iter().map(|value| html! { (number(*value, 2)) }).chain([html! { (number(ratio, 2)) }]);
        (html! { (head) }, cells.chain(other.map(|value| html! { (number(value, 2)) })).collect())
    };
    let other = |of: &dyn Fn(&Gap) -> Option<f64>| report.against.map(|other| of(other.gap));
    let mut rows: Vec<(Markup, Vec<Markup>)> = (0..3)
        .map(|h| {
            let values = [gap.stay_put_mm[h], gap.error_mm[h], gap.floor_mm[h]];
            row(format!("{} s", gap.horizons_s[h]), values, other(&|gap| gap.error_mm[h]))
        })
        .collect();
    let values = [None, gap.free_run_10s_mm, gap.floor_free_run_10s_mm];
    rows.push(row("free run, 10 s".into(), values, other(&|gap| gap.free_run_10s_mm)));
    let mut heads = vec!["forecast ahead", "the ball stays put", "simulator", "noise alone", "simulator / noise"];
    heads.extend(report.against.map(|_| "with the patch"));
    table("Error of the position, rms, mm", &heads, &rows)
}

fn whole(record: &Record) -> Markup {
    html! {
        (crate::report::kit::page::record::how_to_zoom())
        (record.still(&[
            "Position over time: setpoint, recorded, and free runs of the simulator",
            "Recorded position minus free runs, over time",
            "Duty over time",
        ]))
    }
}
