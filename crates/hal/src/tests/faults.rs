//! A bus that fails in every way we know, from every moment on: an error, in time, and never a panic.

use super::{BenchClock, Bus, SENSOR, bench, start_sensor};
use crate::clock::Clock;
use crate::deadline::{Deadline, DeadlineError, DeadlineI2c};
use crate::emulator::Fault;
use crate::range_sensor::{Range, RangeError};
use embedded_hal::i2c::I2c;
use vl53l0x::VL53L0x;

/// Enough for a healthy start, which takes 40 ms.
const ALLOWED_S: f64 = 0.1;
/// The longest transaction of a start, or the time that a bus hangs.
const OVERSHOOT_S: f64 = 0.01;

fn faults(seed: u64) -> [Fault; 6] {
    [
        Fault::Nack,
        Fault::StuckHigh,
        Fault::StuckLow,
        Fault::Timeout { seconds: OVERSHOOT_S },
        Fault::Noise { seed },
        Fault::Flips { seed },
    ]
}

fn transactions_of_a_start() -> u64 {
    let (bus, _) = bench();
    drop(start_sensor(&bus, ALLOWED_S).unwrap());
    bus.transactions(SENSOR)
}

/// Time between the next two measurements, as the chip makes them.
fn cadence_ms(bus: &Bus, clock: &BenchClock) -> f64 {
    clock.sleep_until_s(clock.now_s() + 0.2);
    bus.handle().read(SENSOR, &mut [0]).unwrap();
    bus.with_world(|world| (world.measured_s[1] - world.measured_s[0]) * 1000.0)
}

#[test]
fn start_never_panics_and_returns_in_time_whatever_the_bus_does_from_any_moment_on() {
    for from in 0..=transactions_of_a_start() {
        for fault in faults(from) {
            for lasting in [1, 2, 7, u64::MAX - from] {
                let (bus, clock) = bench();
                bus.inject(SENSOR, fault, from..from + lasting);
                let started = start_sensor(&bus, ALLOWED_S);
                let took_s = clock.now_s();
                assert!(took_s <= ALLOWED_S + OVERSHOOT_S, "{fault:?} from {from}: {took_s} s");
                if let Ok(mut sensor) = started {
                    let _ = sensor.wait(0.03);
                }
            }
        }
    }
}

#[test]
fn one_wrong_answer_at_any_moment_never_panics_and_never_changes_the_cadence() {
    for from in 0..transactions_of_a_start() {
        for seed in 0..64 {
            for fault in [Fault::Noise { seed }, Fault::Flips { seed }] {
                let (bus, clock) = bench();
                bus.inject(SENSOR, fault, from..from + 1);
                if let Ok(_sensor) = start_sensor(&bus, ALLOWED_S) {
                    assert_eq!(cadence_ms(&bus, &clock).round(), 20.0, "{fault:?} at {from}");
                }
            }
        }
    }
}

#[test]
fn garbage_in_the_timing_registers_is_named() {
    let found = (0..transactions_of_a_start()).any(|from| {
        let (bus, _) = bench();
        bus.inject(SENSOR, Fault::StuckHigh, from..u64::MAX);
        matches!(start_sensor(&bus, ALLOWED_S), Err(RangeError::Garbage { read: 0xFF, .. }))
    });
    assert!(found);
}

#[test]
fn a_sensor_that_never_gets_ready_costs_the_time_allowed_and_not_the_drivers_65535_polls() {
    let (bus, clock) = bench();
    let ready_poll = (0..transactions_of_a_start()).any(|from| {
        let (bus, _) = bench();
        bus.inject(SENSOR, Fault::StuckLow, from..u64::MAX);
        start_sensor(&bus, ALLOWED_S).err() == Some(RangeError::Slow { allowed_s: ALLOWED_S })
    });
    assert!(ready_poll);
    bus.inject(SENSOR, Fault::StuckLow, 100..u64::MAX);
    assert!(VL53L0x::new(bus.handle()).is_err());
    assert!(clock.now_s() > 0.5, "the bare driver gave up after {} s", clock.now_s());
}

#[test]
fn a_reading_survives_a_fault_that_passes() {
    let (bus, _) = bench();
    let mut sensor = start_sensor(&bus, ALLOWED_S).unwrap();
    bus.inject(SENSOR, Fault::Timeout { seconds: OVERSHOOT_S }, 0..u64::MAX);
    assert!(sensor.wait(0.1).is_err());
    bus.repair();
    assert!(matches!(sensor.wait(0.1), Ok(Range::Distance(_))));
}

#[test]
fn nothing_is_sent_after_the_deadline_until_it_is_moved() {
    let (bus, clock) = bench();
    let deadline = Deadline::at(0.5);
    let mut i2c = DeadlineI2c::new(bus.handle(), clock.clone(), deadline.clone());
    assert!(i2c.write(SENSOR, &[0x00]).is_ok());
    clock.sleep_until_s(0.75);
    assert_eq!(i2c.write(SENSOR, &[0x00]), Err(DeadlineError::DeadlinePassed { late_s: 0.25 }));
    assert_eq!(bus.transactions(SENSOR), 1);
    deadline.move_to(1.0);
    assert!(i2c.write(SENSOR, &[0x00]).is_ok());
}

#[test]
fn a_sensor_and_its_deadline_may_move_to_another_thread() {
    fn sendable<T: Send>(_: &T) {}
    let (bus, _) = bench();
    sendable(&start_sensor(&bus, ALLOWED_S).unwrap());
}
