//! The root locus of a loop: the poles of the closed loop as functions of its gain.
//!
//! Roots come in no order. At every gain, a branch is continued with the pole that is nearest to its last one.

use super::Form;
use crate::report::design::pole_map::CIRCLE;
use crate::report::kit::palette::SETPOINT;
use crate::report::kit::plot::{Diagram, Line};
use control::design::margins::phase_margins;
use control::design::{Complex, Plane, Transfer};
use std::f64::consts::TAU;

/// Gains of the root locus: from a hundredth of the loop's to a hundred times.
const LOCUS_DECADES: f64 = 2.0;
const LOCUS_POINTS: u32 = 600;
/// Points of a branch nearer than this share of the plane's width are merged.
const ON_TOP: f64 = 0.002;
const JUMP: f64 = 0.1;
/// The plane of s shows so many crossover frequencies to the left: the poles that a step response shows.
const REACH: f64 = 5.0;

/// Root locus in the plane of s or z, over gains from a hundredth of the loop's to a hundred times: crosses at the open
/// loop's poles, rings at its zeros, dots at the closed loop's poles.
pub(super) fn locus(form: &Form) -> Diagram {
    let open = form.open();
    let (window, boundary, title, axes) = match form.plant.plane {
        Plane::Continuous => {
            let crossover = phase_margins(&open).first().map_or(1.0, |margin| margin.omega);
            let reach = REACH * crossover;
            let edge = vec![(0.0, -0.7 * reach), (0.0, 0.7 * reach)];
            let title = "root locus in s: × open loop, ○ zeros, ● closed loop";
            (
                [(-1.2 * reach, 0.4 * reach), (-0.7 * reach, 0.7 * reach)],
                edge,
                title,
                ["real part, 1/s", "imaginary part, 1/s"],
            )
        }
        Plane::Sampled(_) => {
            let circle = (0..=360).map(|k| (TAU * f64::from(k) / 360.0).sin_cos()).map(|(y, x)| (x, y)).collect();
            let title = "root locus in z: × open loop, ○ zeros, ● closed loop";
            (CIRCLE, circle, title, ["real part of z", "imaginary part of z"])
        }
    };
    let unit = if form.plant.plane == Plane::Continuous { 0.0 } else { 1.0 };
    let place = |root: &Complex<f64>| (root.re + unit, root.im);
    let seen = |roots: &[Complex<f64>]| roots.iter().map(place).filter(|at| is_in(window, *at)).collect();
    let locus = branches(&open, place).iter().flat_map(|branch| traced(branch, window)).collect();
    Diagram {
        title: title.into(),
        abscissa: axes[0],
        ordinate: axes[1],
        lines: vec![
            Line { label: "", colour: SETPOINT, points: boundary },
            Line { label: "", colour: form.colour, points: locus },
        ],
        marks: seen(&open.denominator.roots()),
        rings: seen(&open.numerator.roots()),
        dots: seen(&open.closed_poles(1.0)),
        window: Some(window),
        ..Diagram::default()
    }
}

/// The poles of the closed loop over the gain: each branch continues with the nearest pole of the next gain.
fn branches(open: &Transfer, place: impl Fn(&Complex<f64>) -> (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let gain = |k: u32| 10.0_f64.powf(LOCUS_DECADES * (2.0 * f64::from(k) / f64::from(LOCUS_POINTS) - 1.0));
    let mut all: Vec<Vec<(f64, f64)>> = Vec::new();
    for k in 0..=LOCUS_POINTS {
        let mut left: Vec<(f64, f64)> = open.closed_poles(gain(k)).iter().map(&place).collect();
        for branch in &mut all {
            let Some(last) = branch.last().copied() else { continue };
            let nearer = |a: &usize, b: &usize| distance(left[*a], last).total_cmp(&distance(left[*b], last));
            if let Some(at) = (0..left.len()).min_by(nearer) {
                branch.push(left.swap_remove(at));
            }
        }
        all.extend(left.into_iter().map(|pole| vec![pole]));
    }
    all
}

/// A branch as a line: without points outside the window, and without points that coincide.
fn traced(branch: &[(f64, f64)], window: [(f64, f64); 2]) -> Vec<(f64, f64)> {
    let width = window[0].1 - window[0].0;
    let gap = (f64::NAN, f64::NAN);
    let mut line = Vec::new();
    let mut last = gap;
    for at in branch.iter().copied().filter(|at| is_in(window, *at)) {
        let way = distance(at, last) / width;
        if way > JUMP {
            line.push(gap);
        }
        if way.is_nan() || way > ON_TOP {
            line.push(at);
            last = at;
        }
    }
    line.push(gap);
    line
}

fn distance(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

fn is_in([(left, right), (low, high)]: [(f64, f64); 2], (x, y): (f64, f64)) -> bool {
    (left..=right).contains(&x) && (low..=high).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::{branches, distance};
    use crate::report::design::plot::forms;
    use crate::report::design::plot::tests::thesis;
    use control::design::polynomial::magnitude;

    #[test]
    fn the_branches_of_a_locus_hold_every_pole_and_never_jump() {
        for form in forms(&thesis(0.018)).unwrap() {
            let open = form.open();
            let all = branches(&open, |root| (root.re, root.im));
            let poles = open.closed_poles(1.0);
            assert_eq!(all.len(), poles.len());
            for pole in poles {
                let near =
                    all.iter().flatten().any(|at| distance(*at, (pole.re, pole.im)) < 0.02 * magnitude(pole).max(1e-3));
                assert!(near, "{pole}");
            }
            for branch in all {
                let jump = |pair: &[(f64, f64)]| distance(pair[0], pair[1]) / distance(pair[0], (0.0, 0.0)).max(1e-3);
                assert!(branch.windows(2).all(|pair| jump(pair) < 0.2), "{}", form.label);
            }
        }
    }
}
