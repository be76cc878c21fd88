//! The likelihood of the recorded fan speed: evidence about the path from the duty to the rotor.
//!
//! ```text
//! w: speed in percent of duty, as `plant::Rotor` follows the duty
//! rpm = a + b·w + e,  e_k = ρ·e_(k−1) + n_k      a, b, ρ and the variance of n: most likely on this record
//! ```
//!
//! The rotor shows timing, not force: delay, steps and lags between duty and rotor change its speed. Effects behind the
//! rotor (hysteresis, dead zone, curve, asymmetry, drifts of gain and hover, limits) are not part of w: the speed of a
//! real fan is never quite a straight line of its duty, and the coloured noise e takes that up. A delay or a lag behind
//! the rotor, in the air or in the sensor, leaves the speed unchanged, so a delay or a lag of the duty can be
//! distinguished from one of the reading. The speed depends on the duty alone, so its log-likelihood adds to that of
//! the readings.
//! Source: Cochrane and Orcutt, "Application of least squares regression to relationships containing autocorrelated
//! error terms", Journal of the American Statistical Association 44 (1949).

use crate::filter::innovation::{Innovation, Reading};
use crate::record::recording::{Recording, Sample};
use plant::{Model, Rotor};

/// The rotor's first seconds depend on its speed before the record began.
const WARM_UP_S: f64 = 1.5;
/// With fewer speeds than this no straight line is fitted.
const ENOUGH: usize = 50;
/// Iterations of line and autocorrelation, and the largest autocorrelation ρ.
const ROUNDS: usize = 3;
const MOST_COLOUR: f64 = 0.98;

/// A recorded speed: its row, its value, the model's w, and whether the row before it has a speed too.
struct Speed {
    row: usize,
    rpm: f64,
    duty_percent: f64,
    follows: bool,
}

/// The line from w to the speed, the autocorrelation ρ of its residuals, and the variance of n.
struct Line {
    a: f64,
    b: f64,
    colour: f64,
    variance: f64,
}

/// The innovation of every recorded speed under `model`; none where there are too few.
pub(crate) fn innovations(model: &Model, recording: &Recording) -> Vec<Innovation> {
    if !recording.has_fan_speed() {
        return Vec::new();
    }
    let of_flight = |flight: &std::ops::Range<usize>| speeds(model, &recording.samples()[flight.clone()], flight.start);
    let all: Vec<Speed> = recording.flights().iter().flat_map(of_flight).collect();
    Line::of(&all).map_or_else(Vec::new, |line| line.innovations(&all))
}

/// The recorded speeds of a flight, with w by its duty.
fn speeds(model: &Model, flight: &[Sample], first_row: usize) -> Vec<Speed> {
    let Some(first) = flight.first() else { return Vec::new() };
    let mut rotor = Rotor::new(model, first.duty_percent);
    let (mut all, mut before) = (Vec::new(), None);
    for (row, sample) in flight.iter().enumerate() {
        let time_s = sample.time_s - first.time_s;
        rotor.advance_to(time_s);
        rotor.write(time_s, sample.duty_percent);
        if let Some(rpm) = sample.fan_rpm.filter(|_| time_s >= WARM_UP_S) {
            let follows = before == row.checked_sub(1);
            all.push(Speed { row: first_row + row, rpm, duty_percent: rotor.speed_percent(), follows });
            before = Some(row);
        }
    }
    all
}

impl Line {
    /// The most likely line and autocorrelation. `None`: too few speeds, or a constant duty.
    fn of(all: &[Speed]) -> Option<Self> {
        let pairs: Vec<(&Speed, &Speed)> = all.iter().zip(all.iter().skip(1)).filter(|pair| pair.1.follows).collect();
        if pairs.len() < ENOUGH {
            return None;
        }
        let (n, mut line) = (pairs.len() as f64, Self { a: 0.0, b: 0.0, colour: 0.0, variance: 0.0 });
        for _ in 0..ROUNDS {
            // Least squares of the speed on w after ρ times the value before is subtracted from both.
            let new = |before: f64, now: f64| now - line.colour * before;
            let points = pairs.iter().map(|(p, q)| (new(p.duty_percent, q.duty_percent), new(p.rpm, q.rpm)));
            let (x, y) = points.clone().fold((0.0, 0.0), |(x, y), point| (x + point.0 / n, y + point.1 / n));
            let moments = |(xx, xy): (f64, f64), point: (f64, f64)| {
                (xx + (point.0 - x).powi(2), xy + (point.0 - x) * (point.1 - y))
            };
            let (xx, xy) = points.fold((0.0, 0.0), moments);
            // A spread of less than a millionth of the speed is rounding: the duty is constant.
            line.b = if xx > 1e-12 * n * x * x { xy / xx } else { return None };
            line.a = (y - line.b * x) / (1.0 - line.colour);
            let off = |speed: &Speed| speed.rpm - line.a - line.b * speed.duty_percent;
            let (same, both) =
                pairs.iter().fold((0.0, 0.0), |(same, both), (p, q)| (same + off(p).powi(2), both + off(p) * off(q)));
            let colour = if same > 0.0 { (both / same).clamp(0.0, MOST_COLOUR) } else { 0.0 };
            line.variance = pairs.iter().map(|(p, q)| (off(q) - colour * off(p)).powi(2) / n).sum();
            line.colour = colour;
        }
        // The variance must be above 0 for the division even without noise.
        Some(Self { variance: line.variance.max(1e-9 * line.b.powi(2)), ..line })
    }

    fn innovations(&self, all: &[Speed]) -> Vec<Innovation> {
        let on_line = |speed: &Speed| self.a + self.b * speed.duty_percent;
        let pairs = all.iter().zip(all.iter().skip(1)).filter(|pair| pair.1.follows);
        let one = |(before, now): (&Speed, &Speed)| {
            let expected = on_line(now) + self.colour * (before.rpm - on_line(before));
            let reading = Reading { row: now.row, position_mm: now.rpm, outliers: None, coarse: None };
            Innovation::of(reading, expected, self.variance)
        };
        pairs.map(one).collect()
    }
}

#[cfg(test)]
mod tests;
