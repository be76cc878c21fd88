use super::{MissingForce, missing_force, with_force};
use crate::filter::track::smoothed_states;
use crate::tests_support::model;
use crate::{Recording, Sample};
use plant::{Effects, Model, Noise, Normal, Simulator};

const PERIOD_S: f64 = 0.02;

/// A rig whose duty acts without a lag, so that a force equals a duty that is not in the log.
fn rig() -> Model {
    Model { effects: Effects::default(), ..model() }
}

/// Flies `rig` for 60 s while `force`, mm/s² as a function of time in s, acts on the ball.
fn record(rig: &Model, seed: u64, mut force: impl FnMut(f64) -> f64) -> Recording {
    let mut simulator = Simulator::new(rig.clone(), seed);
    let mut last = 0.0;
    let rows = (0..3000).map(|k| {
        let time_s = PERIOD_S * f64::from(k);
        simulator.advance_to(time_s);
        let reading = simulator.reading_mm();
        let velocity = (reading - last) / PERIOD_S;
        last = reading;
        let target = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
        let duty_percent = rig.hover_duty_percent + 0.01 * (target - reading) - 0.001 * velocity;
        simulator.drive(duty_percent + force(time_s) / rig.gain_mm_per_s2_per_percent);
        Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
    });
    Recording::new(rows.collect()).unwrap()
}

/// Share of the estimates after the first 5 s whose error is within `sigmas` standard deviations.
fn covered(found: &[MissingForce], sigmas: f64, force: impl Fn(f64) -> f64) -> f64 {
    let late: Vec<_> = found.iter().filter(|moment| moment.time_s > 5.0).collect();
    let off = |m: &MissingForce| (m.force_mm_per_s2 - force(m.time_s)).abs() / m.sigma_mm_per_s2;
    late.iter().filter(|moment| off(moment) < sigmas).count() as f64 / late.len() as f64
}

#[test]
fn a_force_that_wanders_lies_within_one_sigma_as_often_as_it_should() {
    let (mut one, mut two) = (0.0, 0.0);
    for seed in 0..6 {
        // Intensity: √2000 mm/s² in a second.
        let (mut steps, mut walk) = (Normal::new(seed, 9), vec![0.0]);
        while walk.len() < 3001 {
            walk.push(walk[walk.len() - 1] + (2000.0 * PERIOD_S).sqrt() * steps.draw());
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the number of a row")]
        let at = |time_s: f64| walk[(time_s / PERIOD_S).round() as usize];
        let found = missing_force(&rig(), &record(&rig(), seed, at));
        one += covered(&found, 1.0, at) / 6.0;
        two += covered(&found, 2.0, at) / 6.0;
    }
    // Some 800 independent estimates: 4 standard errors are 7 % and 3 %.
    assert!((one - 0.683_f64).abs() < 0.07 && (two - 0.954_f64).abs() < 0.03, "{one} and {two}");
}

#[test]
fn a_push_of_known_size_and_time_is_recovered() {
    let push = |time_s: f64| if (30.0..40.0).contains(&time_s) { 150.0 } else { 0.0 };
    let found = missing_force(&rig(), &record(&rig(), 3, push));
    let mean = |from: f64, to: f64| {
        let within: Vec<_> = found.iter().filter(|m| (from..to).contains(&m.time_s)).collect();
        within.iter().map(|m| m.force_mm_per_s2).sum::<f64>() / within.len() as f64
    };
    for (from, to, force) in [(10.0, 29.0, 0.0), (31.0, 39.0, 150.0), (41.0, 58.0, 0.0)] {
        assert!((mean(from, to) - force).abs() < 20.0, "{} mm/s² from {from} s to {to} s", mean(from, to));
    }
}

#[test]
fn the_sigma_of_a_force_on_a_free_mass_is_that_of_the_wiener_smoother() {
    // Without drag and white noise: σ² = ∫ q·s/(s·ω⁶ + q)·ω⁴ dω/2π = q/(3·ω₀), ω₀⁶ = q/s, s = σ_y²·T the noise's
    // density.
    let noise = Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 0.0 };
    let mass = Model { drag_per_s: 0.0, noise, ..rig() };
    let recording = record(&mass, 1, |_| 0.0);
    for intensity in [50.0, 2000.0, 80_000.0] {
        let cut_per_s = f64::powf(intensity / (2.5 * 2.5 * PERIOD_S), 1.0 / 6.0);
        let exact = (intensity / (3.0 * cut_per_s)).sqrt();
        let (_, middle) = smoothed_states(&with_force(&mass, intensity), &recording)[1500];
        assert!((middle.air_mm_per_s2.1 / exact - 1.0).abs() < 0.02, "{:?}, exact {exact}", middle.air_mm_per_s2);
    }
}

#[test]
fn a_right_model_lacks_next_to_nothing() {
    let found = missing_force(&rig(), &record(&rig(), 5, |_| 0.0));
    let rms = (found.iter().map(|m| m.force_mm_per_s2.powi(2)).sum::<f64>() / found.len() as f64).sqrt();
    assert!(rms < 12.0, "{rms} mm/s²");
}

#[test]
fn the_force_is_dated_by_the_moment_that_a_late_reading_shows() {
    let mut late = rig();
    late.effects.sensor_delay = Some(plant::effects::SensorDelay { delay_s: 0.1 });
    let recording = record(&late, 2, |_| 0.0);
    let found = missing_force(&late, &recording);
    let last_s = recording.samples()[2999].time_s;
    assert!((found[found.len() - 1].time_s - (last_s - 0.1)).abs() < 1e-9);
}

#[test]
fn what_a_dead_zone_swallows_is_missing() {
    let mut stuck = rig();
    stuck.effects.dead_zone = Some(plant::effects::DeadZone { lower_percent: -0.3, upper_percent: 0.3 });
    let found = missing_force(&rig(), &record(&stuck, 4, |_| 0.0));
    // Where the duty is beyond the dead zone, 0.3 % of it are lost: 76 mm/s² against it.
    let mean = |side: f64| {
        let beyond: Vec<_> = found.iter().filter(|m| side * (m.duty_percent - 21.4) > 0.4).collect();
        beyond.iter().map(|m| m.force_mm_per_s2).sum::<f64>() / beyond.len() as f64
    };
    for side in [-1.0, 1.0] {
        assert!((-90.0..-40.0).contains(&(side * mean(side))), "{} mm/s²", mean(side));
    }
}
