//! Where simulator and rig differ: by place, by frequency, and by the time since the duty.

use super::Report;
use crate::report::diagnosis::plot::{formula, over_signals, over_time};
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::parts::{capital, number, signal, three_digits};
use crate::report::kit::palette::{MENDED, NOMINAL, SETPOINT};
use crate::report::kit::plot::{Diagram, Line};
use diagnose::thresholds::SIGNIFICANT;
use diagnose::{MissingForce, Place, ResidualPlots, Verdict};
use maud::{Markup, html};

/// A correlation with the duty is mentioned if it is this many times the bound that 19 of 20 lags of white noise keep.
const STANDS_OUT: f64 = 1.8;

pub(super) fn body(report: &Report<'_>) -> Markup {
    let (picture, places) = (report.picture, report.found.regions());
    html! {
        p {
            "The force that the belief lacks once its numbers are fitted. Shaded are the places where its forecasts are off by more than "
            "chance, at 1 in 20 over all places together; this is judged by the forecasts and never by the force itself, which takes a shape "
            "in closed loop even where nothing is wrong."
        }
        (in_words(&places))
        @if let Some(shape) = report.found.residual_in_words() { p { (shape) "." } }
        @if let Some(formula) = report.found.formula_in_words() { p { (capital(&formula)) "." } }
        @for (words, diagram) in formula(report.found, &picture.missing) {
            @let (name, _) = diagram.abscissa.split_once(", ").unwrap_or((diagram.abscissa, ""));
            @let alt = format!("Formula over {name}: {words}, with its 90 % band");
            (figure(&diagram, Size::SMALL, &alt, &html! { "Over " (name) ": " (words) "." }))
        }
        @if let Some(left_out) = report.found.left_out_in_words() { p { (left_out) "." } }
        @if picture.missing.is_empty() {
            p.nothing { "The ball never flew free: there is no force to draw." }
        } @else {
            div.three {
                @for diagram in over_signals(&picture.missing, &places) { (over(&diagram, &places)) }
            }
            (figure(&over_time(&picture.missing, &places), Size::WIDE, "Missing force over time with its standard deviation",
                &html! { "Missing force over the time of the record." (flat(&picture.missing)) }))
        }
        h3 { "At which frequencies, and how long after the duty" }
        div.two { (frequency(report)) (lag(&picture.left, &places)) }
    }
}

fn over(diagram: &Diagram, places: &[Place]) -> Markup {
    let (name, unit) = diagram.abscissa.split_once(", ").unwrap_or((diagram.abscissa, ""));
    let own = places.iter().filter(|place| signal(place.signal).0 == name);
    let shaded: Vec<String> = own.map(|place| format!("{} {unit}", span(place))).collect();
    let words = if shaded.is_empty() { "no place is shaded".into() } else { format!("shaded: {}", shaded.join("; ")) };
    let alt = format!("Missing force over {name}: mean and scatter; {words}");
    figure(diagram, Size::SMALL, &alt, &html! { "Over " (name) ": " (words) "." })
}

/// The text for a missing force that is nowhere significant.
fn flat(missing: &[MissingForce]) -> &'static str {
    if missing.iter().any(|moment| moment.force_mm_per_s2.abs() > moment.sigma_mm_per_s2) {
        return "";
    }
    " It never leaves its own uncertainty: whatever is missing is too weak or too quick to be seen as a force that wanders."
}

fn span(place: &Place) -> String {
    format!("{} to {}", three_digits(place.from), three_digits(place.to))
}

fn in_words(places: &[Place]) -> Markup {
    html! {
        @if places.is_empty() {
            p { "By duty, height, speed, time and the time since the duty moved no place is wrong by more than chance." }
        } @else {
            ul {
                @for place in places {
                    @let (name, unit) = signal(place.signal);
                    li {
                        strong { (name) " " (span(place)) " " (unit) }
                        (format!(": p = {:.3}, {:.0} % of the misfit of all places", place.p_value, 100.0 * place.share))
                    }
                }
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
    let band = report.found.band.filter(|_| report.found.verdict != Verdict::NoGap);
    let by_more_than_chance = band.filter(|band| band.p_value < SIGNIFICANT);
    let diagram = Diagram {
        abscissa: "frequency, Hz",
        ordinate: "misfit above noise, % in a third of an octave",
        lines: vec![line("numbers fitted", NOMINAL, &percent(before)), line("mended", MENDED, &percent(after))],
        shaded: by_more_than_chance.iter().map(|band| (band.from.log2(), band.to.log2())).collect(),
        base: Some(0.0),
        octaves: true,
        ..Diagram::default()
    };
    let words = band.map_or_else(
        || "No band of frequencies stands out.".into(),
        |band| {
            let chance = if by_more_than_chance.is_some() { "" } else { ", which chance alone may make" };
            format!(
                "Most of the misfit, {:.0} % of what is above noise, lies between {:.2} and {:.2} Hz (p = {:.3}){chance}.",
                100.0 * band.share,
                band.from,
                band.to,
                band.p_value
            )
        },
    );
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
    let most = |left: &ResidualPlots| {
        let most = left.after_duty.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).copied();
        most.filter(|(_, r)| r.abs() > STANDS_OUT * left.by_chance)
    };
    let words = match (most(before), most(after)) {
        (None, None) => "The misfit follows the duty at no lag by more than chance.".to_owned(),
        (Some((lag_s, r)), None) => format!(
            "With fitted numbers the misfit follows the duty, most after {lag_s:.2} s (correlation {}); mended, by no more than chance.",
            number(Some(r), 2)
        ),
        (_, Some((lag_s, r))) => {
            format!(
                "Even mended the misfit follows the duty, most after {lag_s:.2} s (correlation {}).",
                number(Some(r), 2)
            )
        }
    };
    let alt = format!("Correlation of the misfit with the duty before it. {words}");
    figure(&diagram, Size::HALF, &alt, &html! { (words) " The band holds 19 of 20 correlations that chance makes." })
}

#[cfg(test)]
mod tests {
    use super::flat;
    use diagnose::MissingForce;

    #[test]
    fn a_force_that_stays_within_its_sigma_is_called_flat_and_one_that_leaves_it_once_is_not() {
        let at = |force_mm_per_s2| MissingForce {
            time_s: 0.0,
            duty_percent: 20.0,
            position_mm: 300.0,
            velocity_mm_per_s: 0.0,
            force_mm_per_s2,
            sigma_mm_per_s2: 2.0,
        };
        assert!(flat(&[at(1.9), at(-1.9)]).contains("too weak or too quick"));
        assert_eq!(flat(&[at(1.9), at(-2.1)]), "");
    }
}
