//! The programme of a flight: its setpoints, its controller, and the excitation of its duty.

use crate::chance::Chance;
use serde::Serialize;

/// Gains of the world's controller. It uses the believed hover, and nothing else of the rig.
///
/// ```text
/// u = kp·e + I + D      I: running sum of ki·e·dt      D: change of e through a lag, times kd
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Gains {
    /// Percent per mm.
    pub(crate) kp: f64,
    /// Percent per mm and second.
    pub(crate) ki: f64,
    /// Percent-seconds per mm.
    pub(crate) kd: f64,
    /// Lag of the derivative, s.
    pub(crate) lag_s: f64,
}

/// The programme of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Programme {
    /// `calm`, `brisk`, `wobble`, `steps` or `mixed`.
    pub(crate) name: &'static str,
    /// Length, s.
    pub(crate) seconds: f64,
    /// Time, s, and new setpoint, mm.
    pub(crate) setpoints: Vec<(f64, f64)>,
    /// Controller.
    pub(crate) gains: Gains,
    /// Size of the excitation about the control, percent.
    pub(crate) wobble_percent: f64,
    /// Times at which the excitation changes sign, s.
    pub(crate) wobble_turns: Vec<f64>,
}

impl Programme {
    /// Draws a flight.
    pub(crate) fn draw(c: &mut Chance) -> Self {
        let name = *c.pick(&["calm", "brisk", "brisk", "wobble", "wobble", "steps", "steps", "mixed"]);
        let seconds = *c.pick(&[60.0, 80.0, 100.0]);
        let random = matches!(name, "steps" | "mixed");
        let setpoints = if random { steps(c, seconds) } else { square(c, seconds) };
        let wobble_percent = match name {
            "wobble" => c.between(0.4, 0.9),
            "mixed" => c.between(0.25, 0.5),
            _ => 0.0,
        };
        let gains = gains(c, name);
        Self { name, seconds, setpoints, gains, wobble_percent, wobble_turns: turns(c, seconds) }
    }

    /// The setpoint at this time, mm.
    pub(crate) fn setpoint(&self, t: f64) -> f64 {
        let begun = self.setpoints.iter().take_while(|(from, _)| *from <= t).last();
        begun.or(self.setpoints.first()).map_or(0.0, |(_, setpoint)| *setpoint)
    }

    /// The excitation at this time, percent.
    pub(crate) fn wobble(&self, t: f64) -> f64 {
        let turned = self.wobble_turns.partition_point(|turn| *turn <= t);
        if t < 0.0 || turned % 2 == 1 { -self.wobble_percent } else { self.wobble_percent }
    }

    /// Lowest and highest setpoint, mm.
    pub(crate) fn reach(&self) -> (f64, f64) {
        let levels = || self.setpoints.iter().map(|(_, level)| *level);
        (levels().fold(f64::INFINITY, f64::min), levels().fold(f64::NEG_INFINITY, f64::max))
    }
}

/// A square wave between two heights.
fn square(c: &mut Chance, seconds: f64) -> Vec<(f64, f64)> {
    let low = tenth(c.between(170.0, 260.0));
    let high = low + c.pick(&[80.0, 100.0, 150.0, 200.0]);
    let half = c.between(4.0, 9.0);
    (0..)
        .map(|i| (half * f64::from(i), if i % 2 == 0 { low } else { high }))
        .take_while(|(t, _)| *t < seconds)
        .collect()
}

/// Random heights for random times.
fn steps(c: &mut Chance, seconds: f64) -> Vec<(f64, f64)> {
    let (low, span) = (c.between(170.0, 260.0), *c.pick(&[80.0, 100.0, 150.0, 200.0]));
    let (mut t, mut list) = (0.0, Vec::new());
    while t < seconds {
        list.push((t, tenth(low + c.between(0.0, span))));
        t += c.between(3.0, 8.0);
    }
    list
}

/// Times of sign changes: usually 0.6 s after one another, sometimes 0.3 s.
fn turns(c: &mut Chance, seconds: f64) -> Vec<f64> {
    let (mut t, mut list) = (0.0, Vec::new());
    while t < seconds {
        t += if c.happens(0.2) { 0.3 } else { 0.6 };
        list.push(t);
    }
    list
}

fn gains(c: &mut Chance, name: &str) -> Gains {
    let wide = c.between(0.9, 1.1);
    match name {
        "calm" => {
            let kp = c.between(0.007, 0.0135);
            Gains { kp, ki: kp / 15.0, kd: 0.0, lag_s: 0.01 }
        }
        "brisk" => Gains { kp: 0.02 * wide, ki: 0.0025, kd: 0.0064 * wide, lag_s: 0.012 },
        _ => Gains { kp: 0.011 * wide, ki: 0.0009, kd: 0.003 * wide, lag_s: 0.008 },
    }
}

fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}
