//! Flights for tests: a square wave of duty about hover, with weak position feedback that keeps the ball off the ends.

use diagnose::{Recording, Sample};
use plant::{Effects, Model, Noise, Simulator};

/// A model with a fan lag, a long pipe and the noise of a real rig.
pub(crate) fn model() -> Model {
    Model {
        gain_mm_per_s2_per_percent: 254.6,
        drag_per_s: 1.889,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
        effects: Effects { fan_lag: Some(plant::effects::FanLag { time_constant_s: 0.2 }), ..Effects::default() },
    }
}

/// Flies `rig` for `seconds` at 50 Hz; `law` gives the duty from time and reading.
pub(crate) fn flown(rig: &Model, seed: u64, seconds: u32, mut law: impl FnMut(f64, f64) -> f64) -> Recording {
    let mut simulator = Simulator::new(rig.clone(), seed);
    let rows = (0..seconds * 50).map(|k| {
        let time_s = 0.02 * f64::from(k);
        simulator.advance_to(time_s);
        let reading = simulator.reading_mm();
        let duty_percent = law(time_s, reading);
        simulator.drive(duty_percent);
        Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
    });
    Recording::new(rows.collect()).unwrap()
}

/// Flies `rig` for `seconds` between two heights.
pub(crate) fn record(rig: &Model, seed: u64, seconds: u32) -> Recording {
    let mut last = 0.0;
    flown(rig, seed, seconds, |time_s, reading| {
        let velocity = (reading - last) / 0.02;
        last = reading;
        let target = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
        21.4 + 0.01 * (target - reading) - 0.0005 * velocity
    })
}

/// Flies `rig` for `seconds` with a duty excited by four sines, so that delays and lags are identifiable.
pub(crate) fn shaken(rig: &Model, seed: u64, seconds: u32) -> Recording {
    flown(rig, seed, seconds, |time_s, reading| {
        let shake: f64 = [3.1_f64, 5.3, 8.9, 13.7].iter().map(|turns| (turns * time_s).sin()).sum();
        rig.hover_duty_percent + 0.01 * (300.0 - reading) + 1.2 * shake
    })
}
