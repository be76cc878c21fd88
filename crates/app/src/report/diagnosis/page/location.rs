//! Where simulator and rig differ: by place, by frequency, and by the time since the duty.

use super::Report;
use crate::report::diagnosis::plot::{formula, over_signals, over_time};
use crate::report::diagnosis::{effect_plot, place};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::parts::{capital, number, signal, table, three_digits};
use crate::report::kit::palette::{MENDED, NOMINAL, SETPOINT};
use crate::report::kit::plot::{Diagram, Line};
use crate::report::kit::words::p_value;
use config::words::Words;
use diagnose::thresholds::SIGNIFICANT;
use diagnose::{Band, Diagnosis, EffectCurve, MissingForce, Omitted, Place, ResidualPlots, Verdict};
use maud::{Markup, html};
use plant::Stage;

/// Largest number of places in words.
const MOST_PLACES: usize = 4;
/// A correlation with the duty is mentioned if it is this many times the bound that 19 of 20 lags of white noise keep.
const STANDS_OUT: f64 = 1.8;

pub(super) fn body(report: &Report<'_>) -> Markup {
    let (picture, places) = (report.picture, report.found.regions());
    html! {
        div.two {
            (named(&picture.effects, report.words))
            div { (in_words(&places, report)) (nothing_by_time(report)) (residual(report.found)) }
        }
        @if is_drawn(&picture.missing, &places) {
            p {
                "Residual force of the model with refitted parameters. Shaded: significant forecast errors (5 % over \
                 all regions together). "
                "The test uses the forecasts, not this curve: under feedback the curve has a shape even if the model \
                 is right."
            }
        }
        @if let Some(formula) = report.found.formula_in_words() { p { (capital(&formula)) "." } }
        @for (words, diagram) in formula(report.found, &picture.missing) {
            @let (name, _) = diagram.abscissa.split_once(", ").unwrap_or((diagram.abscissa, ""));
            @let alt = format!("Formula over {name}: {words}, with its 90 % band");
            (figure(&diagram, Size::SMALL, &alt, &html! { "Over " (name) ": " (words) "." }))
        }
        @if let Some(left_out) = report.found.left_out_in_words() { p { (left_out) "." } }
        @if picture.missing.is_empty() {
            p.nothing { "There is no free flight in this record, so there is no residual force." }
        } @else {
            div.three {
                @for diagram in over_signals(&picture.missing, &places) {
                    @if !diagram.shaded.is_empty() { (over(&diagram, &places, report.words)) }
                }
            }
            @if shows_force(&picture.missing, &places) {
                (figure(&over_time(&picture.missing, &places), Size::WIDE, "Residual force over time with its standard \
                     deviation", &html! { "Residual force over time." }))
            } @else if !places.is_empty() { p { (FLAT) } }
        }
        (by_time(report, &places))
    }
}

/// What no effect explains: how much it is, and its terms.
fn residual(found: &Diagnosis) -> Markup {
    let terms = found.residual_terms();
    let row = |term: &&Omitted| {
        let (kind, form) = term.kind_and_form();
        let form = if form.is_empty() { "–" } else { form };
        let stage = term.stage.map_or("–", Stage::name);
        let cells = vec![html! { (form) }, html! { (stage) }, html! { (number(Some(term.z), 1)) }];
        (html! { (kind) }, cells)
    };
    let rows: Vec<_> = terms.iter().map(row).collect();
    html! {
        @if let Some(size) = found.residual_size_in_words() { p { (capital(&size)) "." } }
        @if !rows.is_empty() {
            (table("The residual has the form of", &["kind", "goes with", "stage", "z"], &rows))
            p.legend { "z: standard deviations from nothing. " (Diagnosis::RESIDUAL_LETTERS) "." }
        }
    }
}

/// The effects that were found, each over the signal that it depends on.
fn named(effects: &[EffectCurve], rig: &Words) -> Markup {
    html! {
        @for curve in effects {
            @let words = effect_plot::words(curve, rig);
            (figure(&effect_plot::diagram(curve), Size::HALF, &words, &html! { (words) "." }))
        }
    }
}

