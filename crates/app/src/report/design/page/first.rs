//! The top of a design's page: whether the loop is stable, its margins, and its step.

use super::{STEP, root_locus};
use crate::analysis::loop_margins::Assessment;
use crate::report::design::plot::Diagrams;
use crate::report::design::words::{Document, law};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::parts::values;
use crate::report::kit::plot::Diagram;
use maud::{Markup, html};

/// The form of the loop on the rig: sampled, where the period is known.
pub(super) fn decisive(document: &Document) -> &Assessment {
    document.sampled.as_ref().unwrap_or(&document.continuous)
}

/// The factor by which the gain may grow before the loop loses stability.
pub(super) fn more_gain(of: &Assessment) -> Option<f64> {
    of.gain_margins.iter().map(|margin| margin.factor).filter(|factor| *factor > 1.0).reduce(f64::min)
}

/// The factor to which the gain may fall before the loop loses stability, for conditionally stable loops.
pub(super) fn less_gain(of: &Assessment) -> Option<f64> {
    of.gain_margins.iter().map(|margin| margin.factor).filter(|factor| *factor < 1.0).reduce(f64::max)
}

/// The smallest phase margin, degrees.
pub(super) fn least_phase(of: &Assessment) -> Option<f64> {
    of.phase_margins.iter().map(|margin| margin.phase_deg).reduce(f64::min)
}

/// The answer in a sentence.
pub(super) fn answer(of: &Assessment) -> String {
    if !of.stable {
        return "This loop is unstable: do not fly it".into();
    }
    match (more_gain(of), least_phase(of)) {
        (Some(factor), Some(phase)) => {
            format!("The loop is stable: its gain may rise {factor:.1} times, or its phase may lag {phase:.0}° more")
        }
        (None, Some(phase)) => format!("The loop is stable at any higher gain, and its phase may lag {phase:.0}° more"),
        (Some(factor), None) => format!("The loop is stable: its gain may rise {factor:.1} times"),
        (None, None) => "The loop is stable at any gain".into(),
    }
}

/// The part of the page below the answer.
pub(super) fn first(document: &Document, drawn: &Diagrams) -> Markup {
    let of = decisive(document);
    html! {
        p.lede {
            @if document.sampled.is_some() { "Sampled, as the firmware runs it. " } @else { "In continuous time: the \
                 config has no period. " }
            @for (name, words) in law(document) { @if !name.is_empty() { (spoken(name)) ": " (words) ". " } }
        }
        h2.unseen { "What the loop does" }
        div.first {
            (values(&numbers(of)))
            @if of.stable { (step_first(drawn)) }
            // An unstable loop has no step response: its poles are shown instead; the last locus is that of the sampled
            // loop.
            @else if let Some(locus) = drawn.loci.last() {
                div.round { (root_locus(locus)) }
            }
        }
    }
}

/// The first numbers of a loop. Of an unstable loop, only the limits of its stability.
fn numbers(of: &Assessment) -> Vec<(String, String, String)> {
    let line =
        |name: &str, value: Option<String>, about: &str| value.map(|value| (name.to_owned(), value, about.to_owned()));
    let kp = |about: &str| line("critical K_p", of.critical_kp_per_mm.map(|kp| format!("{kp:.5} per mm")), about);
    let all = if of.stable {
        let step = of.step;
        vec![
            line("overshoot", step.map(|step| format!("{:.1} %", step.overshoot_percent)), "of the step"),
            line("rise, 10 to 90 %", step.map(|step| format!("{:.2} s", step.rise_s)), ""),
            line("settled to ±5 %", step.map(|step| format!("{:.2} s", step.settling_s)), ""),
            line(
                "delay margin",
                delay_s(of).map(|s| format!("{s:.3} s")),
                "additional delay until the loop is marginally stable",
            ),
            kp("where the loop is marginally stable"),
        ]
    } else {
        let none = || line("critical K_p", Some("none".into()), "no proportional gain makes this loop stable");
        vec![kp("where the loop is marginally stable").or_else(none)]
    };
    all.into_iter().flatten().collect()
}

/// The delay margin of a loop, seconds.
pub(super) fn delay_s(of: &Assessment) -> Option<f64> {
    of.phase_margins.iter().map(|margin| margin.delay_s).reduce(f64::min)
}

/// The head of a line of the law as a sentence begins.
pub(super) fn spoken(name: &str) -> &str {
    match name {
        "feedback" => "State feedback",
        "gains" => "PID",
        "weights" => "Weights",
        "lqg" => "LQG",
        "observer" => "Observer",
        other => other,
    }
}

/// The step response beside the first numbers.
pub fn step_first(drawn: &Diagrams) -> Markup {
    let caption = html! {
        "Response to a step of the setpoint, relative to the step, for the linear plant without noise and without \
         limits of the duty."
    };
    figure(&Diagram { direct: true, ..drawn.step.clone() }, Size::FIRST, STEP, &caption)
}
