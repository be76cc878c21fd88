//! Relay oscillation: one point of the plant's frequency response from a recorded loop with a relay.
//!
//! ```text
//! period      from the upward crossings of the position through its mean, in the last half of the record
//! Y, U        2/T·∫ x·e^(−jωt) dt over whole periods: fundamental of position and duty, the duty held from row to row
//! G(jω)       Y/U          its phase is slightly above −180°
//! ```
//!
//! Both fundamentals are measured, so that chatter of the relay or a limit of the duty causes no error.
//! Source: Åström & Hägglund, *Advanced PID Control*, "Relay feedback".

use crate::record::recording::{Recording, Sample};
use nalgebra::Complex;

/// Smallest number of upward crossings: three whole periods.
const FEWEST_RISES: usize = 4;
/// A crossing counts after the ball was this far below the mean, as a share of its lowest position.
const ARMED: f64 = 0.4;

/// The steady oscillation of a loop with a relay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// Amplitude of the position, mm.
    pub amplitude_mm: f64,
    /// Amplitude of the duty, percent.
    pub duty_amplitude_percent: f64,
    /// Period, seconds.
    pub period_s: f64,
    /// Phase of the plant above −180°, radians.
    pub short_of_half_turn: f64,
}

/// The oscillation in the last half of a record; `None` with fewer than three whole periods.
#[must_use]
pub fn oscillation(recording: &Recording) -> Option<Oscillation> {
    let samples = recording.samples();
    let (first, last) = (samples.first()?.time_s, samples.last()?.time_s);
    let late: Vec<Sample> = samples.iter().filter(|s| s.time_s >= (first + last) / 2.0).copied().collect();
    let readings: Vec<(f64, f64)> = late.iter().filter_map(|s| Some((s.time_s, s.position_mm?))).collect();
    let mean = readings.iter().map(|(_, mm)| mm).sum::<f64>() / readings.len() as f64;
    let rises = rises(&readings, mean);
    if rises.len() < FEWEST_RISES {
        return None;
    }
    let (from, to) = (*rises.first()?, *rises.last()?);
    let period_s = (to - from) / (rises.len() - 1) as f64;
    let omega = std::f64::consts::TAU / period_s;
    let held: Vec<(f64, f64)> = late.iter().map(|s| (s.time_s, s.duty_percent)).collect();
    let fundamental =
        |points: &[(f64, f64)], held: bool| integral(points, held, omega, (from, to)) * (2.0 / (to - from));
    let (position, duty) = (fundamental(&readings, false), fundamental(&held, true));
    let turned = -position / duty;
    let found = Oscillation {
        amplitude_mm: position.re.hypot(position.im),
        duty_amplitude_percent: duty.re.hypot(duty.im),
        period_s,
        short_of_half_turn: turned.im.atan2(turned.re),
    };
    (found.amplitude_mm > 0.0 && found.duty_amplitude_percent > 0.0).then_some(found)
}

/// Times of the upward crossings through `mean`, without repetitions by noise.
fn rises(readings: &[(f64, f64)], mean: f64) -> Vec<f64> {
    let lowest = readings.iter().map(|(_, mm)| mm - mean).fold(0.0, f64::min);
    let mut armed = false;
    let mut found = Vec::new();
    for pair in readings.windows(2) {
        let ((t0, y0), (t1, y1)) = (pair[0], pair[1]);
        armed |= y0 - mean < ARMED * lowest;
        if armed && y0 < mean && y1 >= mean {
            found.push(t0 + (t1 - t0) * (mean - y0) / (y1 - y0));
            armed = false;
        }
    }
    found
}

/// ∫ x·e^(−jωt) dt over an interval; x is held from point to point, or interpolated to the middle of each segment.
fn integral(points: &[(f64, f64)], held: bool, omega: f64, (from, to): (f64, f64)) -> Complex<f64> {
    let turn = |t: f64| Complex::new(libm::cos(omega * t), -libm::sin(omega * t));
    let mut sum = Complex::new(0.0, 0.0);
    for pair in points.windows(2) {
        let ((t0, x0), (t1, x1)) = (pair[0], pair[1]);
        let (low, high) = (t0.max(from), t1.min(to));
        if low >= high {
            continue;
        }
        let value = if held { x0 } else { x0 + (x1 - x0) * ((low + high) / 2.0 - t0) / (t1 - t0) };
        // The exact integral of e^(−jωt) over the segment.
        sum += (turn(high) - turn(low)) * Complex::new(0.0, 1.0 / omega) * value;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::oscillation;
    use crate::tests_support::model;
    use crate::{Recording, Sample};
    use plant::Simulator;

    fn row(time_s: f64, duty_percent: f64, reading: f64) -> Sample {
        Sample {
            time_s,
            setpoint_mm: None,
            control_percent: None,
            duty_percent,
            position_mm: Some(reading),
            fan_rpm: None,
            position2_mm: None,
        }
    }

    /// The test model with a relay about hover, at 50 Hz.
    fn under_relay(hysteresis_mm: f64) -> Recording {
        let mut simulator = Simulator::new(model(), 5);
        let mut control = 1.0;
        let samples = (0..60 * 50).map(|k| {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            let reading = simulator.reading_mm();
            let error = 300.0 - reading;
            if error.abs() > hysteresis_mm {
                control = error.signum();
            }
            let duty_percent = 21.4 + control;
            simulator.drive(duty_percent);
            row(time_s, duty_percent, reading)
        });
        Recording::new(samples.collect()).unwrap()
    }

    #[test]
    fn a_noisy_relay_shows_a_point_of_the_plants_frequency_response() {
        for hysteresis_mm in [0.0, 8.0] {
            let found = oscillation(&under_relay(hysteresis_mm)).unwrap();
            let omega = std::f64::consts::TAU / found.period_s;
            let there = model().linear().continuous().response(omega);
            let magnitude = found.amplitude_mm / found.duty_amplitude_percent;
            assert!((magnitude / there.re.hypot(there.im) - 1.0).abs() < 0.05, "{found:?} beside {there}");
            let short = (-there.im).atan2(-there.re);
            assert!((found.short_of_half_turn - short).abs() < 0.1, "{found:?} beside {short} rad");
        }
    }

    #[test]
    fn a_ball_that_lies_still_does_not_oscillate() {
        let still = |k: u32| row(0.02 * f64::from(k), 21.4, 300.0);
        assert!(oscillation(&Recording::new((0..3000).map(still).collect()).unwrap()).is_none());
    }
}
