//! The page of a third pole: the fan's lag from the critical gain of the rig, and the loop that it predicts at half of
//! that gain.

use super::{PATCH, to_believe};
use crate::analysis::loop_margins::Loop;
use crate::report::design::page::{frequency, loci, step_first};
use crate::report::design::plot::Diagrams;
use crate::report::identify::third_pole::{Document, lines};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{capital, glossary, values};
use crate::report::kit::page::record::{Record, how_to_zoom};
use crate::report::kit::page::{Page, PageError, Section};
use maud::{Markup, html};

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The name of the config that holds the model.
    pub config: &'a str,
    /// What was found.
    pub found: &'a Document,
    /// The loop at half of the critical gain.
    pub half: &'a Loop,
    /// The lag as a patch.
    pub patch: &'a str,
}

/// The page of a third pole.
///
/// # Errors
/// [`PageError::Draw`]: the loop cannot be drawn.
pub fn page(report: &Report<'_>) -> Result<String, PageError> {
    let found = report.found;
    let drawn = Diagrams::of(report.half)?;
    let record = Record { diagrams: vec![drawn.step.clone()] };
    let sections = vec![
        Section::across("frequency", "The loop of half the critical gain, in frequency", frequency(&drawn)),
        Section::across("poles", "Its poles", loci(&drawn)),
        Section::words("simulator", "Believe it", to_believe(report.patch)),
        Section::words("next", "What to do next", next(found, report.made)),
        Section::across(
            "record",
            "The step, to look into",
            html! { (how_to_zoom()) (record.still(&["Step of the setpoint"])) },
        ),
        Section::words("words", "Words on this page", glossary(&WORDS)),
    ];
    let from = vec![format!("model: {}", report.config)];
    let answer = format!("A fan's lag of {:.3} s gives the model the critical gain of the rig", found.fan_lag_s);
    let first = first(found, &drawn);
    Ok(Page { kind: "identification", from, made: report.made, answer: &answer, first, sections, record: &record }
        .render())
}

fn first(found: &Document, drawn: &Diagrams) -> Markup {
    let line = |name: &str, value: String, about: String| (name.to_owned(), value, about);
    let before =
        if found.lag_before_s > 0.0 { format!("before: {:.4} s", found.lag_before_s) } else { "before: none".into() };
    let mut numbers = vec![
        line("fan's lag", format!("{:.4} s", found.fan_lag_s), before),
        line("its pole", format!("{:.3} 1/s", found.fan_pole_per_s), String::new()),
        line(
            "critical gain, measured",
            format!("{} per mm", found.critical_gain_per_mm),
            format!("at T_i = {} s", found.integral_time_s),
        ),
    ];
    numbers.extend(found.critical_ti_s.map(|ti_s| {
        let at = format!("predicted at K_p = {}", 0.5 * found.critical_gain_per_mm);
        line("critical T_i", format!("{ti_s:.3} s"), at)
    }));
    html! {
        p.lede { @for line in lines(found) { (capital(&line)) ". " } }
        h2.unseen { "The lag, and the step of the loop at half of the gain" }
        div.first { (values(&numbers)) (step_first(drawn)) }
    }
}

fn next(found: &Document, made: &Made) -> Markup {
    html! {
        ul {
            @if let Some(ti_s) = found.critical_ti_s {
                li {
                    "Check the prediction of the model: at K_p = " (0.5 * found.critical_gain_per_mm)
                    (format!(" the loop should be marginally stable at T_i = {ti_s:.3} s. "))
                    "This measurement was not used to find the lag."
                }
            }
            li { "Compare it with a flight: " (made.then(&format!("airball replay LOG --patch {PATCH}"))) "." }
            li { "Design a controller for it: " (made.then(&format!("airball design pid --patch {PATCH} --patch-out \
                 gains.toml"))) "." }
        }
    }
}

const WORDS: [(&str, &str); 3] = [
    (
        "critical gain",
        "The proportional gain at which the loop is marginally stable: an oscillation neither grows nor decays.",
    ),
    ("third pole", "The lag of the fan. Without it the model is stable at gains at which the rig is not."),
    ("sampled", "The loop as the firmware runs it, once per period; continuous: with a period of 0."),
];
