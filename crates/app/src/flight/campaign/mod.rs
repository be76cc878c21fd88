//! The fault campaign: every fault of a list, from a random moment of a flight on, thousands of times. In every case
//! the fan never gets more than the safe duty; a permanent loss of sensor or fan control turns the fan off within the
//! bound of docs/rig.md; a fan that is still on is reported; and the log can be read.

mod faults;
mod interleaved;
mod scene;
mod signals;

pub(crate) use signals::rich;

use super::experiment::{Experiment, Limits, Segment};
use super::pilot::{Orders, Pilot, Signals};
use super::vocabulary::{Cycle, End};
use super::{Flight, Outcome};
use crate::log::flight as logged;
use crate::log::header::{Header, SIMULATED_START};
use crate::log::recorder::Inline;
use crate::log::writer::LogWriter;
use config::{Loop, Tables};
use control::regulator::Regulator;
use control::waveform::Waveform;
use faults::{Case, FAN, Mishap, PERIOD_S, cases};
use hal::emulator::EmulatedBus;
use hal::stop_fan;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rig::{PlantWorld, WorldClock, start, with_signals};
use scene::{Bus, Scene, Struck};
use std::cell::Cell;
use std::io::Cursor;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Flights of each fault in the quick test, 2046 in all, which take some seconds; and in the slow one, 7440.
const QUICK: u64 = 11;
const SLOW: u64 = 40;
/// Length of a flight, seconds.
const FLIGHT_S: f64 = 6.0;

fn tables() -> Tables {
    toml::from_str(include_str!("../../../../../config.toml")).unwrap()
}

/// The project's controller, holding 300 mm.
fn pilot(tables: &Tables) -> Pilot {
    let setpoint = Waveform::Constant { value: 300.0 };
    let segment = Segment { duration_s: 60.0, setpoint_mm: Some(setpoint), ..Segment::default() };
    let limits = Limits { position_min_mm: None, position_max_mm: None };
    Pilot::new(Orders {
        regulator: Regulator::new(tables.controller.clone().unwrap(), tables.observer.as_ref(), 0.02).unwrap(),
        compensation: tables.compensation.clone().unwrap(),
        safety: tables.safety.unwrap(),
        experiment: Experiment { title: "campaign".into(), limits, segments: vec![segment].into() },
        reading_period_s: 0.02,
        signals: tables.rig.as_ref().map(Signals::from).unwrap_or_default(),
        top_mm: tables.rig.as_ref().unwrap().sensor_to_bottom_mm,
    })
}

fn header() -> Header {
    Header {
        version: "0".into(),
        command: "campaign".into(),
        seed: Some(0),
        started: SIMULATED_START,
        config_toml: String::new(),
    }
}

struct Flown {
    outcome: Outcome,
    bus: Bus,
    struck_s: f64,
    /// Time of the last cycle's reading.
    ended_s: f64,
    log: Vec<u8>,
}

fn fly(tables: &Tables, case: Case, seed: u64) -> Flown {
    let mut random = Pcg64::seed_from_u64(seed);
    let (model, rig) = (tables.plant.as_ref().unwrap(), tables.rig.as_ref().unwrap());
    let bus = with_signals(EmulatedBus::new(Scene::new(PlantWorld::in_virtual_time(model, rig, seed))), rig);
    let clock = WorldClock(bus.clone());
    let chips = start(&bus, clock, rig).unwrap();
    let at_s = 0.2 + 2.5 * f64::from(random.next_u32()) / f64::from(u32::MAX);
    let skip = u64::from(random.next_u32() % 4);
    let (struck_s, looked_s) = (Cell::new(None), Cell::new(0.0));
    let mut struck = Struck { rig: chips, bus: bus.clone(), case, at_s, skip, struck_s, looked_s };
    let mut log = Vec::new();
    let writer = LogWriter::to(Cursor::new(&mut log), Path::new("campaign.mcap"), &header()).unwrap();
    let mut recorder = Inline::new(writer);
    let table = Loop { period_s: PERIOD_S, late_after_s: 0.002 };
    let flight = Flight::new(&mut struck, pilot(tables), &table, &mut recorder, None);
    let outcome = flight.fly(FLIGHT_S, &AtomicBool::new(false));
    recorder.finish().unwrap();
    let (struck_s, ended_s) = (struck.struck_s.get().unwrap(), struck.looked_s.get());
    // The rig is not dropped: that would turn the fan off once more, and hide the state that the flight left.
    std::mem::forget(struck);
    Flown { outcome, bus, struck_s, ended_s, log }
}

