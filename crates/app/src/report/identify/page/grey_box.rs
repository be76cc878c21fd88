//! The page of a grey-box identification: the plant, how well it forecasts the held-out part, and whether the residuals
//! are white noise.

use super::{INTERVALS, PATCH, to_believe, value};
use crate::report::identify::grey_box::{Residuals, words};
use crate::report::identify::plot::{correlations, look, plants, simulations};
use crate::report::identify::{digits, name, said};
use crate::report::kit::about::About;
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::made::Made;
use crate::report::kit::page::parts::{bars, capital, findings, glossary, minus, number, table, values};
use crate::report::kit::page::record::{Record, how_to_zoom};
use crate::report::kit::page::stretch::worst;
use crate::report::kit::page::{Page, Section};
use crate::report::kit::plot::{Diagram, commanded, duty};
use crate::report::kit::words::p_value;
use diagnose::identify::{GreyBox, ParameterEstimate, Poles, Test};
use diagnose::{Gap, Recording};
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
    /// The gap of the belief on the held-out part; `None`: the record was detrended, and the belief has another origin.
    pub believed: Option<&'a Gap>,
    /// The rows that were used.
    pub recording: &'a Recording,
    /// The findings of the check of the record.
    pub findings: &'a [String],
    /// The plant with each number of poles.
    pub found: &'a [GreyBox],
    /// The one that is kept.
    pub best: &'a GreyBox,
    /// It as a patch.
    pub patch: &'a str,
    /// Its slopes about the height and duty that were asked for.
    pub about: Option<About>,
}

/// Estimates that are correlated more strongly than this are hardly known apart.
const STRONG: f64 = 0.9;

/// The page of an identification.
#[must_use]
pub fn page(report: &Report<'_>) -> String {
    let Report { recording, found, best, .. } = *report;
    let record = Record { diagrams: vec![position(recording, found), duty(recording)] };
    let sections = vec![
        Section::across("numbers", "Parameters", numbers(report)),
        Section::across("held-out", "Forecasts of held-out data", held_out(report)),
        Section::across("frequency", "Frequency response of the plant", frequency(report)),
        Section::across("residuals", "Residuals", residuals(report)),
        Section::words("simulator", "Use the model", to_believe(report.patch)),
        Section::words("next", "What to do next", next(report)),
        Section::words("check", "What the record can answer", findings(report.findings)),
        Section::across("record", "The whole record", whole(report, &record)),
        Section::words("words", "Words on this page", glossary(&WORDS)),
    ];
    let mut from = report.logs.to_vec();
    from.extend([format!("{:.1} s", recording.duration_s()), format!("began with: {}", report.config)]);
    let (answer, first) = (answer(best), first(report));
    Page { kind: "identification", from, made: report.made, answer: &answer, first, sections, record: &record }.render()
}

/// Setpoint, record and simulations.
fn position(recording: &Recording, found: &[GreyBox]) -> Diagram {
    let runs = simulations(recording, found);
    Diagram { lines: std::iter::once(commanded(recording)).chain(runs.lines).collect(), ..runs }
}

fn answer(best: &GreyBox) -> String {
    let poles = words::poles(best.poles);
    match Residuals::of(best) {
        Residuals::Noise => format!("A plant of {poles} explains this record but for noise"),
        Residuals::KnowDuty => format!("A plant of {poles} is not all: what it leaves still knows the duty"),
        Residuals::Coloured => format!("A plant of {poles} is not all: air or sensor are not as the model has them"),
    }
}

fn first(report: &Report<'_>) -> Markup {
    let gap = &report.best.held_out.gap;
    html! {
        p.lede {
            (words::verdict(Residuals::of(report.best)).replace('`', ""))
            @if let (Some(error), Some(floor)) = (gap.error_mm[2], gap.floor_mm[2]) {
                (format!(" A second ahead it errs by {error:.1}\u{a0}mm on readings that it was not fitted to, where noise alone makes {floor:.1}\u{a0}mm."))
            }
        }
        h2.unseen { "The plant, and how it does on what was held out" }
        div.first { (numbers_first(report.best)) (picture(report)) }
    }
}

fn numbers_first(best: &GreyBox) -> Markup {
    let line = |estimate: &ParameterEstimate| {
        let (value, about) = value(estimate);
        (name(estimate.name).to_owned(), value, about)
    };
    values(&best.estimates.iter().map(line).collect::<Vec<_>>())
}

fn picture(report: &Report<'_>) -> Markup {
    let Some(stretch) = worst(report.recording, &report.best.held_out.runs) else {
        return html! { p.nothing { "No 10 s of free flight were held out to draw." } };
    };
    let alt = format!(
        "Position from {:.0} to {:.0} s of the record, which were held out: setpoint, recorded, and simulations",
        stretch.0, stretch.1
    );
    let caption = html! {
        "Recorded position, and simulations of the model from the recorded duty, restarted at the recorded position \
         every 10 s. The model was fitted "
        "without this last third of the flight. Shown is the stretch with the largest error; " a href="#record" { "the \
             whole record" } " \
             is below."
    };
    let kept = position(report.recording, std::slice::from_ref(report.best)).within(stretch);
    figure(&Diagram { direct: true, ..kept }, Size::FIRST, &alt, &caption)
}

