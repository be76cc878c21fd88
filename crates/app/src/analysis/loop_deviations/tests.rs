//! Tests of the stages before the plant.

use super::{Upstream, upstream};
use crate::analysis::closed_loop::tests::{log, project};
use crate::analysis::virtual_flight::Desk;
use crate::flight::experiment::Experiment;
use crate::flight::vocabulary::Cycle;
use crate::log::header::About;
use crate::log::reader::{LoadedLog, sample};
use config::Tables;

/// A flight of the believed rig by the project's controller, whose log holds `header` as its config.
fn flight(header: &Tables, spoil: impl Fn(usize, &mut Cycle)) -> LoadedLog {
    let tables = project();
    let mut programme = Experiment::of_reference(tables.reference.as_ref().unwrap());
    programme.change(0, |only| only.duration_s = 40.0);
    let mut cycles = Desk::of(&tables).unwrap().fly(tables.plant.as_ref().unwrap(), &programme, 3).cycles;
    cycles.iter_mut().enumerate().for_each(|(k, cycle)| spoil(k, cycle));
    let config_toml = Some(toml::to_string(header).unwrap());
    LoadedLog { config_toml, cycles: cycles.clone(), ..log(cycles.iter().map(sample).collect()) }
}

fn found(log: &LoadedLog) -> Vec<Upstream> {
    upstream(log, project().plant.as_ref().unwrap())
}

fn with_twice_the_gain() -> Tables {
    let mut header = project();
    header.controller.as_mut().unwrap().pid.as_mut().unwrap().kp_per_mm *= 2.0;
    header
}

#[test]
fn a_flight_by_its_own_config_gives_exactly_the_duty_that_was_logged() {
    let log = flight(&project(), |_, _| {});
    let cycles = super::under_the_law(&log);
    assert!(cycles.len() > 1900, "{}", cycles.len());
    for (cycle, duty) in cycles.iter().zip(super::duties_by_the_law(cycles, &project()).unwrap()) {
        assert_eq!(cycle.commanded_duty_percent, duty, "at {} s", cycle.time_s);
    }
    assert_eq!(found(&log), []);
}

#[test]
fn gains_that_are_not_those_that_flew_are_a_gap_of_the_controller() {
    let stages = found(&flight(&with_twice_the_gain(), |_, _| {}));
    assert!(matches!(&stages[..], [Upstream { name: "controller", nats, .. }] if *nats > 50.0), "{stages:?}");
    assert!(stages[0].finding.contains("[controller]"), "{}", stages[0].finding);
}

#[test]
fn an_unknown_excitation_is_not_blamed_on_the_controller() {
    let mut log = flight(&with_twice_the_gain(), |_, _| {});
    log.about = About { command: Some("airball run --experiment prbs.toml".into()), ..About::default() };
    assert_eq!(found(&log), []);
}

#[test]
fn a_law_that_was_retuned_in_flight_is_followed_up_to_there() {
    let flown = flight(&project(), |_, _| {});
    for command in
        ["gains kp 0.02", "controller lqr", "numbers pid.kp_per_mm 0.02 ", "numbers undo", "experiment steps"]
    {
        let (mut log, text) = (flown.clone(), format!("{command}: accepted"));
        log.events.push(crate::log::event::EventMessage { time_s: 20.0, kind: "command".into(), text, lateness: None });
        assert!((990..1010).contains(&super::under_the_law(&log).len()), "{command}");
    }
}

#[test]
fn cycles_that_begin_late_are_a_gap_of_timing() {
    // Each third cycle of the simulated flight was punctual; its deadline in the log is moved to 15 ms before.
    let stages = found(&flight(&project(), |k, cycle| cycle.lateness_s += if k % 3 == 0 { 0.015 } else { 0.0 }));
    assert!(matches!(&stages[..], [Upstream { name: "timing", .. }]), "{stages:?}");
    assert!(stages[0].finding.contains("15.0 ms"), "{}", stages[0].finding);
}

#[test]
fn a_log_without_its_config_has_neither() {
    let log = LoadedLog { config_toml: None, ..flight(&with_twice_the_gain(), |_, _| {}) };
    assert_eq!(found(&log), []);
}
