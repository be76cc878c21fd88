//! Tests of a rig's chips when a flight ends abnormally. The fan's chip keeps its last duty: every end must write
//! another.

use super::{Chips, Rig, Sighting, WorldClock};
use control::{Duty, Millimetres};
use embedded_hal::i2c::ErrorKind;
use hal::emulator::{EmulatedBus, EmulatedI2c, Fault, World};
use std::panic::{AssertUnwindSafe, catch_unwind};

const SENSOR: u8 = 0x29;
const PIPE_MM: f64 = 583.0;

/// A ball at a constant position in a world of its own time, and a fan that is only recorded.
struct Still {
    now_s: f64,
    distance_mm: Option<f64>,
    fan: f64,
}

impl World for Still {
    fn now_s(&self) -> f64 {
        self.now_s
    }
    fn elapse_s(&mut self, seconds: f64) {
        self.now_s += seconds;
    }
    fn measure_mm(&mut self, _at_s: f64) -> Option<f64> {
        self.distance_mm
    }
    fn pwm(&mut self, fraction: f64) {
        self.fan = fraction;
    }
}

type Wired = Chips<EmulatedI2c<Still>, EmulatedI2c<Still>, WorldClock<Still>>;

fn bus(distance_mm: Option<f64>) -> EmulatedBus<Still> {
    EmulatedBus::new(Still { now_s: 0.0, distance_mm, fan: 0.0 })
}

fn start(bus: &EmulatedBus<Still>) -> Option<Wired> {
    super::start(bus, WorldClock(bus.clone()), &config::Rig { sensor_to_bottom_mm: PIPE_MM, ..rig() }).ok()
}

/// The project's rig.
fn rig() -> config::Rig {
    let tables: config::Tables = toml::from_str(include_str!("../../../config.toml")).unwrap();
    tables.rig.unwrap()
}

fn flying(bus: &EmulatedBus<Still>) -> Wired {
    let mut rig = start(bus).unwrap();
    rig.drive(Duty::clamped(25.0)).unwrap();
    assert!((fan(bus) - 0.25).abs() < 1e-3);
    rig
}

fn fan(bus: &EmulatedBus<Still>) -> f64 {
    bus.with_world(|world| world.fan)
}

#[test]
fn a_rig_that_is_dropped_leaves_the_fan_off() {
    let bus = bus(Some(283.0));
    drop(flying(&bus));
    assert_eq!(fan(&bus), 0.0);
}

#[test]
fn a_panic_in_flight_leaves_the_fan_off() {
    let bus = bus(Some(283.0));
    let rig = flying(&bus);
    let flight = catch_unwind(AssertUnwindSafe(|| {
        let _rig = rig;
        panic!("a bug in the loop");
    }));
    assert!(flight.is_err());
    assert_eq!(fan(&bus), 0.0);
}

#[test]
fn a_start_that_fails_at_the_sensor_turns_off_a_fan_that_a_killed_program_left_on() {
    let bus = bus(Some(283.0));
    std::mem::forget(flying(&bus));
    let now = bus.transactions(SENSOR);
    bus.inject(SENSOR, Fault::Nack, now..u64::MAX);
    assert!(start(&bus).is_none());
    assert_eq!(fan(&bus), 0.0);
}

#[test]
fn the_position_grows_upward_from_the_bottom_and_a_reading_is_given_once() {
    let bus = bus(Some(283.0));
    let mut rig = start(&bus).unwrap();
    rig.align().unwrap();
    assert_eq!(rig.position(), Ok(Sighting::NotReady));
    rig.sleep_until_s(rig.now_s() + 0.021);
    assert_eq!(rig.position(), Ok(Sighting::Ball(Millimetres(300.0))));
}

#[test]
fn no_target_and_a_target_beyond_the_pipe_are_no_ball() {
    for (distance_mm, reported_mm) in [(None, 8190), (Some(700.0), 700)] {
        let bus = bus(distance_mm);
        let mut rig = start(&bus).unwrap();
        rig.sleep_until_s(rig.now_s() + 0.021);
        assert_eq!(rig.position(), Ok(Sighting::NoBall { reported_mm }));
    }
}

#[test]
fn a_plausible_distance_with_a_bad_status_is_no_ball_and_one_with_a_valid_status_is() {
    let bus = bus(Some(283.0));
    let mut rig = start(&bus).unwrap();
    for (code, is_ball) in [(4, false), (11, true)] {
        bus.doubt(SENSOR, Some(code));
        rig.sleep_until_s(rig.now_s() + 0.041);
        match rig.position().unwrap() {
            Sighting::Ball(position) => assert!(is_ball && position == Millimetres(300.0), "{code}: {position:?}"),
            Sighting::Doubtful { status, reported_mm } => {
                assert_eq!((is_ball, status.code(), reported_mm), (false, code, 283));
            }
            other => panic!("{code}: {other:?}"),
        }
    }
}

#[test]
fn a_sensor_that_does_not_acknowledge_is_a_bus_error_and_the_fan_still_obeys() {
    let bus = bus(Some(283.0));
    let mut rig = flying(&bus);
    let now = bus.transactions(SENSOR);
    bus.inject(SENSOR, Fault::Nack, now..u64::MAX);
    assert!(matches!(rig.position(), Err(ErrorKind::NoAcknowledge(_))));
    assert_eq!(rig.drive(Duty::OFF), Ok(Duty::OFF));
    assert_eq!(fan(&bus), 0.0);
}