type Row = (Markup, Vec<Markup>);

fn numbers(report: &Report<'_>) -> Markup {
    let longest = report.found.iter().max_by_key(|one| one.estimates.len());
    let keys = longest.into_iter().flat_map(|one| one.estimates.iter().map(|estimate| estimate.name));
    let row = |key: &'static str| -> Row {
        let own = |one: &GreyBox| one.estimates.iter().find(|e| e.name == key).map_or_else(|| "–".into(), said);
        let believed = html! { (believed(report.belief, key).map_or_else(|| "none".into(), digits)) };
        (
            html! { (name(key)) },
            std::iter::once(believed).chain(report.found.iter().map(|one| html! { (own(one)) })).collect(),
        )
    };
    let rows: Vec<Row> = keys.map(row).collect();
    let heads: Vec<&str> =
        ["number", "as believed"].into_iter().chain(report.found.iter().map(|one| words::poles(one.poles))).collect();
    html! {
        (table("Numbers with 90 % intervals", &heads, &rows))
        (together(report.best))
        @if let Some(about) = &report.about {
            p { (capital(&about.words())) "." }
        }
        @if report.found.len() > 1 {
            p { strong { "Kept: " (words::poles(report.best.poles)) "." } " " (capital(&words::why(report.found, report.best))) "." }
        }
    }
}

/// The config's value of a parameter of the plant.
fn believed(belief: &Model, key: &str) -> Option<f64> {
    match key {
        "gain_mm_per_s2_per_percent" | "gain_mm_per_s2_per_control" => Some(belief.gain_mm_per_s2_per_percent),
        "drag_per_s" => Some(belief.drag_per_s),
        "hover_duty_percent" | "hover_control" => Some(belief.hover_duty_percent),
        _ => belief.effects.fan_lag_s(),
    }
}

fn held_out(report: &Report<'_>) -> Markup {
    let best = &report.best.held_out.gap;
    let mut rows: Vec<(&str, &str, Option<f64>)> = vec![("the ball stays put", "setpoint", best.stay_put_mm[2])];
    rows.extend(report.believed.map(|gap| ("as believed", "force", gap.error_mm[2])));
    rows.extend(report.found.iter().map(|one| (words::poles(one.poles), ink(one.poles), one.held_out.gap.error_mm[2])));
    rows.push(("noise alone", "setpoint", best.floor_mm[2]));
    html! {
        p {
            "Each plant was fitted again without the last third of each flight, and tried there. The fit is the share of the ball's way about its "
            "mean that the forecast explains."
        }
        div.first {
            (bars("Error of the position 1 s ahead, rms, held out", "mm", &rows, best.floor_mm[2]))
            (errors(report))
        }
    }
}

fn ink(poles: Poles) -> &'static str {
    crate::report::kit::palette::name(look(poles).1)
}

fn errors(report: &Report<'_>) -> Markup {
    let gaps: Vec<&Gap> = report.believed.into_iter().chain(report.found.iter().map(|one| &one.held_out.gap)).collect();
    let floor = &report.best.held_out.gap;
    let row = |head: String, of: &dyn Fn(&Gap) -> Option<f64>, floor: Option<f64>| -> Row {
        let cells = gaps.iter().map(|gap| of(gap)).chain([floor]).map(|value| html! { (number(value, 2)) });
        (html! { (head) }, cells.collect())
    };
    let mut rows: Vec<Row> =
        (0..3).map(|h| row(format!("{} s", floor.horizons_s[h]), &|gap| gap.error_mm[h], floor.floor_mm[h])).collect();
    rows.push(row("simulation, 10 s".into(), &|gap| gap.free_run_10s_mm, floor.floor_free_run_10s_mm));
    let fit = |one: &GreyBox| html! { (minus(&words::fit(one, |percent| percent.ahead[2]))) };
    let before = report.believed.iter().map(|_| html! { "–" });
    let noise = std::iter::once(html! { "–" });
    rows.push((html! { "fit 1 s ahead" }, before.chain(report.found.iter().map(fit)).chain(noise).collect()));
    let mut heads = vec!["ahead"];
    heads.extend(report.believed.map(|_| "as believed"));
    heads.extend(report.found.iter().map(|one| words::poles(one.poles)));
    heads.push("noise alone");
    table("Error of the position on what was held out, rms, mm", &heads, &rows)
}

