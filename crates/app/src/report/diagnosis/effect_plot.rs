//! The picture of a found effect: the acceleration over the signal that it depends on, as believed, as mended with its
//! band, and as the record has it in bins.

use crate::report::kit::page::parts::{spoken, three_digits};
use crate::report::kit::palette::{MENDED, NOMINAL};
use crate::report::kit::plot::{Diagram, Line};
use config::words::Words;
use diagnose::{Abscissa, EffectCurve};

/// The labels of the axes.
const fn axes(over: Abscissa) -> (&'static str, &'static str) {
    const FORCE: &str = "acceleration, mm/s²";
    match over {
        Abscissa::Duty => ("duty, %", FORCE),
        Abscissa::Height => ("height, mm", FORCE),
        Abscissa::Speed => ("speed, mm/s", "acceleration beside linear drag, mm/s²"),
        Abscissa::Time => ("time, s", FORCE),
        Abscissa::GainOverTime => ("time, s", "acceleration by 1 % of duty, mm/s²"),
        Abscissa::AfterDuty => ("time since the duty moved, s", "share of the acceleration"),
    }
}

/// The diagram of an effect.
pub fn diagram(curve: &EffectCurve) -> Diagram {
    let (abscissa, ordinate) = axes(curve.over);
    let low = curve.mended.iter().rev().map(|point| (point[0], point[2]));
    let band = curve.mended.iter().map(|point| (point[0], point[3])).chain(low).collect();
    let points = curve.mended.iter().map(|point| (point[0], point[1])).collect();
    let lines = vec![
        Line { label: "mended", colour: MENDED, points },
        Line { label: "as believed", colour: NOMINAL, points: curve.believed.clone() },
    ];
    let dots = curve.bins.iter().map(|bin| (bin.at, bin.value)).collect();
    let intervals = curve.bins.iter().map(|bin| (bin.at, bin.low, bin.high)).collect();
    let base =
        matches!(curve.over, Abscissa::Duty | Abscissa::Speed | Abscissa::Height | Abscissa::Time).then_some(0.0);
    Diagram { abscissa, ordinate, lines, band, dots, intervals, base, ..Diagram::default() }
}

/// What the picture shows, as a caption and as alternative text.
pub fn words(curve: &EffectCurve, rig: &Words) -> String {
    let (abscissa, _) = axes(curve.over);
    let (signal, unit) = abscissa.split_once(", ").unwrap_or((abscissa, ""));
    let unit = rig.unit(unit);
    let what = match curve.over {
        Abscissa::GainOverTime => "acceleration by 1 % of duty",
        Abscissa::AfterDuty => "share of the acceleration that has come",
        Abscissa::Speed => "acceleration beside the linear drag",
        _ => "acceleration of the ball",
    };
    let name = spoken(curve.effect);
    let ends = [curve.mended.first(), curve.mended.last()].map(|end| end.map_or(0.0, |point| point[0]));
    let [from, to] = ends.map(three_digits);
    let points =
        if curve.bins.is_empty() { "Lines" } else { "Points: the record, in bins, with 90 % intervals; lines" };
    format!(
        "The {name}: {what} over {signal}, {from} to {to} {unit}. {points}: the model as believed and as mended, with \
         its 90 % band"
    )
}
