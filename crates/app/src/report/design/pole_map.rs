//! The pole map: the poles of the closed loop, of the design and of the config's controller, between lines of constant
//! damping.
//!
//! ```text
//! pole p = −ζ·ω ± j·ω·√(1 − ζ²)        ω natural frequency, ζ damping ratio, 1/(ζ·ω) time constant
//! z = exp(p·T)                         of a sampled loop
//! ```

use crate::analysis::loop_margins::Assessment;
use crate::report::kit::palette::SETPOINT;
use crate::report::kit::plot::{Diagram, Line};
use std::f64::consts::TAU;

/// Damping ratios of the lines.
const DAMPINGS: [f64; 3] = [0.3, 0.5, 0.7];
/// A pole so many times faster than the slowest fast one is left out of the map: its mode is over before others begin.
const REACH: f64 = 12.0;
/// Room beside the poles.
const MARGIN: f64 = 1.2;
/// The plane of z: its ranges make the unit circle round in the panel.
pub(super) const CIRCLE: [(f64, f64); 2] = [(-1.35, 1.35), (-1.15, 1.15)];
/// Points of a line of constant damping in z.
const POINTS: u32 = 200;

/// The damping ratio and the natural frequency, rad/s, of a pole in s.
#[must_use]
pub fn damping([re, im]: [f64; 2]) -> (f64, f64) {
    let omega = re.hypot(im);
    (if omega > 0.0 { -re / omega } else { 0.0 }, omega)
}

/// The pole in s of one in z; of one at 0, which is over at once, none.
#[must_use]
pub fn of_sampled([re, im]: [f64; 2], period_s: f64) -> Option<[f64; 2]> {
    let size = re.hypot(im);
    (size > 0.0).then(|| [size.ln() / period_s, im.atan2(re) / period_s])
}

/// The map in s, and in z where the period is known; `before` is of the config's controller.
#[must_use]
pub fn pole_maps(
    own: (&Assessment, Option<&Assessment>),
    before: Option<(&Assessment, Option<&Assessment>)>,
) -> Vec<Diagram> {
    let earlier = before.map_or(&[][..], |(continuous, _)| &continuous.poles);
    let mut maps = vec![in_s(&own.0.poles, earlier)];
    if let Some(sampled) = own.1 {
        let earlier = before.and_then(|(_, sampled)| sampled).map_or(&[][..], |sampled| &sampled.poles);
        maps.push(in_z(&sampled.poles, earlier));
    }
    maps
}

fn title(plane: &str, has_before: bool) -> String {
    let before = if has_before { ", × of the config" } else { "" };
    format!("pole map in {plane}: ● closed loop{before}; lines of damping 0.3, 0.5 and 0.7")
}

fn in_s(poles: &[[f64; 2]], before: &[[f64; 2]]) -> Diagram {
    let mut sizes: Vec<f64> = poles.iter().chain(before).map(|pole| damping(*pole).1).collect();
    sizes.sort_by(f64::total_cmp);
    let slow = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0);
    let reach = MARGIN * sizes.iter().copied().filter(|size| *size <= REACH * slow).fold(1e-3, f64::max);
    let rays = DAMPINGS.map(|zeta| [1.0, -1.0].map(|sign| (-zeta * reach, sign * reach * (1.0 - zeta * zeta).sqrt())));
    let mut edge = vec![(0.0, -reach), (0.0, reach)];
    for [up, down] in rays {
        edge.extend([(f64::NAN, f64::NAN), (0.0, 0.0), up, (f64::NAN, f64::NAN), (0.0, 0.0), down]);
    }
    let window = [(-MARGIN * reach, 0.4 * reach), (-reach, reach)];
    map("s", ["real part, 1/s", "imaginary part, 1/s"], window, edge, poles, before)
}

fn in_z(poles: &[[f64; 2]], before: &[[f64; 2]]) -> Diagram {
    let turn = |k: u32| TAU * f64::from(k) / f64::from(2 * POINTS);
    let mut edge: Vec<(f64, f64)> = (0..=2 * POINTS).map(turn).map(|angle| (angle.cos(), angle.sin())).collect();
    for zeta in DAMPINGS {
        let slope = zeta / (1.0 - zeta * zeta).sqrt();
        let spiral = |sign: f64| {
            (0..=POINTS).map(turn).map(move |angle| {
                let size = (-slope * angle).exp();
                (size * angle.cos(), sign * size * angle.sin())
            })
        };
        edge.push((f64::NAN, f64::NAN));
        edge.extend(spiral(1.0));
        edge.push((f64::NAN, f64::NAN));
        edge.extend(spiral(-1.0));
    }
    map("z", ["real part of z", "imaginary part of z"], CIRCLE, edge, poles, before)
}

fn map(
    plane: &str,
    [abscissa, ordinate]: [&'static str; 2],
    window: [(f64, f64); 2],
    edge: Vec<(f64, f64)>,
    poles: &[[f64; 2]],
    before: &[[f64; 2]],
) -> Diagram {
    let is_in = |(x, y): &(f64, f64)| {
        let [(left, right), (low, high)] = window;
        (left..=right).contains(x) && (low..=high).contains(y)
    };
    let seen = |poles: &[[f64; 2]]| poles.iter().map(|[re, im]| (*re, *im)).filter(is_in).collect();
    Diagram {
        title: title(plane, !before.is_empty()),
        abscissa,
        ordinate,
        lines: vec![Line { label: "", colour: SETPOINT, points: edge }],
        dots: seen(poles),
        marks: seen(before),
        window: Some(window),
        ..Diagram::default()
    }
}

#[cfg(test)]
mod tests {
    use super::{damping, in_s, in_z, of_sampled};

    #[test]
    fn damping_and_frequency_of_a_sampled_pole_are_those_of_the_continuous_one() {
        let pole = [-2.0_f64, 3.0];
        let (zeta, omega) = damping(pole);
        assert!((omega - 13.0_f64.sqrt()).abs() < 1e-12 && (zeta - 2.0 / 13.0_f64.sqrt()).abs() < 1e-12);
        let size = (-2.0 * 0.02_f64).exp();
        let back = of_sampled([size * 0.06_f64.cos(), size * 0.06_f64.sin()], 0.02).unwrap();
        assert!((back[0] + 2.0).abs() < 1e-9 && (back[1] - 3.0).abs() < 1e-9, "{back:?}");
        assert_eq!(of_sampled([0.0, 0.0], 0.02), None);
    }

    #[test]
    fn the_map_shows_the_poles_of_both_and_leaves_out_one_that_is_over_at_once() {
        let (own, before) = ([[-1.0, 2.0], [-1.0, -2.0], [-900.0, 0.0]], [[-3.0, 0.0]]);
        let map = in_s(&own, &before);
        assert_eq!((map.dots.as_slice(), map.marks.as_slice()), (&[(-1.0, 2.0), (-1.0, -2.0)][..], &[(-3.0, 0.0)][..]));
        assert!(map.title.contains("of the config") && !in_s(&own, &[]).title.contains("of the config"));
        assert_eq!(in_z(&[[0.9, 0.1]], &[]).dots, [(0.9, 0.1)]);
    }
}
