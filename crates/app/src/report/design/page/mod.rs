//! The page of a design: the law, its margins, its step response, its frequency response and its poles.

pub mod critical;
mod first;
pub mod observer;
mod poles;

pub use first::step_first;
pub use poles::loci;

use super::plot::{Diagrams, largest_control_per_mm};
use super::words::{Document, law, rows};
use crate::analysis::loop_margins::{Assessment, Loop, Pid};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{capital, glossary, minus, table, to_copy};
use crate::report::kit::page::record::{Record, how_to_zoom};
use crate::report::kit::page::{Page, PageError, Section};
use crate::report::kit::plot::Diagram;
use crate::report::kit::words::digits;
use first::{answer, decisive, delay_s, first, least_phase, less_gain, more_gain, spoken};
use maud::{Markup, html};
use poles::{poles, root_locus};

/// A delay margin of fewer periods than this causes a warning: one late cycle uses up a period.
const FEW_PERIODS: f64 = 2.0;
/// Margins below which a loop is near its stability limit: a gain factor of 1.5 and 30°.
const LITTLE_GAIN: f64 = 1.5;
const LITTLE_PHASE_DEG: f64 = 30.0;

/// The content of the page.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// How the page is made.
    pub made: &'a Made,
    /// The name of the config that holds the model.
    pub config: &'a str,
    /// What was designed.
    pub document: &'a Document,
    /// Its loop.
    pub of: &'a Loop,
    /// The design as a patch.
    pub patch: &'a str,
    /// The loop of the config's own controller, where the design has another.
    pub before: Option<&'a Document>,
    /// The smaller distance of hover from the limits of the duty, control values; `None`: the config has no limits.
    pub room: Option<f64>,
    /// Length of the pipe, mm.
    pub pipe_length_mm: f64,
    /// Effects of the model that the design neglects.
    pub not_linear: &'a [&'a str],
}

/// The page of a design.
///
/// # Errors
/// [`PageError::Draw`]: the loop cannot be drawn.
pub fn page(report: &Report<'_>) -> Result<String, PageError> {
    let document = report.document;
    let drawn = Diagrams::of(report.of)?;
    let is_flown = decisive(document).stable;
    let record = Record { diagrams: if is_flown { vec![drawn.step.clone()] } else { vec![] } };
    let effort = is_flown.then(|| Section::across("control", "Control value and disturbance", effort(report, &drawn)));
    let mut sections = vec![
        Section::across("bears", "Stability margins", bears(report)),
        Section::across("frequency", "Frequency response of the open loop", frequency(&drawn)),
        Section::across("poles", "The poles", poles(document, report.before, &drawn)),
        Section::words("warnings", "Warnings", warnings(report)),
        Section::words("law", "Controller", law_to_copy(report)),
        Section::words("next", "What to do next", next(decisive(document), report.made)),
    ];
    if let Some(effort) = effort {
        sections.insert(1, effort);
    }
    if is_flown {
        let zoomed = html! { (how_to_zoom()) (record.still(&[STEP])) };
        sections.push(Section::across("record", "The step, to look into", zoomed));
    }
    sections.push(Section::words("words", "Words on this page", glossary(&WORDS)));
    let mut from = vec![format!("model: {}", report.config)];
    from.extend(document.period_s.map(|period_s| format!("sampled every {period_s} s")));
    let (answer, first) = (answer(decisive(document)), first(document, &drawn));
    Ok(Page { kind: "design", from, made: report.made, answer: &answer, first, sections, record: &record }.render())
}

const STEP: &str = "Step of the setpoint: the position as a share of the step, in continuous time and sampled";

