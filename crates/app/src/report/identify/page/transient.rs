//! The page of the transient method: gain and drag from the overshoots of a sweep of proportional gains.

use super::{INTERVALS, PATCH, to_believe, value};
use crate::report::identify::plot::{over_gains, plant, pulses};
use crate::report::identify::transient::{HEADS, row};
use crate::report::identify::{digits, name};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{glossary, values, words};
use crate::report::kit::page::record::{Record, how_to_zoom};
use crate::report::kit::page::{Page, Section};
use crate::report::kit::plot::{Diagram, duty};
use crate::report::measure::plot::flight;
use diagnose::Recording;
use diagnose::identify::Sweep;
use maud::{Markup, html};
use plant::Model;

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The names of the logs.
    pub logs: &'a [String],
    /// The name of the initial config.
    pub config: &'a str,
    /// The belief.
    pub belief: &'a Model,
    /// The rows of the logs.
    pub recording: &'a Recording,
    /// What was found.
    pub found: &'a Sweep,
    /// It as a patch.
    pub patch: &'a str,
}

/// The page of a sweep.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let Report { recording, found, .. } = *report;
    let record = Record { diagrams: vec![flight(recording), duty(recording)] };
    let sections = vec![
        Section::across("gains", "Gain by gain", gains(found)),
        Section::words("simulator", "Believe it", to_believe(report.patch)),
        Section::words("next", "What to do next", next(report.made)),
        Section::across("record", "The whole record", whole(&record)),
        Section::words("words", "Words on this page", glossary(&WORDS)),
    ];
    let mut from = report.logs.to_vec();
    from.extend([format!("{:.1} s", recording.duration_s()), format!("began with: {}", report.config)]);
    let answer = format!(
        "The overshoots of {} gains give K_g = {} and a = {}",
        visible(found),
        digits(found.gain.value),
        digits(found.drag.value)
    );
    Page {
        kind: "identification",
        from,
        made: report.made,
        answer: &answer,
        first: first(report),
        sections,
        record: &record,
    }
    .render()
}

/// Number of gains with a visible overshoot.
fn visible(found: &Sweep) -> usize {
    found.gains.iter().filter(|gain| gain.peak_s.is_some()).count()
}

fn first(report: &Report<'_>) -> Markup {
    let believed = [report.belief.gain_mm_per_s2_per_percent, report.belief.drag_per_s];
    let line = |(estimate, believed): (&diagnose::identify::ParameterEstimate, f64)| {
        let (value, about) = value(estimate);
        (name(estimate.name).to_owned(), value, format!("{about}; believed: {}", digits(believed)))
    };
    let numbers: Vec<_> = [&report.found.gain, &report.found.drag].into_iter().zip(believed).map(line).collect();
    let caption = html! {
        "The mean pulse of the lowest, the middle and the highest gain, relative to the step, and the second-order \
         loop that was fitted to it."
    };
    let alt = "Mean pulses of the lowest, the middle and the highest gain over the time since the step, and \
         second-order loops";
    html! {
        p.lede {
            "The model has two poles, so a fan pole biases K_g and a. Overshoot and peak time at each gain give one \
             estimate; the result is their "
            "mean."
        }
        h2.unseen { "The plant, and the pulses that it was read off" }
        div.first { (values(&numbers)) (figure(&Diagram { direct: true, ..pulses(report.found) }, Size::FIRST, alt, &caption)) }
    }
}

fn gains(found: &Sweep) -> Markup {
    let [of_gain, of_drag] = over_gains(found);
    let rejected = found.rejected;
    html! {
        (words("What each gain gives, with 90 % intervals", &HEADS, &found.gains.iter().map(row).collect::<Vec<_>>()))
        @if visible(found) < found.gains.len() {
            p { (found.gains.len() - visible(found)) " without a visible overshoot count as critically damped, and not in the mean." }
        }
        @if rejected.short + rejected.not_proportional > 0 {
            p { (rejected.short) " steps were rejected as too short, " (rejected.not_proportional) " as not \
                 proportional to the error." }
        }
        div.three {
            (figure(&of_gain, Size::SMALL, "K_g over the gain, with its 90 % intervals",
                &html! { "K_g over the gain. If it falls or rises, the plant has more than two poles." }))
            (figure(&of_drag, Size::SMALL, "a over the gain, with its 90 % intervals", &html! { "a over the gain." }))
            (figure(&plant(found), Size::SMALL, "Magnitude of the plant over frequency, from duty to position",
                &html! { "Frequency response of the plant, from duty to position." }))
        }
    }
}

fn next(made: &Made) -> Markup {
    html! {
        ul {
            li { "Find the fan pole: " (made.then(&format!("airball identify grey-box LOG --patch {PATCH}"))) "." }
            li {
                "Or measure it: " (made.then("airball measure critical-gain")) ", then "
                (made.then(&format!("airball identify third-pole --critical-gain K --patch {PATCH}"))) "."
            }
            li { "Try it on another flight: " (made.then(&format!("airball replay LOG --patch {PATCH}"))) "." }
        }
    }
}

fn whole(record: &Record) -> Markup {
    html! {
        (how_to_zoom())
        (record.still(&["Position over time: setpoint and recorded", "Duty over time"]))
    }
}

const WORDS: [(&str, &str); 4] = [
    ("K_g, a", "The plant K_g/(s(s + a)): force of a percent of duty by the ball's mass, and the ball's drag."),
    ("damping, ω_n", "Those of a loop of second order with this overshoot and peak time."),
    ("critically damped", "Without overshoot: its peak time is not seen, so that it says little."),
    INTERVALS,
];
