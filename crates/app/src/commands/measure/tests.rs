//! The measurements on the simulated rig with chips, in virtual time: the intervals must contain the config's values.
//! Their coverage is counted in `diagnose`, without chips and so in a fraction of the time.

use super::own;
use super::patch::patch;
use crate::analysis::measurement::Found;
use crate::analysis::virtual_flight::Desk;
use crate::cli::Measurement;
use crate::flight::experiment::Experiment;
use crate::log::header::About;
use crate::log::reader::{LoadedLog, sample};
use clap::ValueEnum;
use config::{Config, Tables};
use control::design::critical::critical_gain;
use control::design::law::Gains;
use diagnose::Recording;
use diagnose::measure::Estimate;
use plant::effects::DeadZone;
use rayon::prelude::*;

fn tables() -> Tables {
    toml::from_str(include_str!("../../../../../config.toml")).unwrap()
}

/// Flies the experiment of `what` on the rig of `tables`.
fn fly(what: Measurement, tables: &Tables, seed: u64) -> LoadedLog {
    let own = own(what);
    let desk = Desk::of(tables).unwrap();
    let experiment = Experiment::own(own.name, own.text, &desk.safety).unwrap();
    let flown = desk.fly(tables.plant.as_ref().unwrap(), &experiment, seed);
    assert_eq!(flown.fault, None, "{what:?}, seed {seed}");
    LoadedLog {
        recording: Recording::new(flown.cycles.iter().map(sample).collect()).unwrap(),
        about: About::default(),
        config_toml: None,
        cycles: flown.cycles,
        events: vec![],
        truncated: None,
    }
}

fn measure(what: Measurement, tables: &Tables, seed: u64) -> Found {
    Found::of(what, &fly(what, tables, seed), tables, None).unwrap()
}

/// Asserts that each truth is within two and a half 90 % intervals, four deviations, of what three seeds show.
fn assert_found<const N: usize>(truth: [f64; N], measured: impl Fn(u64) -> [Estimate; N] + Send + Sync) {
    let all: Vec<[Estimate; N]> = (1..=3).into_par_iter().map(measured).collect();
    for (found, truth) in all.iter().flat_map(|found| found.iter().zip(truth)) {
        let Estimate { value, low, high } = *found;
        let wide = Estimate { value, low: value - 2.5 * (value - low), high: value + 2.5 * (high - value) };
        assert!(wide.holds(truth), "{found:?} beside {truth}; all: {all:?}");
    }
}

#[test]
fn every_measurement_has_an_experiment_that_the_config_of_the_project_allows() {
    let safety = tables().safety.unwrap();
    for what in Measurement::value_variants() {
        let own = own(*what);
        assert!(Experiment::own(own.name, own.text, &safety).unwrap().duration_s() > 10.0, "{what:?}");
    }
}

#[test]
fn the_noise_of_the_sensor_is_the_configs() {
    let tables = tables();
    assert_found([2.5], |seed| match measure(Measurement::NoiseFloor, &tables, seed) {
        Found::NoiseFloor(floor) => [floor.sensor_mm],
        other => panic!("{other:?}"),
    });
}

#[test]
fn the_edges_of_the_dead_zone_the_gains_and_the_fans_lag_are_the_configs() {
    let mut tables = tables();
    tables.plant.as_mut().unwrap().effects.dead_zone = Some(DeadZone { lower_percent: -0.25, upper_percent: 0.35 });
    let truth = [21.15, 21.75, 827.2, 827.2, 0.257];
    assert_found(truth, |seed| match measure(Measurement::DeadZone, &tables, seed) {
        Found::DeadZone { zone, jumps } => {
            let edges = [zone.lower_duty_percent, zone.upper_duty_percent];
            [edges[0], edges[1], zone.gain_below, zone.gain_above, jumps.lag_s]
        }
        other => panic!("{other:?}"),
    });
}

#[test]
fn offset_and_scale_of_a_sensor_above_the_pipe_are_the_configs() {
    let mut tables = tables();
    let rig = tables.rig.as_mut().unwrap();
    (rig.sensor_to_bottom_mm, rig.sensor_scale) = (643.0, 1.04);
    assert_found([643.0, 1.04], |seed| match measure(Measurement::Calibration, &tables, seed) {
        Found::Calibration(found) => [found.sensor_to_bottom_mm, found.sensor_scale.unwrap()],
        other => panic!("{other:?}"),
    });
}

#[test]
fn a_ball_in_the_blind_zone_calibrates_no_scale() {
    let Found::Calibration(found) = measure(Measurement::Calibration, &tables(), 1) else { panic!("no calibration") };
    assert!(found.sensor_scale.is_none() && (found.sensor_to_bottom_mm.value - 583.0).abs() < 0.5, "{found:?}");
    let passed: Vec<bool> = found.bands.iter().map(|band| band.pass).collect();
    assert_eq!(passed, [true, false, true, false], "{found:?}");
}

#[test]
fn the_critical_gain_is_that_of_the_sampled_loop_of_the_config() {
    // Without chips the readings have no age, so that the closed form is exact.
    let tables = Tables { rig: None, ..tables() };
    let plant = tables.plant.as_ref().unwrap().linear().sampled(0.02).unwrap();
    let exact = critical_gain(&Gains::pi(1.0, 15.0), &plant).value().unwrap();
    assert_found([exact], |seed| match measure(Measurement::CriticalGain, &tables, seed) {
        Found::CriticalGain(found) => [found.kp_per_mm],
        other => panic!("{other:?}"),
    });
}

#[test]
fn a_measured_force_curve_is_a_patch_that_flies() {
    let mut bent = tables();
    bent.plant.as_mut().unwrap().effects.dead_zone = Some(DeadZone { lower_percent: -0.2, upper_percent: 0.2 });
    let found = measure(Measurement::ForceCurve, &bent, 1);
    let text = patch(&found, &bent).unwrap().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let [config, file] = ["config.toml", "patch.toml"].map(|name| directory.path().join(name));
    std::fs::write(&config, toml::to_string(&bent).unwrap()).unwrap();
    std::fs::write(&file, &text).unwrap();
    let patched = Config::read(&config, &[file]).unwrap().tables;
    let Found::Steps(steps) = measure(Measurement::Steps, &patched, 2) else { panic!("no steps") };
    let Found::Steps(before) = measure(Measurement::Steps, &bent, 2) else { panic!("no steps") };
    assert!(steps.settled >= before.settled, "{steps:?} beside {before:?}");
    let overshoot = steps.overshoot_percent.unwrap().value;
    assert!(overshoot < before.overshoot_percent.unwrap().value + 15.0, "{steps:?} beside {before:?}");
}