/// What a step of the setpoint asks of the fan, and what a disturbance does.
fn effort(report: &Report<'_>, drawn: &Diagrams) -> Markup {
    let [control, disturbed] = &drawn.effort;
    let largest = report.room.zip(largest_control_per_mm(report.of)).map(|(room, per_mm)| room / per_mm);
    html! {
        // No step of the setpoint is longer than the pipe.
        @if let Some(mm) = largest.filter(|mm| *mm < report.pipe_length_mm) {
            p { (format!("A step of the setpoint above {mm:.0} mm takes the duty to its limit; the step response \
                holds for \
                 smaller ones.")) }
        }
        div.two {
            (figure(control, Size::HALF, "Control value over time after a step of the setpoint of 1 mm",
                &html! { "Control value after a step of the setpoint, per millimetre of the step." }))
            (figure(disturbed, Size::HALF, "Position over time after a step of the disturbance",
                &html! { "Position after a constant disturbance sets in, in units of the control value." }))
        }
    }
}

/// The gains and figures of the config's own controller beside those of the design.
fn compared(before: &Document, after: &Document) -> Markup {
    let form = |[continuous, sampled]: [String; 2]| if sampled.is_empty() { continuous } else { sampled };
    let gain = |name: &'static str, of: fn(&Pid) -> f64| {
        let cell = |document: &Document| document.pid.as_ref().map_or_else(|| "–".into(), |pid| digits(of(pid)));
        (html! { (name) }, vec![html! { (cell(before)) }, html! { (cell(after)) }])
    };
    let mut table_rows = vec![
        gain("K_p, per mm", |pid| pid.kp_per_mm),
        gain("T_i, s", |pid| pid.ti_s),
        gain("T_d, s", |pid| pid.td_s),
        gain("N", |pid| pid.derivative_n),
    ];
    for (name, own) in rows(after) {
        if let Some((_, config)) = rows(before).into_iter().find(|(other, _)| *other == name) {
            table_rows.push((html! { (name) }, [config, own].map(|one| html! { (minus(&form(one))) }).into()));
        }
    }
    table("Before and after", &["figure", "config", "design"], &table_rows)
}

fn bears(report: &Report<'_>) -> Markup {
    let document = report.document;
    let row = |(name, [continuous, sampled]): (&'static str, [String; 2])| {
        let mut cells = vec![html! { (minus(&continuous)) }];
        cells.extend(document.period_s.map(|_| html! { (minus(&sampled)) }));
        (html! { (name) }, cells)
    };
    let sampled = document.period_s.map(|period_s| format!("sampled every {period_s} s"));
    let heads: Vec<&str> = ["figure", "continuous"].into_iter().chain(sampled.as_deref()).collect();
    let rows: Vec<_> = rows(document).into_iter().map(row).collect();
    html! {
        @if let Some(before) = report.before { (compared(before, document)) }
        div.two {
            (table("Margins, critical gains and step", &heads, &rows))
            (table("The plant that was designed for", &["number", "value"], &plant(document)))
        }
    }
}

fn plant(document: &Document) -> Vec<(Markup, Vec<Markup>)> {
    let plant = &document.plant;
    let row = |name: &str, value: f64| (html! { (name) }, vec![html! { (digits(value)) }]);
    vec![
        row("gain, mm/s² per unit of the control value", plant.gain_mm_per_s2_per_control),
        row("drag, 1/s", plant.drag_per_s),
        row("fall of the lift with height, 1/s²", plant.gradient_per_s2),
        row("lag of the fan, s", plant.fan_lag_s),
        row("lag of the sensor, s", plant.sensor_lag_s),
        row("all delays, s", plant.delay_s),
    ]
}

/// Magnitude and phase, side by side.
pub fn frequency(drawn: &Diagrams) -> Markup {
    let one = |diagram: &Diagram, what: &str| {
        let words = minus(&diagram.title);
        let alt = format!("{what} over frequency; {words}");
        figure(diagram, Size::HALF, &alt, &html! { (what) ". " (capital(&words)) "." })
    };
    let [magnitude, phase] = &drawn.bode;
    html! {
        div.two { (one(magnitude, "Magnitude")) (one(phase, "Phase")) }
    }
}

