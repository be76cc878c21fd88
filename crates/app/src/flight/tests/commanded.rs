//! Tests of flights that somebody commands: faults that wait for `fly`, and gains that were too large.

use super::{Memory, Script, WORKS};
use crate::flight::command::{Command, GainChange};
use crate::flight::experiment::Experiment;
use crate::flight::outside::Commander;
use crate::flight::pilot::tests::pilot_holding;
use crate::flight::pilot::{Orders, Pilot};
use crate::flight::state::{Answer, State};
use crate::flight::vocabulary::{End, Fault, Mode, What};
use crate::flight::{Flight, Outcome};
use config::{Loop, Tables};
use control::{Duty, Millimetres};
use embedded_hal::i2c::ErrorKind;
use rig::{Sighting, simulated_in_virtual_time};
use std::cell::Cell;
use std::sync::atomic::AtomicBool;

/// Somebody who sends commands at these times, seconds.
struct Caller {
    heard: bool,
    calls: Vec<(f64, Command)>,
    states: Vec<State>,
}

impl Caller {
    fn with(calls: &[(f64, Command)]) -> Self {
        Self { heard: true, calls: calls.iter().rev().copied().collect(), states: Vec::new() }
    }
}

impl Commander for Caller {
    fn try_command(&mut self) -> Option<Command> {
        let now_s = self.states.last()?.cycle.time_s;
        self.calls.pop_if(|(at_s, _)| *at_s <= now_s).map(|(_, command)| command)
    }
    fn answer(&mut self, answer: Answer) {
        assert_eq!(answer.refused, None, "{:?}", answer.command);
    }
    fn publish_state(&mut self, state: State) {
        self.states.push(state);
    }
    fn is_heard(&self) -> bool {
        self.heard
    }
}

/// No ball is seen between 1 and 2 s of the flight.
const NO_BALL: fn(f64) -> Result<Sighting, ErrorKind> = |now_s| {
    let there = !(6.0..7.0).contains(&now_s);
    Ok(if there { Sighting::Ball(Millimetres(250.0)) } else { Sighting::NoBall { reported_mm: 8190 } })
};

fn fly(caller: &mut Caller, drive: fn(f64) -> Result<(), ErrorKind>, waits: bool) -> (Outcome, Memory, Duty) {
    flown(caller, NO_BALL, drive, waits)
}

fn flown(
    caller: &mut Caller,
    position: fn(f64) -> Result<Sighting, ErrorKind>,
    drive: fn(f64) -> Result<(), ErrorKind>,
    waits: bool,
) -> (Outcome, Memory, Duty) {
    let mut rig = Script { now_s: Cell::new(5.0), position, drive, duty: Duty::OFF };
    let (mut memory, table) = (Memory::default(), Loop { period_s: 0.02, late_after_s: 0.002 });
    let flight = Flight::new(&mut rig, pilot_holding(300.0, 60.0), &table, &mut memory, Some(caller));
    let flight = if waits { flight.waiting_after_faults() } else { flight };
    let outcome = flight.fly(5.0, &AtomicBool::new(false));
    (outcome, memory, rig.duty)
}

#[test]
fn a_fault_waits_with_the_fan_off_for_fly_and_then_the_ball_is_flown_again() {
    let mut caller = Caller::with(&[(3.0, Command::Fly)]);
    let (outcome, memory, _) = fly(&mut caller, WORKS, true);
    assert_eq!((outcome.end, outcome.fault), (End::Finished, None));
    let waiting: Vec<_> = caller.states.iter().filter(|state| state.stopped_by.is_some()).collect();
    assert!((60..90).contains(&waiting.len()), "{} cycles", waiting.len());
    assert!(waiting.iter().all(|state| state.cycle.mode == Mode::Stopped && state.cycle.duty_percent == 0.0));
    let last = caller.states.last().unwrap();
    assert_eq!((last.cycle.mode, last.stopped_by), (Mode::Flying, None));
    let noted = memory.events.iter().filter(|what| matches!(what, What::Fault(Fault::NoBall { .. }))).count();
    assert_eq!(noted, 1, "{:?}", memory.events);
}

