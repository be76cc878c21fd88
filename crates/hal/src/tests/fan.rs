//! What the output of channel 0 does, and when.

use control::Duty;
use embedded_hal::i2c::{ErrorKind, I2c, NoAcknowledgeSource};
use pwm_pca9685::Pca9685;

use super::{Bus, PWM, bench};
use crate::emulator::{EmulatedI2c, Fault};
use crate::fan::{Fan, FanError, fan_off};

const ASKED_HZ: f64 = 1600.0;

fn start(bus: &Bus) -> Fan<EmulatedI2c<super::Bench>> {
    Fan::start(bus.handle(), ASKED_HZ).unwrap()
}

fn registers<const N: usize>(bus: &Bus, first: u8) -> [u8; N] {
    let mut bytes = [0; N];
    bus.handle().write_read(PWM, &[first], &mut bytes).unwrap();
    bytes
}

/// What the fan was given since the last call.
fn pwm(bus: &Bus) -> Vec<f64> {
    bus.with_world(|world| std::mem::take(&mut world.pwm))
}

/// The chip as a program leaves it that was killed with the fan at `duty`.
fn left_running(frequency_hz: f64, duty: f64) -> Bus {
    let (bus, _) = bench();
    Fan::start(bus.handle(), frequency_hz).unwrap().drive(Duty::clamped(duty)).unwrap();
    pwm(&bus);
    bus
}

#[test]
fn half_duty_writes_count_2048_in_one_transaction_and_reads_it_back_in_another() {
    let (bus, _) = bench();
    let mut fan = start(&bus);
    let before = bus.transactions(PWM);
    assert_eq!(fan.drive(Duty::clamped(50.0)).unwrap().percent(), 50.0);
    assert_eq!(bus.transactions(PWM) - before, 2);
    assert_eq!(registers(&bus, 0x06), [0x00, 0x00, 0x00, 0x08]);
    assert_eq!(pwm(&bus), [0.5]);
}

#[test]
fn full_then_half_then_off_each_take_effect_at_once_and_leave_nothing_behind() {
    let (bus, _) = bench();
    let mut fan = start(&bus);
    for percent in [100.0, 50.0, 0.0, 100.0] {
        fan.drive(Duty::clamped(percent)).unwrap();
    }
    fan.off().unwrap();
    fan.drive(Duty::clamped(25.0)).unwrap();
    assert_eq!(pwm(&bus), [1.0, 0.5, 0.0, 1.0, 0.0, 0.25]);
}

#[test]
fn the_duty_that_is_held_is_within_half_a_count_of_the_duty_asked() {
    let (bus, _) = bench();
    let mut fan = start(&bus);
    for step in 0..=1000 {
        let asked = Duty::clamped(f64::from(step) * 0.1);
        let held = fan.drive(asked).unwrap().percent();
        assert!((held - asked.percent()).abs() <= 100.0 / 4096.0 / 2.0 + 1e-12, "{asked:?} gave {held} %");
        let output = pwm(&bus).last().copied().unwrap_or(0.0) * 100.0;
        assert_eq!(output, held, "{asked:?}");
    }
}

#[test]
fn the_frequency_stops_at_the_limits_of_the_chip() {
    for (asked_hz, prescale, in_force_hz) in
        [(ASKED_HZ, 3, 1526.0), (200.0, 30, 197.0), (1.0, 255, 24.0), (0.0, 255, 24.0), (f64::NAN, 3, 1526.0)]
    {
        let (bus, _) = bench();
        let fan = Fan::start(bus.handle(), asked_hz).unwrap();
        assert_eq!(fan.frequency_hz().round(), in_force_hz, "asked for {asked_hz} Hz");
        assert_eq!(registers(&bus, 0xFE), [prescale], "asked for {asked_hz} Hz");
    }
}

#[test]
fn a_warm_start_stops_the_fan_first_and_sets_the_frequency() {
    for duty in [30.0, 100.0] {
        let bus = left_running(60.0, duty);
        let mut fan = start(&bus);
        assert_eq!(pwm(&bus), [0.0], "left at {duty} %");
        assert_eq!(registers(&bus, 0xFE), [3]);
        fan.drive(Duty::clamped(50.0)).unwrap();
        assert_eq!(pwm(&bus), [0.5]);
    }
}

