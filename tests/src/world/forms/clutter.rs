//! Clutter: the small pieces that every real rig has and no model holds. Each moves a forecast of 1 s by 1 to 3 mm,
//! where the noise alone moves it by some 10 mm: less than 5 % of the mean square of a visible effect.

use super::outside::delayed;
use super::{Force, Link, lag};
use crate::catalogue::Effect;
use crate::chance::Chance;
use std::f64::consts::TAU;

/// Every piece, with the effect of the catalogue that a diagnosis would rightly call it by, if there is one.
pub(crate) const PIECES: [(&str, Option<&str>); 10] = [
    ("slight_curvature", Some("thrust_curve")),
    ("slight_gradient", Some("height_dependent_flow")),
    ("slight_drift", Some("hover_drift")),
    ("creep", None),
    ("hum", None),
    ("slight_friction", Some("wall_friction")),
    ("sensor_bend", None),
    ("write_jitter", None),
    ("uneven_noise", Some("sensor_noise")),
    ("heavy_tails", Some("sensor_outliers")),
];

/// Five to eight different pieces.
pub(crate) fn draw(c: &mut Chance, seconds: f64) -> Vec<Effect> {
    let (mut left, count) = (PIECES.to_vec(), 5 + (c.unit() * 4.0) as usize);
    let mut one = || left.remove((c.unit() * left.len() as f64) as usize).0;
    let names: Vec<&'static str> = (0..count).map(|_| one()).collect();
    names.into_iter().map(|name| piece(name, c, seconds)).collect()
}

fn piece(name: &'static str, c: &mut Chance, seconds: f64) -> Effect {
    let parameters: &[(&'static str, f64)] = &match name {
        "slight_curvature" => vec![("curvature_per_percent", c.sign() * c.between(0.002, 0.006))],
        "slight_gradient" => vec![("size_mm_per_s2", c.between(2.0, 6.0)), ("wave_mm", c.between(150.0, 500.0))],
        "slight_drift" => vec![("percent", c.sign() * c.between(0.01, 0.03)), ("length_s", seconds)],
        "creep" => vec![("share", c.between(0.01, 0.04)), ("time_s", c.between(5.0, 30.0))],
        "hum" => vec![("size_mm_per_s2", c.between(3.0, 10.0)), ("frequency_hz", c.between(0.2, 4.0))],
        "slight_friction" => vec![("acceleration_mm_per_s2", c.between(1.0, 3.0))],
        "sensor_bend" => vec![("share_per_100_mm", c.sign() * c.between(0.003, 0.012))],
        "write_jitter" => vec![("up_to_s", c.between(0.002, 0.01))],
        "uneven_noise" => vec![("sigma_mm", c.between(0.4, 1.2))],
        "heavy_tails" => vec![("probability", c.between(0.001, 0.004)), ("size_mm", c.between(6.0, 15.0))],
        other => unreachable!("{other} is no piece"),
    };
    Effect::new(name, parameters)
}

/// A link of the actuator, from the duty about hover in percent.
pub(crate) fn link(e: &Effect, mut chance: Chance) -> Option<Link> {
    Some(match e.name {
        "slight_curvature" => {
            let curvature = e.get("curvature_per_percent");
            Box::new(move |u, _| u + curvature * u * u)
        }
        "slight_drift" => {
            // Half a wave over the record, at a phase of its own: a drift that bends.
            let (size, length, phase) = (e.get("percent"), e.get("length_s"), TAU * chance.unit());
            Box::new(move |u, t| u + size * (0.5 * TAU * t / length + phase).sin())
        }
        "creep" => {
            let (share, mut slow) = (e.get("share"), lag(e.get("time_s")));
            Box::new(move |u, _| u + share * slow(u))
        }
        "write_jitter" => {
            let longest = e.get("up_to_s");
            delayed(move || longest * chance.unit())
        }
        _ => return None,
    })
}

/// A force on the ball.
pub(crate) fn force(e: &Effect, mut chance: Chance) -> Option<Force> {
    let phase = TAU * chance.unit();
    Some(match e.name {
        "slight_gradient" => {
            let (size, wave) = (e.get("size_mm_per_s2"), e.get("wave_mm"));
            Box::new(move |x, _, _| size * (TAU * x / wave + phase).sin())
        }
        "hum" => {
            let (size, pulse) = (e.get("size_mm_per_s2"), TAU * e.get("frequency_hz"));
            Box::new(move |_, _, t| size * (pulse * t + phase).sin())
        }
        "slight_friction" => super::forces::bristle(e.get("acceleration_mm_per_s2"), |_| 1.0),
        _ => return None,
    })
}

/// The bend of the sensor's scale, along the signal.
pub(crate) fn bend(e: &Effect) -> Link {
    let share = e.get("share_per_100_mm") / 100.0;
    Box::new(move |x, _| x + share * (x - 300.0) * (x - 300.0).abs() / 2.0)
}

/// Noise of a reading: more of it high up, or heavier tails.
pub(crate) fn noise(e: &Effect, mut chance: Chance) -> Link {
    if e.name == "uneven_noise" {
        let (sigma, scale) = (e.get("sigma_mm"), 300.0);
        return Box::new(move |x, _| x + sigma * (x / scale).max(0.0) * chance.hump());
    }
    let (probability, size) = (e.get("probability"), e.get("size_mm"));
    Box::new(move |x, _| if chance.happens(probability) { x + size * chance.hump() } else { x })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::Source;
    use crate::forms::STEP_S;

    #[test]
    fn every_piece_changes_a_signal_or_a_force_a_little() {
        for (name, _) in PIECES {
            let source = Source { seed: "clutter".into(), case: 3 };
            let effect = piece(name, &mut source.stream("size"), 80.0);
            let chance = || source.stream(name);
            let steps = || (0..80_000).map(|k| f64::from(k) * STEP_S);
            let worst = if let Some(mut force) = force(&effect, chance()) {
                steps().map(|t| force(300.0 + 80.0 * t.sin(), 80.0 * t.cos(), t).abs()).fold(0.0, f64::max)
            } else if let Some(mut link) = link(&effect, chance()) {
                250.0 * steps().map(|t| (link(t.sin(), t) - t.sin()).abs()).fold(0.0, f64::max)
            } else {
                let mut link = if name == "sensor_bend" { bend(&effect) } else { noise(&effect, chance()) };
                steps().map(|t| (link(300.0 + 80.0 * t.sin(), t) - 300.0 - 80.0 * t.sin()).abs()).fold(0.0, f64::max)
            };
            assert!(worst > 0.1 && worst < 60.0, "{name}: {worst}");
        }
    }

    #[test]
    fn a_rig_has_five_to_eight_pieces_and_none_twice() {
        for case in 0..50 {
            let mut names: Vec<&str> = draw(&mut Source { seed: "pieces".into(), case }.stream("design"), 80.0)
                .iter()
                .map(|e| e.name)
                .collect();
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert!((5..=8).contains(&count) && names.len() == count, "{names:?}");
        }
    }
}
