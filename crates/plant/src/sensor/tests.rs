//! What `sensor.rs` promises.

use super::Sensor;
use crate::effects::Effects;
use crate::model::{Model, Noise, tests::thesis};
use crate::motion::{Input, Motion};
use crate::written::{Definition, DefinitionTable};

fn model(sigma_mm: f64, effects: &[(&str, &[f64])]) -> Model {
    let noise = Noise { sensor_mm: sigma_mm, acceleration_psd_mm2_per_s3: 0.0 };
    let mut model = Model { noise, effects: Effects::default(), ..thesis() };
    for (name, values) in effects {
        assert!(model.effects.set(name, values), "{name}");
    }
    model
}

/// Readings of a ball that climbs 100 mm/s, each at its time.
fn climb(model: &Model, times_s: &[f64]) -> Vec<f64> {
    let mut sensor = Sensor::new(5);
    let mut steps = (0..2000).map(|k| 0.001 * f64::from(k)).peekable();
    let at = |t: f64| (Motion::at_rest(100.0 * t, 0.0), Input { time_s: t, ..Input::of(0.0) });
    let mut read = |t: f64| {
        while let Some(step) = steps.next_if(|step| *step <= t) {
            let (motion, input) = at(step);
            sensor.follow(model, &motion, input);
        }
        let (motion, input) = at(t);
        sensor.follow(model, &motion, input);
        sensor.reading(model, t, model.seen_mm(&motion, input))
    };
    times_s.iter().map(|t| read(*t)).collect()
}

fn near(values: &[f64], exact: &[f64]) {
    let close = values.iter().zip(exact).all(|(value, exact)| (value - exact).abs() < 1e-9);
    assert!(close && values.len() == exact.len(), "{values:?}, exact {exact:?}");
}

#[test]
fn a_delayed_reading_is_the_position_of_that_instant_and_of_the_start_before_it() {
    let delayed = model(0.0, &[("sensor_delay", &[0.0347])]);
    near(&climb(&delayed, &[0.01, 0.0347, 0.05, 0.9]), &[0.0, 0.0, 1.53, 86.53]);
}

#[test]
fn a_written_effect_of_the_sensor_adds_to_the_height_of_the_instant_that_is_read() {
    let table: DefinitionTable = serde_json::from_value(serde_json::json!({
        "stage": "sensor", "adds": "k * x + 1000 * k * t",
        "parameters": { "k": { "neutral": 0.0, "low": 0.0, "high": 1.0 } },
    }))
    .unwrap();
    let mut bent = model(0.0, &[("sensor_delay", &[0.03])]);
    bent.effects.written.define(Definition::new("bent", &table).unwrap());
    assert!(bent.effects.set("bent", &[0.5]));
    // Seen 0.03 s ago at 100 mm/s: 1.5 of the height, and 500 mm/s of the time.
    near(&climb(&bent, &[0.01, 0.05, 0.9]), &[0.0, 3.0 + 10.0, 130.5 + 435.0]);
}

#[test]
fn stale_readings_repeat_from_one_refresh_to_the_next() {
    let stale = model(0.0, &[("stale_samples", &[0.04])]);
    let times = [0.0, 0.02, 0.04, 0.06, 0.079, 0.08, 0.13];
    near(&climb(&stale, &times), &[0.0, 0.0, 4.0, 4.0, 4.0, 8.0, 12.0]);
}

#[test]
fn a_stale_reading_was_already_old_when_it_was_taken() {
    let both = model(0.0, &[("stale_samples", &[0.04]), ("sensor_delay", &[0.013])]);
    near(&climb(&both, &[0.05, 0.079, 0.081]), &[2.7, 2.7, 6.7]);
}

#[test]
fn a_repeated_reading_repeats_its_noise() {
    let readings = climb(&model(2.5, &[("stale_samples", &[0.1])]), &[0.1, 0.13, 0.19, 0.2]);
    assert!(readings[0] == readings[1] && readings[1] == readings[2] && readings[2] != readings[3], "{readings:?}");
}

/// `n` readings of a ball at rest at 100 mm.
fn rest(model: &Model, n: u32) -> Vec<f64> {
    let mut sensor = Sensor::new(9);
    (0..n).map(|k| sensor.reading(model, 0.02 * f64::from(k), 100.0)).collect()
}

#[test]
fn extra_noise_adds_in_quadrature() {
    let readings = rest(&model(3.0, &[("sensor_noise", &[4.0])]), 20_000);
    let variance = readings.iter().map(|r| (r - 100.0).powi(2)).sum::<f64>() / 20_000.0;
    // Five standard errors of a variance from 20 000 numbers.
    assert!((variance - 25.0).abs() < 25.0 * 0.05, "{variance} mm²");
}

#[test]
fn wild_readings_come_as_often_as_told_and_on_both_sides() {
    let readings = rest(&model(0.0, &[("sensor_outliers", &[0.1, 80.0])]), 10_000);
    let count = |value: f64| readings.iter().filter(|r| **r == value).count();
    let (low, high) = (count(20.0), count(180.0));
    // 500 each; five standard errors are 109.
    assert!((391..609).contains(&low) && (391..609).contains(&high), "{low} low, {high} high");
    assert_eq!(count(100.0) + low + high, 10_000);
}

#[test]
fn even_wild_readings_are_on_the_grid() {
    let readings = rest(&model(2.0, &[("sensor_outliers", &[0.5, 33.3]), ("sensor_quantisation", &[5.0])]), 1000);
    assert!(readings.iter().all(|r| r % 5.0 == 0.0));
    assert!(readings.iter().any(|r| (r - 133.3).abs() < 10.0));
}

#[test]
fn wild_readings_leave_the_noise_of_the_others_alone() {
    let clean = rest(&model(2.5, &[]), 500);
    let wild = rest(&model(2.5, &[("sensor_outliers", &[0.2, 50.0])]), 500);
    let same = clean.iter().zip(&wild).filter(|(a, b)| a == b).count();
    assert!((350..450).contains(&same), "{same} of 500");
}

#[test]
fn wild_readings_scatter_like_the_others() {
    let readings = rest(&model(2.5, &[("sensor_outliers", &[0.2, 1000.0])]), 20_000);
    let high: Vec<f64> = readings.iter().map(|r| r - 1100.0).filter(|r| r.abs() < 100.0).collect();
    let variance = high.iter().map(|r| r * r).sum::<f64>() / high.iter().map(|_| 1.0).sum::<f64>();
    // About 2000 of them: five standard errors are 16 %.
    assert!((variance / 6.25 - 1.0).abs() < 0.16, "{variance} mm²");
}
