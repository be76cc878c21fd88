//! The poles on the page of a design: their map, their loci, and their numbers.

use crate::report::design::plot::Diagrams;
use crate::report::design::pole_map::{damping, of_sampled, pole_maps};
use crate::report::design::words::Document;
use crate::report::kit::page::figure::{Size, figure};
use crate::report::kit::page::parts::{capital, minus, number, table};
use crate::report::kit::plot::Diagram;
use crate::report::kit::words::digits;
use maud::{Markup, html};

/// Map, loci and numbers of the poles of a design, and of the config's controller where it is another.
pub(super) fn poles(document: &Document, before: Option<&Document>, drawn: &Diagrams) -> Markup {
    let of = |document: &Document| (document.continuous.clone(), document.sampled.clone());
    let (own, earlier) = (of(document), before.map(of));
    let earlier = earlier.as_ref().map(|(continuous, sampled)| (continuous, sampled.as_ref()));
    html! {
        p {
            "A pair of poles on the line of damping 0.7 settles with 5 % of overshoot, on that of 0.3 with 37 %."
        }
        div.two {
            @for map in &pole_maps((&own.0, own.1.as_ref()), earlier) { (root_locus(map)) }
        }
        (loci(drawn))
        (numbers(document))
    }
}

/// The root loci, side by side.
pub fn loci(drawn: &Diagrams) -> Markup {
    html! {
        p {
            "Where the poles of the closed loop go as its gain goes from a hundredth to a hundred times what it is. In s a pole to the left of "
            "the line dies away; in z one inside the circle does."
        }
        div.two {
            @for locus in &drawn.loci { (root_locus(locus)) }
        }
    }
}

/// One plane of poles.
pub(super) fn root_locus(locus: &Diagram) -> Markup {
    figure(locus, Size::PLANE, &locus.title, &html! { (capital(&locus.title)) "." })
}

fn numbers(document: &Document) -> Markup {
    let row = |form: &'static str, pole: [f64; 2], places: usize, in_s: Option<[f64; 2]>| {
        let figures = in_s.map(damping);
        let shown = |value: Option<f64>| html! { (value.map_or_else(|| "–".into(), |value| minus(&digits(value)))) };
        let mut cells = pole.map(|part| html! { (number(Some(part), places)) }).to_vec();
        cells.extend([shown(figures.map(|(zeta, _)| zeta)), shown(figures.map(|(_, omega)| omega))]);
        (html! { (form) }, cells)
    };
    let mut rows: Vec<_> = document.continuous.poles.iter().map(|pole| row("s, 1/s", *pole, 3, Some(*pole))).collect();
    if let (Some(sampled), Some(period_s)) = (&document.sampled, document.period_s) {
        rows.extend(sampled.poles.iter().map(|pole| row("z", *pole, 5, of_sampled(*pole, period_s))));
    }
    let heads = ["plane", "real part", "imaginary part", "damping", "natural frequency, rad/s"];
    html! {
        details {
            summary { "The poles of the closed loop in numbers" }
            (table("Poles of the closed loop", &heads, &rows))
        }
    }
}