/// Frequencies and delays, of those only what is significant.
fn by_time(report: &Report<'_>, places: &[Place]) -> Markup {
    let left = &report.picture.left;
    let (by_frequency, by_lag) =
        (significant_band(report).is_some(), left.iter().any(|left| outstanding(left).is_some()));
    html! {
        @if by_frequency || by_lag {
            h3 { "By frequency, and by time after a change of the duty" }
            div.two {
                @if by_frequency { (frequency(report)) }
                @if by_lag { (lag(left, places)) }
            }
        }
    }
}

/// What of the misfit by frequency and by lag is not significant, and so has no chart.
fn nothing_by_time(report: &Report<'_>) -> Markup {
    html! {
        @if significant_band(report).is_none() { p { "No frequency band has significantly more misfit than noise." } }
        @if report.picture.left.iter().all(|left| outstanding(left).is_none()) {
            p { "The misfit is not correlated with earlier duty at any lag." }
        }
    }
}

/// The band with most of the misfit, where that is more than chance.
fn significant_band(report: &Report<'_>) -> Option<Band> {
    let band = report.found.band.filter(|_| report.found.verdict != Verdict::NoGap);
    band.filter(|band| band.p_value < SIGNIFICANT)
}

/// The lag with the largest correlation with the duty, seconds, where that stands out of chance.
fn outstanding(left: &ResidualPlots) -> Option<(f64, f64)> {
    let most = left.after_duty.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).copied();
    most.filter(|(_, r)| r.abs() > STANDS_OUT * left.by_chance)
}

fn over(diagram: &Diagram, places: &[Place], rig: &Words) -> Markup {
    let (name, unit) = diagram.abscissa.split_once(", ").unwrap_or((diagram.abscissa, ""));
    let unit = rig.unit(unit);
    let own = places.iter().filter(|place| signal(place.signal).0 == name);
    let shaded: Vec<String> = own.map(|place| format!("{} {unit}", span(place))).collect();
    let words = format!("shaded: {}", shaded.join("; "));
    let alt = format!("Residual force over {name}: mean and scatter; {words}");
    figure(diagram, Size::SMALL, &alt, &html! { "Over " (name) ": " (words) "." })
}

/// The text for a missing force that is nowhere significant.
const FLAT: &str = "The residual force stays within its standard deviation over time: what is missing is too weak or \
     too fast to show as a slowly varying force.";

/// Whether the missing force shows anything over time: there is a place, and it leaves its standard deviation.
pub(super) fn shows_force(missing: &[MissingForce], places: &[Place]) -> bool {
    let leaves = |moment: &MissingForce| moment.force_mm_per_s2.abs() > moment.sigma_mm_per_s2;
    !places.is_empty() && missing.iter().any(leaves)
}

/// Whether any chart of the missing force is drawn.
fn is_drawn(missing: &[MissingForce], places: &[Place]) -> bool {
    let over_a_signal = over_signals(missing, places).iter().any(|diagram| !diagram.shaded.is_empty());
    !missing.is_empty() && (over_a_signal || shows_force(missing, places))
}

fn span(place: &Place) -> String {
    format!("{} to {}", three_digits(place.from), three_digits(place.to))
}

fn in_words(places: &[Place], report: &Report<'_>) -> Markup {
    let (rig, columns) = (report.words, report.logs.columns);
    html! {
        @if places.is_empty() {
            p { "No region of duty, height, speed, time or time since a change of the duty has significant forecast \
                 errors." }
        } @else {
            ul {
                @for place in places.iter().take(MOST_PLACES) {
                    @let (name, unit) = signal(place.signal);
                    li {
                        strong { (name) " " (span(place)) " " (rig.unit(unit)) }
                        @if let Some(said) = place::in_the_log(place, columns) { " (" code { (said) } ")" }
                        @let percent = 100.0 * place.share;
                        (format!(": {}, {percent:.0} % of the misfit of all regions", p_value(place.p_value)))
                    }
                }
                @if places.len() > MOST_PLACES { li { "and " (places.len() - MOST_PLACES) " more, shaded below" } }
            }
        }
    }
}

fn line(label: &'static str, colour: plotters::style::RGBColor, points: &[(f64, f64)]) -> Line {
    Line { label, colour, points: points.to_vec() }
}

