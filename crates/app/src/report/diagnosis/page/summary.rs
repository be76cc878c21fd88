//! The top of the page, below the answer: the signal path with the wrong stage marked, the gap before and after, and
//! one picture.

use super::{Report, path};
use crate::report::diagnosis::ladder;
use crate::report::diagnosis::logs::sentences;
use crate::report::diagnosis::plot::runs;
use crate::report::diagnosis::words::{first_of_all, whole_percent};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::parts::{self, bars, capital};
use crate::report::kit::page::stretch::worst;
use crate::report::kit::plot::{Diagram, commanded};
use diagnose::{Closed, Rung, Series, Verdict, chance_in_words, with_rivals};
use maud::{Markup, html};

pub(super) fn body(report: &Report<'_>) -> Markup {
    if let Some(advice) = first_of_all(report.found) {
        return reasons(report, advice);
    }
    html! {
        p.lede { (lede(report)) }
        h2.unseen { "The signal path, and the stage where simulator and rig differ" }
        (path::body(report))
        h2.unseen { "The gap, before and after" }
        div.first { (gap(report)) (held_out(report.picture)) }
    }
}

/// Why the record cannot answer, and what to do.
fn reasons(report: &Report<'_>, first: &str) -> Markup {
    html! {
        h2.unseen { "Why the record cannot answer" }
        ul.reasons { @for reason in sentences(report.found, report.advice, report.logs) { li { (reason) } } }
        p.lede { (first) }
    }
}

fn lede(report: &Report<'_>) -> Markup {
    let found = report.found;
    let [nominal, _, mended] = &found.gaps;
    let errors = nominal.error_mm[2].zip(mended.error_mm[2]).zip(mended.floor_mm[2]);
    html! {
        @if let Some(((before, after), floor)) = errors {
            @let places = parts::places_of_errors(Some(floor));
            (format!("Forecast error of the simulator 1\u{a0}s ahead: {before:.places$}\u{a0}mm"))
            @if found.verdict != Verdict::NoGap { (format!("; of the mended model {after:.places$}\u{a0}mm")) }
            (format!("; of noise alone {floor:.places$}\u{a0}mm. "))
        }
        @for named in &found.effects {
            (capital(&with_rivals(named))) ": " (chance_in_words(named.probability)) " sure. "
        }
        @for (_, stage) in report.logs.upstream() { "Before the duty reaches the fan: " (stage.finding) ". " }
    }
}

/// Caption of the ladder.
const CAPTION: &str = "Error of the position 1 s ahead, rms, held out, and the share of the gap that each step closes";

/// A rung with the share of the gap that it closes.
fn rung_in_words(rung: &Rung) -> String {
    let share = ladder::share(rung).map_or(String::new(), |share| format!(": {share}"));
    ladder::name(rung) + &parts::minus(&share)
}

fn gap(report: &Report<'_>) -> Markup {
    let found = report.found;
    let floor = found.gaps[2].floor_mm[2];
    let names: Vec<String> = found.ladder.iter().map(rung_in_words).collect();
    let last = found.ladder.len().saturating_sub(1);
    let ink = |at: usize| match at {
        // Nothing to alarm about, and nothing mended, where there is no gap.
        _ if found.verdict == Verdict::NoGap => "setpoint",
        0 => "nominal",
        _ if at == last => "mended",
        _ => "setpoint",
    };
    let errors = found.ladder.iter().zip(&names).enumerate();
    let rows = errors.map(|(at, (rung, name))| (name.as_str(), ink(at), rung.error_mm[2]));
    let rows: Vec<_> = rows.chain([("noise alone", "setpoint", floor)]).collect();
    html! {
        div.gap {
            (bars(CAPTION, "mm", &rows, floor))
            @if let Some(Closed { value, low, high }) = found.closed {
                p.closed {
                    @let [value, low, high] = [value, low, high].map(|share| parts::minus(&whole_percent(share)));
                    strong { (value) " %" } " of the gap is closed"
                    span { (low) " to " (high) " %" }
                }
            } @else { p.closed { "The gap is too small to give a share." } }
        }
    }
}

/// Recorded, believed and mended positions, where the belief errs most.
fn held_out(picture: &Series) -> Markup {
    let Some(stretch) = worst(&picture.recording, &picture.nominal) else {
        return html! { p.nothing { "No 10 s of free flight are in this record to draw." } };
    };
    let mut diagram = runs(picture);
    diagram.lines.insert(0, commanded(&picture.recording));
    let alt = format!(
        "Position from {:.0} to {:.0} s of the record: setpoint, recorded, and free runs of the model as believed and mended",
        stretch.0, stretch.1
    );
    let caption = html! {
        "Recorded position, and two models simulated from the recorded duty, restarted at the recorded position every \
         10 s. The mended model was "
        "fitted without these stretches. Shown is the stretch where the config model errs most; " a href="#record" { "the \
             whole record" } " \
             is below."
    };
    figure(&Diagram { direct: true, ..diagram.within(stretch) }, Size::FIRST, &alt, &caption)
}
