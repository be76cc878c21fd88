//! Two range sensors on one bus, given different addresses at the start.

use super::{Bench, BenchClock, Bus, SECOND_FURTHER_MM, SENSOR, START_S, Sensor, ball_mm, bench};
use crate::clock::Clock;
use crate::emulator::{EmulatedLine, Fault};
use crate::range_sensor::{Range, RangeSensor};
use crate::separate::{ASIDE, SeparateError, separate};
use control::Millimetres;
use embedded_hal::i2c::{ErrorKind, I2c, NoAcknowledgeSource};

const MOVED: u8 = 0x30;

fn two() -> (Bus, BenchClock, EmulatedLine<Bench>) {
    let (bus, clock) = bench();
    let bus = bus.with_second_sensor();
    let xshut = bus.xshut();
    (bus, clock, xshut)
}

fn start_both(bus: &Bus, clock: &BenchClock, xshut: &mut EmulatedLine<Bench>) -> Option<(Sensor, Sensor)> {
    separate(bus.handle(), xshut, clock, MOVED).ok()?;
    let mut first = RangeSensor::prepare(bus.handle(), clock.clone(), START_S).ok()?;
    let mut second = RangeSensor::prepare_at(MOVED, bus.handle(), clock.clone(), START_S).ok()?;
    second.range(START_S).ok()?;
    first.range(START_S).ok()?;
    Some((first, second))
}

fn seen(further_mm: f64, at_s: f64) -> Result<Range, crate::RangeError<ErrorKind>> {
    Ok(Range::Distance(Millimetres((further_mm + ball_mm(at_s)).round())))
}

#[test]
fn each_of_two_sensors_sees_by_its_own_beam_at_about_the_same_time() {
    let (bus, clock, mut xshut) = two();
    let (mut first, mut second) = start_both(&bus, &clock, &mut xshut).unwrap();
    for _ in 0..20 {
        let (near, far) = (first.wait(0.1), second.wait(0.1));
        let (near_s, far_s) =
            bus.with_world(|world| (*world.measured_s.last().unwrap(), *world.second_measured_s.last().unwrap()));
        assert_eq!((near, far), (seen(0.0, near_s), seen(SECOND_FURTHER_MM, far_s)));
        assert!((near_s - far_s).abs() < 0.002, "{near_s} s and {far_s} s");
    }
}

#[test]
fn each_of_two_sensors_has_its_own_status() {
    let (bus, clock, mut xshut) = two();
    let (mut first, mut second) = start_both(&bus, &clock, &mut xshut).unwrap();
    bus.doubt(MOVED, Some(4));
    assert!(matches!((first.wait(0.1), second.wait(0.1)), (Ok(Range::Distance(_)), Ok(Range::Doubtful { .. }))));
    bus.doubt(MOVED, None);
    bus.doubt(SENSOR, Some(4));
    assert!(matches!((first.wait(0.1), second.wait(0.1)), (Ok(Range::Doubtful { .. }), Ok(Range::Distance(_)))));
}

#[test]
fn sensors_that_nobody_told_apart_answer_together_and_wrong() {
    let (bus, clock, _xshut) = two();
    let mut sensor = super::start_sensor(&bus, START_S).unwrap();
    clock.sleep_until_s(clock.now_s() + 0.05);
    let said = sensor.poll().unwrap().unwrap();
    let at_s = bus.with_world(|world| *world.measured_s.last().unwrap());
    assert_ne!(Ok(said), seen(0.0, at_s));
}

#[test]
fn a_program_killed_at_any_moment_leaves_sensors_that_are_told_apart_again() {
    for killed_after in 0..20 {
        let (bus, clock, mut xshut) = two();
        bus.inject(SENSOR, Fault::Nack, killed_after..u64::MAX);
        assert!(start_both(&bus, &clock, &mut xshut).is_none());
        bus.repair();
        // The kernel gives the line back.
        drop(xshut);
        let mut xshut = bus.xshut();
        assert!(start_both(&bus, &clock, &mut xshut).is_some(), "killed after {killed_after} transactions");
    }
    // Killed while the first was out of the way.
    let (bus, clock, mut xshut) = two();
    bus.handle().write(SENSOR, &[0x8A, ASIDE]).unwrap();
    assert!(start_both(&bus, &clock, &mut xshut).is_some());
}

#[test]
fn sensors_that_range_are_told_apart_again() {
    let (bus, clock, mut xshut) = two();
    for _ in 0..3 {
        let (mut first, mut second) = start_both(&bus, &clock, &mut xshut).unwrap();
        assert!(first.wait(0.1).is_ok() && second.wait(0.1).is_ok());
        clock.sleep_until_s(clock.now_s() + 0.013);
    }
}

#[test]
fn a_second_sensor_that_is_not_there_is_named_and_the_first_stays_where_it_was() {
    let (bus, clock) = bench();
    let mut nowhere = bus.xshut();
    let error = separate(bus.handle(), &mut nowhere, &clock, MOVED).unwrap_err();
    let nack = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
    assert_eq!(error, SeparateError::Bus { which: "second", from: SENSOR, to: MOVED, error: nack });
    assert!(super::start_sensor(&bus, START_S).is_ok());
}