/// Power of the innovations in excess of noise, before and after; the band with most of it is shaded.
fn frequency(report: &Report<'_>) -> Markup {
    let [before, after] = &report.picture.left;
    // The bands are octaves, so that their widths grow with the frequency.
    let excess = |&(hz, power): &(f64, f64)| (power - 1.0) * hz;
    let all: f64 = before.spectrum.iter().map(|band| excess(band).max(0.0)).sum();
    let percent = |left: &ResidualPlots| -> Vec<(f64, f64)> {
        left.spectrum.iter().map(|band| (band.0.log2(), 100.0 * excess(band) / all.max(1e-9))).collect()
    };
    let band = significant_band(report);
    let diagram = Diagram {
        abscissa: "frequency, Hz",
        ordinate: "misfit above noise, % in a third of an octave",
        lines: vec![line("numbers fitted", NOMINAL, &percent(before)), line("mended", MENDED, &percent(after))],
        shaded: band.iter().map(|band| (band.from.log2(), band.to.log2())).collect(),
        base: Some(0.0),
        octaves: true,
        ..Diagram::default()
    };
    let words = band.map_or_else(String::new, |band| {
        format!(
            "{:.0} % of the misfit above noise lies between {:.2} and {:.2} Hz ({}).",
            100.0 * band.share,
            band.from,
            band.to,
            p_value(band.p_value)
        )
    });
    let alt = format!("Power of the misfit over frequency, with fitted numbers and mended. {words}");
    figure(&diagram, Size::HALF, &alt, &html! { (words) })
}

/// Correlation of the innovations with earlier duty, before and after.
fn lag([before, after]: &[ResidualPlots; 2], places: &[Place]) -> Markup {
    let lags = &before.after_duty;
    let band = || lags.iter().map(|(lag_s, _)| *lag_s);
    let diagram = Diagram {
        abscissa: "time since the duty, s",
        ordinate: "correlation of misfit and duty",
        // The band takes the colour of the first line, which is empty.
        lines: vec![
            line("", SETPOINT, &[]),
            line("numbers fitted", NOMINAL, lags),
            line("mended", MENDED, &after.after_duty),
        ],
        shaded: places.iter().filter(|place| place.signal == "lag_s").map(|place| (place.from, place.to)).collect(),
        band: band().map(|s| (s, after.by_chance)).chain(band().rev().map(|s| (s, -after.by_chance))).collect(),
        base: Some(0.0),
        ..Diagram::default()
    };
    let words = match (outstanding(before), outstanding(after)) {
        (None, None) => String::new(),
        (Some((lag_s, r)), None) => format!(
            "With refitted parameters the misfit is correlated with the duty {lag_s:.2} s before (correlation {}); in \
             the mended model it is not.",
            number(Some(r), 2)
        ),
        (_, Some((lag_s, r))) => {
            format!(
                "In the mended model the misfit is still correlated with the duty {lag_s:.2} s before (correlation \
                 {}).",
                number(Some(r), 2)
            )
        }
    };
    let alt = format!("Correlation of the misfit with earlier duty. {words}");
    figure(&diagram, Size::HALF, &alt, &html! { (words) " The band contains 95 % of the correlations of white noise." })
}

#[cfg(test)]
mod tests {
    use super::{is_drawn, shows_force};
    use diagnose::{MissingForce, Place};

    #[test]
    fn a_force_is_drawn_over_time_where_it_leaves_its_sigma_and_over_a_signal_where_a_place_is_significant() {
        let at = |force_mm_per_s2| MissingForce {
            time_s: 0.0,
            duty_percent: 20.0,
            position_mm: 300.0,
            velocity_mm_per_s: 0.0,
            force_mm_per_s2,
            sigma_mm_per_s2: 2.0,
        };
        let place = |signal| [Place { signal, from: 0.0, to: 1.0, share: 1.0, p_value: 0.01 }];
        let (weak, strong) = ([at(1.9), at(-1.9)], [at(1.9), at(-2.1)]);
        assert!(shows_force(&strong, &place("lag_s")) && is_drawn(&strong, &place("lag_s")));
        assert!(!shows_force(&weak, &place("lag_s")) && !is_drawn(&weak, &place("lag_s")));
        assert!(is_drawn(&weak, &place("duty_percent")));
        assert!(!is_drawn(&strong, &[]) && !is_drawn(&[], &place("duty_percent")));
    }
}
