//! The real drivers against the emulated chips, in virtual time.

mod fan;
mod faults;
mod lines;
mod range_sensor;
mod second_sensor;

use crate::clock::Clock;
use crate::emulator::{EmulatedBus, EmulatedI2c, World};
use crate::range_sensor::{RangeError, RangeSensor};
use embedded_hal::i2c::ErrorKind;

pub(crate) const SENSOR: u8 = 0x29;
pub(crate) const PWM: u8 = 0x40;
pub(crate) const START_S: f64 = 1.0;

/// A clock that moves only when the bus or a sleep moves it, a ball on a known path, and notes of what was asked.
#[derive(Default)]
pub(crate) struct Bench {
    now_s: f64,
    /// When the sensor measured.
    pub(crate) measured_s: Vec<f64>,
    /// When the second sensor did, where there is one.
    pub(crate) second_measured_s: Vec<f64>,
    /// No ball in the pipe.
    pub(crate) empty: bool,
    /// What the fan was given, in order.
    pub(crate) pwm: Vec<f64>,
}

/// How much further the second sensor is from the ball than the first.
pub(crate) const SECOND_FURTHER_MM: f64 = 60.0;

/// Distance of the test ball from the sensor: 400 mm, swinging by 100 mm at 1 Hz.
pub(crate) fn ball_mm(at_s: f64) -> f64 {
    400.0 + 100.0 * (std::f64::consts::TAU * at_s).sin()
}

impl World for Bench {
    fn now_s(&self) -> f64 {
        self.now_s
    }

    fn elapse_s(&mut self, seconds: f64) {
        self.now_s += seconds;
    }

    fn measure_mm(&mut self, at_s: f64) -> Option<f64> {
        assert!(at_s <= self.now_s, "asked about {at_s} s at {} s", self.now_s);
        assert!(self.measured_s.last() < Some(&at_s), "asked about {at_s} s again or out of order");
        self.measured_s.push(at_s);
        (!self.empty).then(|| ball_mm(at_s))
    }

    fn measure_second_mm(&mut self, at_s: f64) -> Option<f64> {
        assert!(at_s <= self.now_s && self.measured_s.last().is_none_or(|last_s| *last_s <= at_s), "{at_s} s");
        self.second_measured_s.push(at_s);
        Some(SECOND_FURTHER_MM + ball_mm(at_s))
    }

    fn pwm(&mut self, fraction: f64) {
        self.pwm.push(fraction);
    }
}

pub(crate) type Bus = EmulatedBus<Bench>;

/// The clock of the virtual bench.
#[derive(Clone)]
pub(crate) struct BenchClock(Bus);

impl Clock for BenchClock {
    fn now_s(&self) -> f64 {
        self.0.with_world(|world| world.now_s)
    }

    fn sleep_until_s(&self, t_s: f64) {
        self.0.with_world(|world| world.now_s = world.now_s.max(t_s));
    }
}

pub(crate) fn bench() -> (Bus, BenchClock) {
    let bus = Bus::new(Bench::default());
    (bus.clone(), BenchClock(bus))
}

pub(crate) type Sensor = RangeSensor<EmulatedI2c<Bench>, BenchClock>;

pub(crate) fn start_sensor(bus: &Bus, allowed_s: f64) -> Result<Sensor, RangeError<ErrorKind>> {
    RangeSensor::start(bus.handle(), BenchClock(bus.clone()), allowed_s)
}