fn warnings(report: &Report<'_>) -> Markup {
    let of = decisive(report.document);
    let short = delay_s(of)
        .filter(|_| of.stable)
        .zip(report.of.period_s)
        .filter(|(delay_s, period_s)| *delay_s < FEW_PERIODS * period_s);
    html! {
        ul {
            @if !of.stable { li { strong { "The loop is unstable. " } "Ask for slower poles or a lower gain." } }
            @if of.stable && more_gain(of).is_some_and(|factor| factor < LITTLE_GAIN) {
                li { "A gain margin below " (LITTLE_GAIN) " is small: a rig whose gain is off by a third may be \
                     unstable." }
            }
            @if let Some(factor) = less_gain(of).filter(|_| of.stable) {
                li { (format!("The loop is conditionally stable: it becomes unstable if its gain falls to {factor:.2} \
                     times its value.")) }
            }
            @if of.stable && least_phase(of).is_some_and(|phase| phase < LITTLE_PHASE_DEG) {
                li { "A phase margin below " (LITTLE_PHASE_DEG) "° is small: the ball will oscillate visibly." }
            }
            @if let Some((delay_s, period_s)) = short {
                li { (format!("The delay margin is {delay_s:.3} s and a period is {period_s} s: a few late cycles make \
                     the loop oscillate.")) }
            }
            @for name in report.not_linear {
                li { strong { (name.replace('_', " ")) } " is in the model and not linear: the design uses "
                    @if report.document.about.is_some() { "at most the slope of its force at the operating \
                        point" } @else { "nothing \
                         of it" }
                    "; check it with "
                    (report.made.then("airball simulate")) "." }
            }
            li { "The step response above has no limits of the duty, no quantisation and no noise. A step that \
                 saturates the fan is slower." }
        }
    }
}

fn law_to_copy(report: &Report<'_>) -> Markup {
    html! {
        p { "The controller as a config patch, which replaces these keys of the config:" }
        dl {
            @for (name, words) in law(report.document) {
                // A line without a name belongs to the line before.
                @if !name.is_empty() { dt { (spoken(name)) } }
                dd { (words) }
            }
        }
        (to_copy("patch", "gains.toml", report.patch))
    }
}

fn next(of: &Assessment, made: &Made) -> Markup {
    html! {
        ul {
            @if of.stable {
                li { "Fly it on the simulated rig first, with its noise and its limits: "
                    (made.then("airball simulate --patch gains.toml --experiment experiments/steps.toml")) "." }
                li { "Then on the rig: " (made.then("airball measure steps --patch gains.toml")) " measures overshoot \
                     and settling time." }
                li { "To measure the gain margin of the rig: " (made.then("airball measure critical-gain")) "." }
            } @else {
                li { "Do not fly it. " (made.then("airball design pid")) " places the poles of a stable loop; or lower \
                     the gain." }
            }
        }
    }
}

const WORDS: [(&str, &str); 6] = [
    (
        "gain margin",
        "The factor by which the gain may rise until the loop of the linear model is marginally stable. A diagnosis \
         gives that of simulated flights instead, with every effect and the limits of the duty.",
    ),
    (
        "phase margin",
        "The additional phase lag until the loop is marginally stable, degrees; the delay margin is the same in \
         seconds.",
    ),
    (
        "peak sensitivity M_s",
        "The largest factor by which the loop amplifies a disturbance; 1 / M_s is the distance of the Nyquist curve to \
         −1. Usual: 1.2 to 2.",
    ),
    (
        "sampled",
        "The loop as the firmware runs it: one reading per period, and a duty that is held until the next one.",
    ),
    ("critical", "The value at which the loop is marginally stable, with its other gains unchanged."),
    (
        "pole",
        "A mode of the closed loop: it decays faster the further left the pole is in s, or the nearer to the origin in \
         z.",
    ),
];