fn residuals(report: &Report<'_>) -> Markup {
    let best = report.best;
    let [whiteness, input] = correlations(&best.residuals);
    let beyond = |values: &[f64]| values.iter().filter(|value| value.abs() > best.residuals.band).count();
    let outside = |values: &[f64]| format!("{} of {} lags are outside the 95 % band", beyond(values), values.len());
    let (own, of_duty) = (outside(&best.residuals.autocorrelation), outside(&best.residuals.with_input));
    html! {
        p {
            "The residuals are the errors of the model's one-step forecasts. Each test covers all lags together and \
             allows for the number of fitted "
            "parameters."
        }
        (tests(report.found))
        div.two {
            (figure(&whiteness, Size::HALF, &format!("Autocorrelation of the residuals: {own}"),
                &html! { "Autocorrelation of the residuals: " (own) "." }))
            (figure(&input, Size::HALF, &format!("Correlation of the residuals with earlier duty: {of_duty}"),
                &html! { "Correlation of the residuals with earlier duty: " (of_duty) "." }))
        }
    }
}

/// Magnitude and phase from duty to position.
fn frequency(report: &Report<'_>) -> Markup {
    // The belief has the frequency response of its linear part, whatever the origin of the record.
    let [magnitude, phase] = plants(report.found, report.best, Some(report.belief));
    let kept = words::poles(report.best.poles);
    html! {
        p { "From duty to position. The band is the 90 % interval of the plant of " (kept) "." }
        div.two {
            (figure(&magnitude, Size::HALF, "Magnitude of the plant over frequency, with its 90 % band", &html! {
            "Magnitude." }))
            (figure(&phase, Size::HALF, "Phase of the plant over frequency, with its 90 % band", &html! { "Phase." }))
        }
    }
}

/// Which estimates the record tells apart, and which only together.
fn together(best: &GreyBox) -> Markup {
    let row = |(a, b, value): &(&'static str, &'static str, f64)| -> Row {
        let strong = if value.abs() > STRONG { "strong: known only together" } else { "known apart" };
        (html! { (name(a)) " and " (name(b)) }, vec![html! { (number(Some(*value), 2)) }, html! { (strong) }])
    };
    let rows: Vec<Row> = best.correlations().iter().map(row).collect();
    html! { @if !rows.is_empty() { (table("Correlation of the estimates", &["parameters", "correlation",
    "judgement"], &rows)) } }
}

fn tests(found: &[GreyBox]) -> Markup {
    let row = |poles: Poles, what: &str, test: Test| -> Row {
        let cells = [
            html! { (what) },
            html! { (number(Some(test.chi_square), 1)) },
            html! { (test.degrees) },
            html! { (p_value(test.p_value)) },
        ];
        (html! { (words::poles(poles)) }, cells.into())
    };
    let rows: Vec<Row> = found
        .iter()
        .flat_map(|one| {
            [
                row(one.poles, "are the residuals white?", one.residuals.whiteness),
                row(one.poles, "are they independent of earlier duty?", one.residuals.input),
            ]
        })
        .collect();
    table("Tests of the residuals", &["plant", "question", "χ²", "degrees", "p-value"], &rows)
}

fn next(report: &Report<'_>) -> Markup {
    let made = report.made;
    let unbounded = report.best.estimates.iter().any(|estimate| estimate.low.is_none() || estimate.high.is_none());
    html! {
        ul {
            @if unbounded {
                li { "The record does not determine every parameter: fly " (made.then("airball run --experiment \
                     experiments/identify.toml")) ", \
                     which takes 100 s." }
            }
            @if Residuals::of(report.best) == Residuals::Noise {
                li { "Validate it on another flight: " (made.then(&format!("airball replay LOG --patch {PATCH}"))) "." }
                li { "Design a controller for it: " (made.then(&format!("airball design pid --patch {PATCH} --patch-out \
                     gains.toml"))) "." }
            } @else {
                li { "Find the effect that the model lacks: " (made.then(&format!("airball diagnose LOG --patch {PATCH} \
                     --html report.html"))) "." }
            }
            @if report.best.poles == Poles::Two {
                li { "A fan lag that this flight does not show may still limit the gain. Measure it: "
                (made.then("airball \
                     measure critical-gain")) "." }
            }
        }
    }
}

fn whole(report: &Report<'_>, record: &Record) -> Markup {
    html! {
        p {
            @if report.believed.is_none() {
                "The stretches without control, each with its linear trend removed. "
            }
            "Each model is simulated from the recorded duty and restarted at the recorded position every 10 s of the \
             held-out part."
        }
        (how_to_zoom())
        (record.still(&["Position over time: setpoint, recorded, and simulations of what was held out", "Duty over time"]))
    }
}

const WORDS: [(&str, &str); 6] = [
    ("poles", "Two belong to the ball (position and speed), the third is the lag of the fan."),
    ("held out", "The last third of each flight, forecast by a model that was fitted to the rest."),
    (
        "noise alone",
        "The error that a correct model would have, from the noise of sensor and air. It is the lowest that can be \
         reached.",
    ),
    (
        "residuals",
        "The errors of the one-step forecasts. If the model is right they are white noise, independent of the duty.",
    ),
    ("nats", "Unit of a log-likelihood difference on the held-out readings: 2 nats are odds of 7 to 1."),
    INTERVALS,
];
