//! Which effects a recorded fan speed distinguishes.

use crate::tests_support::{model, record};
use crate::{Diagnosis, Options, Recording, Sample, Verdict, diagnose};
use plant::{Effects, Model, Normal};

/// A flight of `rig` whose rotor, `late_s` behind the duty and with a lag of `lag_s`, is recorded at 3000 ± 30 rpm with
/// a slight curvature: integrated by small steps, independently of the code under test.
fn seen(rig: &Model, seed: u64, late_s: f64, lag_s: f64) -> Recording {
    let flight = record(rig, seed, 60);
    let samples = flight.samples();
    let mut noise = Normal::new(seed, 9);
    let (mut rotor, step_s) = (samples[0].duty_percent, 0.001);
    let row = |k: usize| {
        let sample = samples[k];
        let seen = rotor + 0.01 * (rotor - 21.4_f64).powi(2);
        let rpm = 3000.0 + 140.0 * (seen - 21.4) + 30.0 * noise.draw();
        let next_s = samples.get(k + 1).map_or(sample.time_s, |next| next.time_s);
        let mut now_s = sample.time_s;
        while now_s < next_s - 1e-9 {
            let written = samples.partition_point(|other| other.time_s <= now_s - late_s + 1e-9).max(1);
            rotor += step_s / lag_s.max(step_s) * (samples[written - 1].duty_percent - rotor);
            now_s += step_s;
        }
        Sample { fan_rpm: Some(rpm.round()), ..sample }
    };
    Recording::new((0..samples.len()).map(row).collect()).unwrap()
}

fn with(name: &str, values: &[f64]) -> Model {
    let mut rig = Model { effects: Effects::default(), ..model() };
    rig.effects.set(name, values);
    rig
}

fn blind_to_speed(recording: &Recording) -> Recording {
    Recording::new(recording.samples().iter().map(|row| Sample { fan_rpm: None, ..*row }).collect()).unwrap()
}

fn names(found: &Diagnosis) -> Vec<(&'static str, Vec<&'static str>)> {
    let names = found.effects.iter().map(|n| (n.candidate.entry.name, n.indistinguishable_from.clone()));
    names.collect()
}

/// With the speed the search names `truth` alone; without it, it names a set of both.
fn is_settled(truth: &'static str, values: &[f64], twin: &'static str, late_s: f64, lag_s: f64) {
    let belief = Model { effects: Effects::default(), ..model() };
    let recording = seen(&with(truth, values), 4, late_s, lag_s);
    let found = diagnose(&belief, &recording, &Options::default());
    assert_eq!((found.verdict, names(&found)), (Verdict::Effect, vec![(truth, vec![])]));
    let found = diagnose(&belief, &blind_to_speed(&recording), &Options::default());
    let (name, others) = names(&found).remove(0);
    let set = [&[name][..], &others].concat();
    assert!(set.contains(&truth) && set.contains(&twin), "{set:?}");
}

#[test]
fn a_delay_of_the_duty_is_told_from_one_of_the_reading() {
    is_settled("transport_delay", &[0.1], "sensor_delay", 0.1, 0.0);
}

#[test]
fn a_delay_of_the_reading_is_told_from_one_of_the_duty() {
    is_settled("sensor_delay", &[0.1], "transport_delay", 0.0, 0.0);
}

#[test]
fn a_lag_of_the_fan_is_told_from_one_of_the_sensor() {
    is_settled("fan_lag", &[0.15], "sensor_lag", 0.0, 0.15);
}

#[test]
fn a_lag_of_the_sensor_is_told_from_one_of_the_fan() {
    is_settled("sensor_lag", &[0.15], "fan_lag", 0.0, 0.0);
}

#[test]
fn a_dead_zone_behind_the_rotor_is_found_as_well_with_the_speed_as_without() {
    let rig = with("dead_zone", &[-0.3, 0.3]);
    let belief = Model { effects: Effects::default(), ..model() };
    let recording = seen(&rig, 4, 0.0, 0.0);
    for recording in [blind_to_speed(&recording), recording] {
        let found = diagnose(&belief, &recording, &Options::default());
        assert_eq!(names(&found), [("dead_zone", vec![])]);
    }
}

#[test]
fn a_rig_as_believed_has_no_gap_with_its_speed_recorded() {
    for seed in 20..24 {
        let found = diagnose(&model(), &seen(&model(), seed, 0.0, 0.2), &Options::default());
        assert_eq!(found.verdict, Verdict::NoGap, "seed {seed}: {:?}", names(&found));
    }
}