#[test]
fn a_chip_that_is_awake_ignores_the_prescale_as_the_driver_alone_would_write_it() {
    let bus = left_running(60.0, 30.0);
    let before: [u8; 1] = registers(&bus, 0xFE);
    Pca9685::new(bus.handle(), PWM).unwrap().set_prescale(3).unwrap();
    assert_eq!(registers(&bus, 0xFE), before);
}

#[test]
fn starting_never_raises_the_output_wherever_it_breaks_off() {
    let bus = left_running(60.0, 80.0);
    let before = bus.transactions(PWM);
    drop(start(&bus));
    let of_a_start = bus.transactions(PWM) - before;
    for broken in 0..of_a_start {
        let bus = left_running(60.0, 80.0);
        let from = bus.transactions(PWM) + broken;
        bus.inject(PWM, Fault::Nack, from..u64::MAX);
        assert!(Fan::start(bus.handle(), ASKED_HZ).is_err());
        let expected: &[f64] = if broken == 0 { &[] } else { &[0.0] };
        assert_eq!(pwm(&bus), expected, "broken off after {broken} transactions");
    }
}

#[test]
fn a_prescale_that_does_not_read_back_is_an_error() {
    let (bus, _) = bench();
    bus.inject(PWM, Fault::StuckLow, 0..u64::MAX);
    let error = Fan::start(bus.handle(), ASKED_HZ).err();
    assert_eq!(error, Some(FanError::PrescaleIgnored { asked: 3, found: 0 }));
}

#[test]
fn a_missing_chip_is_a_bus_error() {
    let (bus, _) = bench();
    let mut fan = start(&bus);
    bus.inject(PWM, Fault::Nack, 0..u64::MAX);
    let nack = FanError::Bus(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
    assert_eq!(fan.drive(Duty::FULL), Err(nack));
    assert_eq!(fan.off(), Err(nack));
}

#[test]
fn the_crash_path_stops_the_fan_in_one_transaction_from_any_duty() {
    for duty in [30.0, 100.0] {
        let bus = left_running(ASKED_HZ, duty);
        let before = bus.transactions(PWM);
        fan_off(bus.handle()).unwrap();
        assert_eq!(bus.transactions(PWM) - before, 1);
        assert_eq!(pwm(&bus), [0.0], "from {duty} %");
    }
}

#[test]
fn the_crash_path_does_not_need_auto_increment() {
    let bus = left_running(ASKED_HZ, 30.0);
    bus.handle().write(PWM, &[0x00, 0x01]).unwrap();
    fan_off(bus.handle()).unwrap();
    assert_eq!(pwm(&bus), [0.0]);
}

#[test]
fn a_duty_that_does_not_arrive_is_found_at_once() {
    for fault in [Fault::StuckLow, Fault::StuckHigh] {
        let (bus, _) = bench();
        let mut fan = start(&bus);
        fan.drive(Duty::clamped(30.0)).unwrap();
        let now = bus.transactions(PWM);
        bus.inject(PWM, fault, now..u64::MAX);
        assert!(matches!(fan.drive(Duty::clamped(20.0)), Err(FanError::DutyIgnored { .. })), "{fault:?}");
        assert!(matches!(fan.off(), Err(FanError::OffIgnored { .. })), "{fault:?}");
        bus.repair();
        fan.off().unwrap();
        assert_eq!(pwm(&bus).last(), Some(&0.0), "{fault:?}");
    }
}

#[test]
fn a_chip_that_lost_its_power_for_a_moment_is_found_and_its_fan_counts_as_off() {
    let (bus, _) = bench();
    let mut fan = start(&bus);
    fan.drive(Duty::clamped(30.0)).unwrap();
    // As after power-on: asleep, no auto-increment, channel 0 full off.
    bus.handle().write(PWM, &[0x00, 0x11]).unwrap();
    assert!(matches!(fan.drive(Duty::clamped(20.0)), Err(FanError::DutyIgnored { .. })));
    assert_eq!(fan.off(), Ok(()));
    assert_eq!(pwm(&bus).last(), Some(&0.0));
}
