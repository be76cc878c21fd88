//! The page of an observer: the gain of each of its states on the innovation.

use crate::report::design::observer::Document;
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{glossary, number, table, three_digits, to_copy, values};
use crate::report::kit::page::record::Record;
use crate::report::kit::page::{Page, Section};
use maud::{Markup, html};

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The name of the config that holds the model.
    pub config: &'a str,
    /// What was designed.
    pub document: &'a Document,
    /// The design as a patch.
    pub patch: &'a str,
}

/// The states of the observer of the patch.
const FLOWN: [&str; 4] = ["position, mm", "velocity, mm/s", "fan, control values", "hover, control values"];

/// The page.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let document = report.document;
    let sections = vec![
        Section::across("gains", "Its gains", gains(document)),
        Section::words("noise", "What it believes of the noise", noise(document)),
        Section::words("law", "Fly it", to_copy("patch", "observer.toml", report.patch)),
        Section::words("next", "What to do next", next(report.made)),
        Section::words("words", "Words on this page", glossary(&WORDS)),
    ];
    let from = vec![format!("model: {}", report.config), format!("sampled every {} s", document.period_s)];
    let record = Record { diagrams: Vec::new() };
    let gain = document.flown.first().copied().unwrap_or_default();
    let answer = format!("The observer's gain on the position is {}", three_digits(gain));
    Page { kind: "design", from, made: report.made, answer: &answer, first: first(document), sections, record: &record }
        .render()
}

fn first(document: &Document) -> Markup {
    let numbers: Vec<(String, String, String)> = flown(document)
        .map(|(state, gain)| (state.to_owned(), three_digits(gain), "for each mm of innovation".to_owned()))
        .collect();
    html! {
        p.lede {
            "A steady-state Kalman filter: at every reading the states move by their gains times the innovation, which is the reading minus what was "
            "expected of it."
        }
        h2.unseen { "The gains that fly" }
        div.first { (values(&numbers)) }
    }
}

/// The states of the observer of the patch, and their gains.
fn flown(document: &Document) -> impl Iterator<Item = (&'static str, f64)> + '_ {
    FLOWN.into_iter().zip(document.flown.iter().copied())
}

fn gains(document: &Document) -> Markup {
    let designed = document.states.iter().zip(document.continuous.iter().zip(&document.sampled));
    let designed: Vec<_> = designed
        .map(|(state, (continuous, sampled))| {
            let cells = vec![html! { (number(Some(*continuous), 5)) }, html! { (number(Some(*sampled), 6)) }];
            (html! { (state) }, cells)
        })
        .collect();
    let flown: Vec<_> =
        flown(document).map(|(state, gain)| (html! { (state) }, vec![html! { (number(Some(gain), 6)) }])).collect();
    html! {
        div.two {
            (table("L of the model's states", &["state", "continuous, 1/s", "sampled"], &designed))
            (table("L of the observer that flies, with hover as a state", &["state", "sampled"], &flown))
        }
    }
}

fn noise(document: &Document) -> Markup {
    let observer = &document.observer;
    html! {
        ul {
            li { "Noise of a reading: " (three_digits(observer.sensor_mm)) " mm (1σ)." }
            li { "Power spectral density of the random acceleration: \
                " (three_digits(observer.acceleration_psd_mm2_per_s3)) " \
                 mm²/s³." }
            li { "Readings with an innovation beyond " (three_digits(observer.gate_sigma)) "σ are outliers." }
            @match observer.disturbance_psd_per_s {
                Some(psd) => li { "Hover drifts by " (three_digits(psd.sqrt())) " in 1 s (1σ)." },
                None => li { "Hover is constant." },
            }
        }
    }
}

fn next(made: &Made) -> Markup {
    html! {
        ul {
            li { "Fly it on the simulated rig: " (made.then("airball simulate --patch observer.toml"))
                " says how many readings came as expected." }
            li { "Measure the noise of your rig, on which it rests: " (made.then("airball measure noise-floor")) "." }
            li { "A controller that uses it: " (made.then("airball design lqr --with-fan --patch-out lqg.toml")) "." }
        }
    }
}

const WORDS: [(&str, &str); 3] = [
    ("observer", "What estimates velocity, fan and hover from readings of the position and the duties that were sent."),
    ("innovation", "A reading minus its forecast from the readings before it."),
    ("L", "The observer's gain: how far each state moves for each millimetre of innovation."),
];