fn check(tables: &Tables, case: Case, seed: u64) {
    let Flown { outcome, bus, struck_s, ended_s, log } = fly(tables, case, seed);
    let what = format!("{case:?}, seed {seed}, from {struck_s:.3} s: {outcome:?}");
    let safe = tables.safety.unwrap().duty_max_percent / 100.0 + 1.0 / 4096.0;
    let fan = bus.with_world(|scene| scene.fan.clone());
    assert!(fan.iter().all(|(_, fraction)| *fraction <= safe), "{what}: beyond the safe duty");

    let still_on = bus.with_world(|scene| scene.fan_now()) > 0.0;
    assert!(!still_on || outcome.fan_still_on.is_some(), "{what}: the fan is on and nobody knows");
    if let Some(bound_s) = case.bound_s(tables) {
        assert_eq!(outcome.end, End::Fault, "{what}");
        let after_s = ended_s - struck_s;
        assert!(after_s <= bound_s, "{what}: ended {after_s} s after the fault, {bound_s} s are allowed");
        let off_s = fan.last().map_or(0.0, |(at_s, _)| at_s - struck_s);
        assert!(still_on || off_s <= bound_s, "{what}: off {off_s} s after the fault, {bound_s} s are allowed");
    }
    // The action of a guard when the bus works again.
    bus.repair();
    stop_fan(bus.handle()).unwrap();
    assert_eq!(bus.with_world(|scene| scene.fan_now()), 0.0, "{what}");

    let flight = logged::parse(Path::new("campaign.mcap"), &log).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert!(flight.complete && flight.cycles.len() as u64 <= outcome.punctuality.cycles, "{what}");
    if let Some(bound_s) = case.push_bound_s(tables) {
        let pushed_s = longest_push_s(&flight.cycles, tables.safety.unwrap().stuck.unwrap().control_percent);
        assert!(pushed_s <= bound_s, "{what}: pushed for {pushed_s} s, {bound_s} s are allowed");
    }
    assert!(outcome.fault.is_none() || flight.events.iter().any(|event| event.kind == "fault"), "{what}");
}

/// The longest time for which the controller commanded `percent` or more, with one sign, while the position was exactly
/// constant, seconds.
fn longest_push_s(cycles: &[Cycle], percent: f64) -> f64 {
    let push = |cycle: &Cycle| {
        let control = cycle.control_percent.filter(|control| control.abs() >= percent)?;
        Some((cycle.position_mm?, control.signum()))
    };
    let (mut longest_s, mut since) = (0.0_f64, None);
    for cycle in cycles {
        since = push(cycle).map(|push| match since {
            Some((same, since_s)) if same == push => (push, since_s),
            _ => (push, cycle.time_s),
        });
        longest_s = longest_s.max(since.map_or(0.0, |(_, since_s)| cycle.time_s - since_s));
    }
    longest_s
}

fn campaign(flights: u64) {
    let tables = tables();
    for seed in 0..flights {
        for (k, case) in (0..).zip(cases(seed)) {
            check(&tables, case, 1000 * seed + k);
        }
    }
}

#[test]
fn the_list_holds_what_can_go_wrong_and_no_entry_twice() {
    let list = cases(0);
    assert!(list.len() >= 40, "{}", list.len());
    for (k, case) in list.iter().enumerate() {
        assert!(!list[..k].contains(case), "{case:?}");
    }
    let tables = tables();
    let (bounded, pushed) =
        (|case: &&Case| case.bound_s(&tables).is_some(), |case: &&Case| case.push_bound_s(&tables).is_some());
    assert_eq!((list.iter().filter(bounded).count(), list.iter().filter(pushed).count()), (45, 2));
}

#[test]
fn no_fault_leaves_the_fan_above_the_safe_duty_or_unknown_to_be_on() {
    campaign(QUICK);
}

#[test]
#[ignore = "slow: the whole campaign"]
fn in_thousands_of_flights_no_fault_leaves_the_fan_above_the_safe_duty_or_unknown_to_be_on() {
    campaign(SLOW);
}

#[test]
fn a_stuck_ball_and_a_frozen_sensor_that_the_controller_pushes_end_the_flight() {
    let mut tables = tables();
    // Frozen during the ascent, far below the setpoint: the push lasts.
    let stuck = config::Stuck { control_percent: 1.0, after_s: 1.0 };
    tables.safety = tables.safety.map(|safety| config::Safety { stuck: Some(stuck), ..safety });
    for mishap in [Mishap::BallStuck, Mishap::SensorFrozen] {
        let case = Case { mishap, lasting: faults::Lasting::ForEver };
        let ended = (0..20).filter(|seed| fly(&tables, case, *seed).outcome.end == End::Fault).count();
        (0..20).for_each(|seed| check(&tables, case, seed));
        assert!(ended >= 5, "{mishap:?}: {ended} of 20");
    }
}

#[test]
fn a_flight_to_which_nothing_happens_ends_well() {
    let tables = tables();
    let case = Case { mishap: Mishap::Pause { seconds: 0.0 }, lasting: faults::Lasting::ForEver };
    let flown = fly(&tables, case, 1);
    assert_eq!((flown.outcome.end, flown.outcome.fan_still_on), (End::Finished, None));
    assert!(flown.bus.transactions(FAN) > 500);
}