#[test]
fn a_fault_that_nobody_answers_is_the_result_of_the_flight() {
    let (outcome, memory, duty) = fly(&mut Caller::with(&[]), WORKS, true);
    assert_eq!((outcome.end, duty), (End::Fault, Duty::OFF));
    assert!(matches!(outcome.fault, Some(Fault::NoBall { .. })), "{:?}", outcome.fault);
    assert_eq!((memory.events.last(), outcome.punctuality.cycles), (Some(&What::End(End::Fault)), 250));
}

#[test]
fn a_fault_ends_the_flight_where_nobody_can_send_fly_or_it_is_an_experiment() {
    let deaf = Caller { heard: false, ..Caller::with(&[]) };
    for (mut caller, waits) in [(deaf, true), (Caller::with(&[]), false)] {
        let (outcome, ..) = fly(&mut caller, WORKS, waits);
        assert!(outcome.end == End::Fault && outcome.punctuality.cycles < 80, "{outcome:?}");
    }
}

#[test]
fn a_silent_sensor_ends_the_flight_because_only_a_new_one_starts_it_again() {
    let silent: fn(f64) -> Result<Sighting, ErrorKind> =
        |now_s| if now_s < 6.0 { Ok(Sighting::Ball(Millimetres(250.0))) } else { Ok(Sighting::NotReady) };
    let (outcome, ..) = flown(&mut Caller::with(&[]), silent, WORKS, true);
    assert!(matches!(outcome.fault, Some(Fault::SensorSilent { .. })), "{:?}", outcome.fault);
    assert!(outcome.punctuality.cycles < 80, "{outcome:?}");
}

#[test]
fn a_fan_that_cannot_be_turned_off_ends_a_flight_that_would_wait() {
    let breaks: fn(f64) -> Result<(), ErrorKind> = |now_s| if now_s < 8.0 { WORKS(now_s) } else { Err(ErrorKind::Bus) };
    let (outcome, ..) = fly(&mut Caller::with(&[]), breaks, true);
    assert_eq!(outcome.fault, Some(Fault::FanBus { kind: ErrorKind::Bus }));
    assert!(outcome.fan_still_on.is_some() && outcome.punctuality.cycles < 170, "{outcome:?}");
}

#[test]
fn a_gain_far_above_the_critical_one_and_back_again_keeps_the_flight_and_the_ball() {
    let mut tables: Tables = toml::from_str(include_str!("../../../../../config.toml")).unwrap();
    let programme = Experiment::of_reference(tables.reference.as_ref().unwrap());
    let kp = |kp_per_mm| Command::Gains(GainChange { kp_per_mm: Some(kp_per_mm), ..GainChange::default() });
    let own = tables.controller.as_ref().unwrap().pid.unwrap().kp_per_mm;
    for seed in 1..=4 {
        let calls = [(0.1, Command::Setpoint(300.0)), (8.0, kp(0.2)), (14.0 + 0.1 * seed as f64, kp(own))];
        let mut caller = Caller::with(&calls);
        let pilot = Pilot::new(Orders::of(&tables, programme.clone()).unwrap());
        let rig = tables.rig.as_mut().unwrap();
        let mut rig = simulated_in_virtual_time(tables.plant.as_ref().unwrap(), rig, seed).unwrap();
        let (mut memory, table) = (Memory::default(), tables.r#loop.unwrap());
        let flight = Flight::new(&mut rig, pilot, &table, &mut memory, Some(&mut caller));
        let outcome = flight.fly(40.0, &AtomicBool::new(false));
        assert_eq!((outcome.end, outcome.fault), (End::Finished, None), "seed {seed}");
        let saturated = caller.states.iter().filter(|s| (8.0..14.0).contains(&s.cycle.time_s)).any(|s| {
            let duty = s.cycle.duty_percent;
            let safety = tables.safety.unwrap();
            duty <= safety.duty_min_percent + 0.1 || duty >= safety.duty_max_percent - 0.1
        });
        assert!(saturated, "seed {seed}: the gain was not too large");
        let end = caller.states.iter().filter(|state| state.cycle.time_s > 34.0);
        let worst = end.filter_map(|state| state.cycle.position_mm).fold(0.0, |w: f64, mm| w.max((mm - 300.0).abs()));
        assert!(worst < 60.0, "seed {seed}: {worst} mm from the setpoint 20 s later");
    }
}
