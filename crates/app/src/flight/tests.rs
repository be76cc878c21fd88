//! Tests of a flight.

mod commanded;

use super::command::Command;
use super::pilot::tests::pilot_holding;
use super::vocabulary::{Cycle, End, Event, Fault, Mode, What};
use super::{COMMANDS_PER_CYCLE, Flight, Outcome};
use crate::flight::outside::Commander;
use crate::flight::outside::Recorder;
use crate::log::writer::LogWriter;
use config::Loop;
use control::{Duty, Millimetres};
use embedded_hal::i2c::ErrorKind;
use rig::{Rig, Sighting, simulated_in_virtual_time};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

/// A rig without physics: its answers are fixed before the flight.
struct Script {
    now_s: Cell<f64>,
    position: fn(f64) -> Result<Sighting, ErrorKind>,
    drive: fn(f64) -> Result<(), ErrorKind>,
    duty: Duty,
}

impl Rig for Script {
    fn now_s(&self) -> f64 {
        self.now_s.get()
    }
    fn sleep_until_s(&self, t_s: f64) {
        self.now_s.set(self.now_s.get().max(t_s));
    }
    fn align(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
    fn position(&mut self) -> Result<Sighting, ErrorKind> {
        (self.position)(self.now_s.get())
    }
    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind> {
        (self.drive)(self.now_s.get())?;
        self.duty = duty;
        Ok(duty)
    }
}

#[derive(Default)]
struct Memory {
    cycles: Vec<Cycle>,
    events: Vec<What>,
}

impl Recorder for Memory {
    fn cycle(&mut self, cycle: &Cycle) {
        self.cycles.push(*cycle);
    }
    fn event(&mut self, event: &Event) {
        self.events.push(event.what);
    }
    fn dropped(&self) -> u64 {
        0
    }
}

const HERE: fn(f64) -> Result<Sighting, ErrorKind> = |_| Ok(Sighting::Ball(Millimetres(250.0)));
const WORKS: fn(f64) -> Result<(), ErrorKind> = |_| Ok(());

fn fly(
    position: fn(f64) -> Result<Sighting, ErrorKind>,
    drive: fn(f64) -> Result<(), ErrorKind>,
    stop: &AtomicBool,
) -> (Outcome, Memory, Duty) {
    let mut rig = Script { now_s: Cell::new(5.0), position, drive, duty: Duty::OFF };
    let mut memory = Memory::default();
    let table = Loop { period_s: 0.02, late_after_s: 0.002 };
    let outcome = Flight::new(&mut rig, pilot_holding(300.0, 60.0), &table, &mut memory, None).fly(2.0, stop);
    (outcome, memory, rig.duty)
}

#[test]
fn a_flight_runs_its_cycles_and_ends_with_the_fan_off() {
    let (outcome, memory, duty) = fly(HERE, WORKS, &AtomicBool::new(false));
    assert_eq!((outcome.end, outcome.punctuality.cycles, duty), (End::Finished, 100, Duty::OFF));
    assert_eq!(memory.cycles.len(), 100);
    assert!(memory.cycles.iter().all(|cycle| cycle.duty_percent > 21.4 && cycle.fresh));
    let begin = What::Mode { from: Mode::Waiting, to: Mode::Flying };
    assert_eq!(memory.events, [begin, What::End(End::Finished)]);
}

#[test]
fn a_signal_ends_the_flight_with_the_fan_off() {
    static STOP: AtomicBool = AtomicBool::new(false);
    let until_one_second: fn(f64) -> Result<Sighting, ErrorKind> = |now_s| {
        STOP.store(now_s > 6.0, Ordering::Relaxed);
        HERE(now_s)
    };
    let (outcome, _, duty) = fly(until_one_second, WORKS, &STOP);
    assert_eq!((outcome.end, duty), (End::Signal, Duty::OFF));
    assert!(outcome.punctuality.cycles < 55);
}

#[test]
fn a_dead_sensor_is_noted_once_and_ends_the_flight_with_the_fan_off() {
    let dies: fn(f64) -> Result<Sighting, ErrorKind> =
        |now_s| if now_s < 6.0 { HERE(now_s) } else { Err(ErrorKind::Bus) };
    let (outcome, memory, duty) = fly(dies, WORKS, &AtomicBool::new(false));
    assert_eq!((outcome.end, duty), (End::Fault, Duty::OFF));
    assert_eq!(outcome.fault, Some(Fault::SensorBus { kind: ErrorKind::Bus }));
    let noted = memory.events.iter().filter(|what| matches!(what, What::Fault(_))).count();
    assert_eq!(noted, 1, "{:?}", memory.events);
}

#[test]
fn a_fan_that_cannot_be_written_ends_the_flight_and_is_reported() {
    let sticks: fn(f64) -> Result<(), ErrorKind> =
        |now_s| if now_s < 6.0 { Ok(()) } else { Err(ErrorKind::ArbitrationLoss) };
    let (outcome, memory, _) = fly(HERE, sticks, &AtomicBool::new(false));
    assert_eq!(outcome.end, End::Fault);
    assert_eq!(outcome.fan_still_on, Some(ErrorKind::ArbitrationLoss));
    // The log has the duty in the chip, not the commanded one that failed.
    let held: Vec<f64> = memory.cycles.iter().rev().take(5).map(|cycle| cycle.duty_percent).collect();
    assert!(held.iter().all(|duty| *duty == held[0]), "{held:?}");
    assert!(memory.cycles.last().unwrap().commanded_duty_percent > held[0]);
}

#[test]
fn a_short_hiccup_of_the_fan_is_survived() {
    let hiccup: fn(f64) -> Result<(), ErrorKind> =
        |now_s| if (6.0..6.05).contains(&now_s) { Err(ErrorKind::Bus) } else { Ok(()) };
    let (outcome, _, _) = fly(HERE, hiccup, &AtomicBool::new(false));
    assert_eq!((outcome.end, outcome.fan_still_on), (End::Finished, None));
}

/// A rig that hangs once, a second into the flight: before a cycle or in the reading of its sensor.
struct Hangs {
    rig: Script,
    in_reading: bool,
    driven_after: bool,
}

impl Rig for Hangs {
    fn now_s(&self) -> f64 {
        self.rig.now_s()
    }
    fn sleep_until_s(&self, t_s: f64) {
        let late_s = if !self.in_reading && (6.0..6.02).contains(&t_s) { 0.6 } else { 0.0 };
        self.rig.sleep_until_s(t_s + late_s);
    }
    fn align(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
    fn position(&mut self) -> Result<Sighting, ErrorKind> {
        if self.in_reading && (6.0..6.02).contains(&self.now_s()) {
            self.rig.sleep_until_s(self.now_s() + 0.6);
        }
        self.rig.position()
    }
    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind> {
        self.driven_after |= self.now_s() > 6.5 && duty != Duty::OFF;
        self.rig.drive(duty)
    }
}

#[test]
fn a_cycle_that_hangs_before_or_in_its_reading_ends_the_flight_with_the_fan_off_before_another_duty_is_written() {
    for in_reading in [false, true] {
        let rig = Script { now_s: Cell::new(5.0), position: HERE, drive: WORKS, duty: Duty::OFF };
        let (mut memory, table) = (Memory::default(), Loop { period_s: 0.02, late_after_s: 0.002 });
        let mut hangs = Hangs { rig, in_reading, driven_after: false };
        let flight = Flight::new(&mut hangs, pilot_holding(300.0, 60.0), &table, &mut memory, None);
        let outcome = flight.fly(5.0, &AtomicBool::new(false));
        let late = matches!(outcome.fault, Some(Fault::Late { behind_s }) if (0.5..0.7).contains(&behind_s));
        assert!(late, "{in_reading}: {outcome:?}");
        assert_eq!((hangs.rig.duty, hangs.driven_after), (Duty::OFF, false), "{in_reading}");
        assert!(memory.events.iter().any(|what| matches!(what, What::Fault(Fault::Late { .. }))));
    }
}

#[test]
fn the_pulse_counts_the_cycles() {
    let pulse = std::sync::atomic::AtomicU32::new(0);
    let mut rig = Script { now_s: Cell::new(5.0), position: HERE, drive: WORKS, duty: Duty::OFF };
    let (mut memory, table) = (Memory::default(), Loop { period_s: 0.02, late_after_s: 0.002 });
    let flight = Flight::new(&mut rig, pilot_holding(300.0, 60.0), &table, &mut memory, None);
    let outcome = flight.with_pulse(&pulse).fly(2.0, &AtomicBool::new(false));
    assert_eq!(u64::from(pulse.load(Ordering::Relaxed)), outcome.punctuality.cycles);
}

#[test]
fn a_flood_of_commands_is_taken_a_few_a_cycle_and_no_cycle_is_later_for_it() {
    let mut rig = Script { now_s: Cell::new(5.0), position: HERE, drive: WORKS, duty: Duty::OFF };
    let (mut memory, table) = (Memory::default(), Loop { period_s: 0.02, late_after_s: 0.002 });
    let mut mailbox = crate::mqtt::Mailbox::holding(std::iter::repeat_n(Command::Setpoint(250.0), 60));
    let flight = Flight::new(&mut rig, pilot_holding(300.0, 60.0), &table, &mut memory, Some(&mut mailbox));
    // Ten cycles and half a period, so that rounding does not matter.
    let outcome = flight.fly(0.19, &AtomicBool::new(false));
    let taken = memory.events.iter().filter(|what| matches!(what, What::Command { .. })).count();
    assert_eq!((outcome.punctuality.cycles, taken), (10, 10 * COMMANDS_PER_CYCLE));
    assert_eq!((outcome.punctuality.late, memory.cycles.len()), (0, 10));
    assert_eq!(std::iter::from_fn(|| mailbox.try_command()).count(), 60 - taken);
}

/// Allocations of the loop's thread in a flight of `duration_s`, over chips, signals, ring, link and all controllers of
/// the config.
fn allocations(duration_s: f64) -> u64 {
    let tables = super::rich();
    let mqtt = config::mqtt::MqttConfig { port: Some(1), ..tables.mqtt.clone().unwrap() };
    let about = crate::mqtt::About { rig: "rig1".into(), ..Default::default() };
    let (_link, mut mailbox) = crate::mqtt::Link::start(
        &crate::mqtt::link::Endpoint::Broker(&mqtt),
        &about,
        None,
        &std::sync::Arc::default(),
        Box::new(crate::mqtt::owner::Nobody),
    )
    .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let writer = LogWriter::create(&folder.path().join("f.mcap"), &crate::log::tests::header()).unwrap();
    let mut queue = crate::log::queue::Queue::start(writer).unwrap();
    let mut rig = simulated_in_virtual_time(&tables.plant.unwrap(), &tables.rig.unwrap(), 1).unwrap();
    let (table, stop) = (tables.r#loop.unwrap(), AtomicBool::new(false));
    let flight = Flight::new(&mut rig, pilot_holding(300.0, 600.0), &table, &mut queue, Some(&mut mailbox));
    allocation_counter::measure(|| {
        assert_eq!(flight.fly(duration_s, &stop).end, End::Finished);
    })
    .count_total
}

#[test]
fn a_cycle_allocates_nothing() {
    assert_eq!(allocations(20.0), allocations(2.0));
}
