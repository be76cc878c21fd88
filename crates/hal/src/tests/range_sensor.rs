//! Readings of a working sensor, and errors of a faulty one.

use control::Millimetres;
use embedded_hal::i2c::{ErrorKind, I2c, NoAcknowledgeSource};
use vl53l0x::VL53L0x;

use super::{SENSOR, START_S, Sensor, ball_mm, bench, start_sensor};
use crate::clock::Clock;
use crate::emulator::Fault;
use crate::range_sensor::{Range, RangeError};
use crate::range_status::RangeStatus;

const VALID: RangeStatus = RangeStatus::of_register(11 << 3);

/// The sensor, or the error it did not start with.
fn error<T>(result: Result<T, RangeError<ErrorKind>>) -> RangeError<ErrorKind> {
    result.err().expect("this must fail")
}

#[test]
fn every_reading_is_where_the_ball_was_in_whole_millimetres_fifty_times_per_second() {
    let (bus, clock) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    let start_s = clock.now_s();
    let readings: Vec<_> = (0..50).map(|_| sensor.wait(0.1).unwrap()).collect();
    let measured_s = bus.with_world(|world| world.measured_s.clone());
    let expected: Vec<_> = measured_s.iter().map(|&t_s| Range::Distance(Millimetres(ball_mm(t_s).round()))).collect();
    assert_eq!(readings, expected);
    let elapsed_s = clock.now_s() - start_s;
    assert!((0.99..1.01).contains(&elapsed_s), "50 readings took {elapsed_s} s");
}

#[test]
fn a_poll_before_the_measurement_ends_gives_nothing_and_one_after_it_gives_it_once() {
    let (bus, clock) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    assert_eq!(sensor.poll(), Ok(None));
    clock.sleep_until_s(clock.now_s() + 0.021);
    assert!(matches!(sensor.poll(), Ok(Some(Range::Distance(_)))));
    assert_eq!(sensor.poll(), Ok(None));
}

#[test]
fn a_late_poll_gets_the_latest_of_the_measurements_it_missed() {
    let (bus, clock) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    clock.sleep_until_s(clock.now_s() + 0.105);
    let reading = sensor.poll().unwrap();
    let measured_s = bus.with_world(|world| world.measured_s.clone());
    assert_eq!(measured_s.len(), 5);
    assert_eq!(reading, Some(Range::Distance(Millimetres(ball_mm(measured_s[4]).round()))));
}

#[test]
fn an_empty_pipe_is_no_target_and_not_a_distance_of_eight_metres() {
    let (bus, _) = bench();
    bus.with_world(|world| world.empty = true);
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    assert_eq!(sensor.wait(0.1), Ok(Range::NoTarget { reported_mm: 8190 }));
}

#[test]
fn codes_are_not_distances() {
    for reported_mm in [0, 8190, 8191, 65535] {
        assert_eq!(Range::reported(reported_mm, VALID), Range::NoTarget { reported_mm });
    }
    assert_eq!(Range::reported(8189, VALID), Range::Distance(Millimetres(8189.0)));
}

#[test]
fn a_distance_with_any_status_but_valid_is_doubtful_and_says_why() {
    let (bus, _) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    for code in 0..16 {
        bus.doubt(SENSOR, Some(code));
        let range = sensor.wait(0.1).unwrap();
        let at_s = bus.with_world(|world| *world.measured_s.last().unwrap());
        let mm = ball_mm(at_s).round();
        if code == 11 {
            assert_eq!(range, Range::Distance(Millimetres(mm)));
            continue;
        }
        let Range::Doubtful { status, reported_mm } = range else { panic!("status {code}: {range:?}") };
        assert_eq!((status.code(), f64::from(reported_mm)), (code, mm));
    }
    bus.doubt(SENSOR, None);
    assert!(matches!(sensor.wait(0.1), Ok(Range::Distance(_))));
    assert_eq!(RangeStatus::of_register(0xA7).to_string(), "4 (too little light came back)");
}

#[test]
fn a_reading_and_its_status_come_in_one_transaction() {
    let (bus, clock) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    clock.sleep_until_s(clock.now_s() + 0.021);
    let (before, from_s) = (bus.transactions(SENSOR), clock.now_s());
    assert!(matches!(sensor.poll(), Ok(Some(Range::Distance(_)))));
    // Ready, the burst, and the interrupt cleared.
    assert_eq!(bus.transactions(SENSOR) - before, 3);
    let took_s = clock.now_s() - from_s;
    assert!((took_s - (39.0 + 138.0 + 48.0) / 400_000.0).abs() < 1e-9, "{took_s} s");
}

