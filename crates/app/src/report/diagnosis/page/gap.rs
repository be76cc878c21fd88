//! The gap before and after the mend: forecasts over their horizon, the closed loop, and the parameters of the model.

use super::Report;
use super::effects::ends;
use crate::analysis::log_errors::LogErrors;
use crate::report::diagnosis::closed_loop::is_simulated;
use crate::report::diagnosis::ladder;
use crate::report::kit::page::parts::{command, minus, number, table, three_digits};
use diagnose::{ClosedLoop, Compared, Diagnosis, ParameterEntry};
use maud::{Markup, html};

/// Settling times within this share of the recorded one are alike.
const SETTLES_ALIKE: f64 = 0.1;

pub(super) fn body(report: &Report<'_>) -> Markup {
    html! {
        (forecasts(report.found))
        @if !report.logs.errors.is_empty() { (each_log(report)) }
        h3 { "The closed loop" }
        (closed_loop(report.closed_loop))
        h3 { "The parameters of the model" }
        (numbers(report))
    }
}

type Row = (Markup, Vec<Markup>);

fn forecasts(found: &Diagnosis) -> Markup {
    let errors = |errors: [Option<f64>; 3], free: Option<f64>| {
        errors.into_iter().chain([free]).map(|mm| html! { (number(mm, 2)) })
    };
    let row = |head: String, cells: [Option<f64>; 3], free: Option<f64>, more: [String; 3]| -> Row {
        (html! { (head) }, errors(cells, free).chain(more.map(|text| html! { (minus(&text)) })).collect())
    };
    let none = || [const { String::new() }; 3];
    let mut rows = vec![row("the ball stays put".into(), found.gaps[0].stay_put_mm, None, none())];
    for (at, rung) in found.ladder.iter().enumerate() {
        let gain = if at == 0 { String::new() } else { format!("{:.1}", rung.held_out_gain) };
        let more = [ladder::share(rung).unwrap_or_default(), ladder::alone(rung).unwrap_or_default(), gain];
        rows.push(row(ladder::name(rung), rung.error_mm, rung.free_run_10s_mm, more));
    }
    let mended = &found.gaps[2];
    rows.push(row("noise alone".into(), mended.floor_mm, mended.floor_free_run_10s_mm, none()));
    let [a, b, c] = mended.horizons_s.map(|horizon| format!("{horizon} s"));
    let heads =
        ["model", &a, &b, &c, "free run, 10 s", "share of the gap at 1 s", "alone", "log-likelihood gain, nats"];
    table(
        "Forecast error of the position, rms over held-out stretches, mm, and the share of the gap that each step \
         closes",
        &heads,
        &rows,
    )
}

/// The errors of each log.
fn each_log(report: &Report<'_>) -> Markup {
    let cell = |mm: Option<f64>| html! { (number(mm, 2)) };
    let row = |(name, errors): (&String, &LogErrors)| -> Row {
        let LogErrors { believed_mm, mended_mm, floor_mm } = errors;
        (html! { (name) }, [believed_mm, mended_mm, floor_mm].map(|mm| cell(*mm)).to_vec())
    };
    let rows: Vec<Row> = report.logs.names.iter().zip(report.logs.errors).map(row).collect();
    table(
        "Forecast error of each log 1 s ahead, rms over the whole log, mm",
        &["log", "as believed", "mended", "noise alone"],
        &rows,
    )
}

fn closed_loop(found: &ClosedLoop) -> Markup {
    let row = |head: String, of: Compared, flew: Compared, places: usize, absent: &'static str| -> Row {
        let cell = |value: Option<f64>, flew: Option<f64>| match (value, flew) {
            (Some(value), _) => number(Some(value), places),
            (None, Some(_)) => absent.into(),
            _ => "–".into(),
        };
        let cells = [(of.recorded, flew.recorded), (of.nominal, flew.nominal), (of.mended, flew.mended)];
        (html! { (head) }, cells.iter().map(|(value, flew)| html! { (cell(*value, *flew)) }).collect())
    };
    let flew = found.overshoot_percent;
    let mut rows = Vec::new();
    if found.steps > 0 {
        rows.extend([
            row("overshoot with noise, % of the step".into(), found.overshoot_percent, flew, 0, "–"),
            row("first visible peak, s".into(), found.peak_time_s, flew, 2, "none"),
            row(format!("settled to ±{} %, s", found.settling_band_percent), found.settling_s, flew, 2, "none"),
        ]);
    }
    let critical = found.critical_gain_ratio;
    let simulated = Compared { recorded: None, nominal: critical.nominal, mended: critical.mended };
    if critical.nominal.or(critical.mended).is_some() {
        rows.push(row(
            "gain margin in simulated flights, × the loop gain".into(),
            simulated,
            Compared::default(),
            1,
            "–",
        ));
    }
    let headings: &[&str] = if is_simulated(found) {
        &["figure", "recorded", "as believed", "mended"]
    } else {
        rows.iter_mut().for_each(|(_, cells)| cells.truncate(1));
        &["figure", "recorded"]
    };
    html! {
        @if rows.is_empty() {
            p.nothing { "The record has no steps of the setpoint, or its controller is not known." }
        } @else if !is_simulated(found) {
            p { (found.steps) " steps of the record; medians. They are not simulated: neither log nor config holds a \
                 controller and its [loop]." }
            (table("The loop as recorded", headings, &rows))
        } @else {
            p {
                (found.steps) " steps of the record, simulated again with the controller of the record and each model; \
                     medians. A first peak is visible if it exceeds "
                "the setpoint by more than half of the settling band; the overshoot includes noise. The gain margin is \
                 that of flights with steps of an eighth of the pipe, with every effect and the limits of the duty; "
                (command("airball design loop")) " gives that of the linear model."
            }
            (table("The loop as recorded and as simulated", headings, &rows))
            @if let Some(words) = unexplained(found.settling_s) { p { (words) } }
        }
    }
}

/// Whether the mended model settles as the record does.
fn unexplained(settling_s: Compared) -> Option<String> {
    let (recorded, mended) = settling_s.recorded.zip(settling_s.mended)?;
    ((mended - recorded).abs() > SETTLES_ALIKE * recorded).then(|| {
        format!(
            "The record settles in {recorded:.2} s and the mended model in {mended:.2} s: the correction does not \
             explain this difference."
        )
    })
}

fn numbers(report: &Report<'_>) -> Markup {
    let name = |key: &str| match key {
        "gain_mm_per_s2_per_percent" => "gain, mm/s² per % of duty",
        "drag_per_s" => "drag, 1/s",
        _ => "hover, % of duty",
    };
    let row = |(key, entry): (&str, ParameterEntry)| -> Row {
        let ParameterEntry { nominal, interval } = entry;
        let cells = vec![html! { (three_digits(nominal)) }, html! { (three_digits(interval.value)) }, ends(&interval)];
        (html! { (name(key)) }, cells)
    };
    let rows: Vec<Row> = report.found.base_parameters(report.belief).into_iter().map(row).collect();
    table("Base parameters", &["number", "as believed", "mended", "90 % interval"], &rows)
}
