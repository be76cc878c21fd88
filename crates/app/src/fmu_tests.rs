//! An instance as a simulator steps it, beside the flight of `airball simulate`.

use crate::library::{Belief, Flown, Programme, fly};
use config::Config;
use fmu::{DUTY, FRESH, HELD, Instance, Kind, MODEL, NOISE, POSITION, SEED, SETPOINT, VELOCITY, variables};
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const PERIOD_S: f64 = 0.02;

fn config() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config.toml")).unwrap()
}

fn instance() -> (tempfile::TempDir, Instance) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(MODEL), config()).unwrap();
    let instance = Instance::new(folder.path()).unwrap();
    (folder, instance)
}

fn flight() -> Flown {
    let belief = Belief::of_texts([("config.toml".into(), config())]).unwrap();
    fly(&belief, Programme::Reference, 7, Some(8.0), &AtomicBool::new(false)).unwrap()
}

/// Reading, whether it is new, and the duty in the chip, of each cycle.
fn cycles(flown: &Flown) -> Vec<[f64; 3]> {
    let [position, fresh, held] = ["position_mm", "fresh", "duty_percent"].map(|name| flown.column(name).unwrap());
    position.into_iter().zip(fresh).zip(held).map(|((position, fresh), held)| [position, fresh, held]).collect()
}

/// The same of an instance that gets the duties of the cycles in `range`.
fn stepped(instance: &mut Instance, flown: &Flown, range: std::ops::Range<usize>) -> Vec<[f64; 3]> {
    stepped_from(instance, flown, range, 0.0)
}

/// The same of a simulation that begins at `begins_s`.
fn stepped_from(instance: &mut Instance, flown: &Flown, range: std::ops::Range<usize>, begins_s: f64) -> Vec<[f64; 3]> {
    let [duty, setpoint] = ["commanded_duty_percent", "setpoint_mm"].map(|name| flown.column(name).unwrap());
    let cycle = |at: usize| {
        let get = |instance: &Instance, reference, kind| instance.get(reference, kind).unwrap();
        let (position, fresh) = (get(instance, POSITION, Kind::Real), get(instance, FRESH, Kind::Boolean));
        instance.set(DUTY, Kind::Real, duty[at]).unwrap();
        instance.set(SETPOINT, Kind::Real, setpoint[at]).unwrap();
        // As a simulator adds up its time.
        instance.step(begins_s + at as f64 * PERIOD_S, PERIOD_S).unwrap();
        [position, fresh, get(instance, HELD, Kind::Real)]
    };
    range.map(cycle).collect()
}

#[test]
fn with_the_duties_of_a_flight_it_gives_the_readings_of_that_flight() {
    let (flown, (_folder, mut instance)) = (flight(), instance());
    instance.set(SEED, Kind::Integer, 7.0).unwrap();
    instance.start().unwrap();
    let wanted = cycles(&flown);
    assert!(wanted.len() == 400 && wanted.iter().any(|cycle| cycle[0] > 100.0));
    assert_eq!(stepped(&mut instance, &flown, 0..400), wanted);
    assert_ne!(instance.get(VELOCITY, Kind::Real).unwrap(), 0.0);
}

#[test]
fn a_simulation_that_begins_later_flies_the_same_and_no_time_is_left_out() {
    let (flown, (_folder, mut instance)) = (flight(), instance());
    instance.set(SEED, Kind::Integer, 7.0).unwrap();
    instance.begin_at(10.0).unwrap();
    instance.start().unwrap();
    assert_eq!(stepped_from(&mut instance, &flown, 0..100, 10.0), cycles(&flown)[..100]);
    let refused = instance.step(12.5, PERIOD_S).unwrap_err().to_string();
    assert!(refused.contains("it begins at 12.5 s, and the time is 12 s"), "{refused}");
    assert!(instance.begin_at(11.0).unwrap_err().to_string().contains("after the initialization"));
}

#[test]
fn a_state_that_is_set_again_goes_on_from_there_and_a_reset_one_from_the_start() {
    let (flown, (_folder, mut instance)) = (flight(), instance());
    let begin = |instance: &mut Instance| {
        instance.set(SEED, Kind::Integer, 7.0).unwrap();
        instance.start().unwrap();
    };
    begin(&mut instance);
    let wanted = cycles(&flown);
    assert_eq!(stepped(&mut instance, &flown, 0..100), wanted[..100]);
    let state = instance.state();
    instance.set(DUTY, Kind::Real, 0.0).unwrap();
    instance.step(100.0 * PERIOD_S, 7.0).unwrap();
    instance.set_state(&state).unwrap();
    assert_eq!(stepped(&mut instance, &flown, 100..200), wanted[100..200]);
    instance.reset();
    begin(&mut instance);
    assert_eq!(stepped(&mut instance, &flown, 0..100), wanted[..100]);
}

#[test]
fn what_cannot_be_set_or_flown_is_refused_with_its_name() {
    let (folder, mut instance) = instance();
    let model = Config::read(&folder.path().join(MODEL), &[]).unwrap().tables.plant.unwrap();
    let gain = 100;
    assert!(instance.step(0.0, 0.02).unwrap_err().to_string().contains("the initialization has not ended"));
    let refused =
        |instance: &mut Instance, reference, kind, value| instance.set(reference, kind, value).unwrap_err().to_string();
    assert_eq!(refused(&mut instance, POSITION, Kind::Real, 1.0), "position_mm cannot be set as it is an output");
    assert_eq!(refused(&mut instance, DUTY, Kind::Real, f64::NAN), "duty_percent is NaN, not a finite number");
    assert_eq!(refused(&mut instance, 5555, Kind::Real, 1.0), "there is no real variable with the reference 5555");
    assert_eq!(refused(&mut instance, DUTY, Kind::Integer, 1.0), "there is no integer variable with the reference 0");
    let name = variables(&model).iter().find(|variable| variable.name == "plant.drag_per_s").unwrap().reference;
    instance.set(name, Kind::Real, -1.0).unwrap();
    assert!(instance.start().unwrap_err().to_string().contains("drag_per_s"));
    instance.set(name, Kind::Real, 3.9).unwrap();
    instance.start().unwrap();
    assert!(refused(&mut instance, gain, Kind::Real, 800.0).ends_with("cannot be set after the initialization"));
    instance.step(0.0, 0.02).unwrap();
    assert!(instance.step(0.0, 0.02).unwrap_err().to_string().contains("the time is 0.02 s already"));
}

#[test]
fn without_noise_two_seeds_fly_alike() {
    let (flown, (_folder, mut instance)) = (flight(), instance());
    let mut flights = [1.0, 2.0].map(|seed| {
        instance.reset();
        instance.set(SEED, Kind::Integer, seed).unwrap();
        instance.set(NOISE, Kind::Boolean, 0.0).unwrap();
        instance.start().unwrap();
        stepped(&mut instance, &flown, 0..100)
    });
    assert_eq!(flights[0], flights[1]);
    instance.reset();
    instance.start().unwrap();
    flights[1] = stepped(&mut instance, &flown, 0..100);
    assert_ne!(flights[0], flights[1]);
}