#[test]
fn a_bus_that_is_stuck_high_is_no_target() {
    let (bus, _) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    bus.inject(SENSOR, Fault::StuckHigh, 0..u64::MAX);
    assert_eq!(sensor.poll(), Ok(Some(Range::NoTarget { reported_mm: 65535 })));
}

#[test]
fn a_silent_sensor_is_reported_after_the_timeout() {
    let (bus, clock) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    bus.inject(SENSOR, Fault::StuckLow, 0..u64::MAX);
    let start_s = clock.now_s();
    let RangeError::Silent { waited_s } = error(sensor.wait(0.06)) else { panic!("not silent") };
    assert_eq!(waited_s, clock.now_s() - start_s);
    assert!((0.06..0.061).contains(&waited_s), "waited {waited_s} s");
}

#[test]
fn a_missing_sensor_is_a_bus_error_in_start_and_in_poll() {
    let nack = RangeError::Bus { address: SENSOR, error: ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address) };
    let (bus, _) = bench();
    let mut sensor = start_sensor(&bus, START_S).unwrap();
    bus.inject(SENSOR, Fault::Nack, 0..u64::MAX);
    assert_eq!(sensor.poll(), Err(nack));
    assert_eq!(error(start_sensor(&bus, START_S)), nack);
}

#[test]
fn another_device_at_the_address_is_named_by_its_id() {
    let (bus, _) = bench();
    bus.inject(SENSOR, Fault::StuckHigh, 0..u64::MAX);
    let wrong = error(start_sensor(&bus, START_S));
    assert_eq!(wrong, RangeError::WrongDevice { address: SENSOR, found: 0xFF });
    assert_eq!(
        wrong.to_string(),
        "device 0x29 answered model id 0xff, a VL53L0X answers 0xEE; check what is wired to the bus"
    );
}

#[test]
fn a_program_killed_at_any_moment_leaves_a_sensor_that_starts_again() {
    let (bus, _) = bench();
    drop(start_sensor(&bus, START_S).unwrap());
    let of_a_start = bus.transactions(SENSOR);
    for killed_after in 0..of_a_start {
        let (bus, clock) = bench();
        bus.inject(SENSOR, Fault::Nack, killed_after..killed_after + 1);
        let _ = start_sensor(&bus, START_S);
        clock.sleep_until_s(clock.now_s() + 0.5);
        let mut sensor = start_sensor(&bus, START_S)
            .unwrap_or_else(|error| panic!("killed after {killed_after} transactions: {error}"));
        assert!(matches!(sensor.wait(0.1), Ok(Range::Distance(_))), "killed after {killed_after} transactions");
    }
}

#[test]
fn a_sensor_that_was_left_ranging_starts_again() {
    let (bus, clock) = bench();
    for _ in 0..3 {
        let mut sensor: Sensor = start_sensor(&bus, START_S).unwrap();
        assert!(matches!(sensor.wait(0.1), Ok(Range::Distance(_))));
        drop(sensor);
        clock.sleep_until_s(clock.now_s() + 0.013);
    }
}

#[test]
fn the_timing_budget_sets_the_cadence_of_the_emulated_chip() {
    for budget_ms in [20_u32, 33, 50, 100, 200] {
        let (bus, clock) = bench();
        let mut driver = VL53L0x::new(bus.handle()).unwrap();
        assert!(driver.set_measurement_timing_budget(budget_ms * 1000).unwrap());
        driver.start_continuous(0).unwrap();
        clock.sleep_until_s(clock.now_s() + 0.7);
        driver.read_range_mm().unwrap();
        let measured_s = bus.with_world(|world| world.measured_s.clone());
        let period_s = measured_s[1] - measured_s[0];
        assert!((period_s - f64::from(budget_ms) / 1000.0).abs() < 1e-9, "{budget_ms} ms gave {period_s} s");
    }
}

#[test]
fn a_transaction_takes_its_bits_on_the_wire() {
    let (bus, clock) = bench();
    bus.handle().write_read(SENSOR, &[0x13], &mut [0]).unwrap();
    // Two starts, four bytes of nine bits, one stop.
    assert_eq!(clock.now_s(), 39.0 / 400_000.0);
}
