//! A bus that answers wrong now and then, or always: both drivers say what is wrong, or work, and never panic or wait
//! for ever.
#![no_main]

use control::Duty;
use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use hal::emulator::{EmulatedBus, EmulatedI2c, World};
use hal::{Clock, Fan, RangeSensor, fan_off, stop_fan};
use libfuzzer_sys::fuzz_target;

/// Seconds that a start may take.
const ALLOWED_S: f64 = 0.2;

/// A still ball, and time as the wire and those who sleep take it.
#[derive(Default)]
struct Desk(f64);

impl World for Desk {
    fn now_s(&self) -> f64 {
        self.0
    }
    fn elapse_s(&mut self, seconds: f64) {
        self.0 += seconds;
    }
    fn measure_mm(&mut self, _: f64) -> Option<f64> {
        Some(280.0)
    }
    fn pwm(&mut self, _: f64) {}
}

#[derive(Clone)]
struct Time(EmulatedBus<Desk>);

impl Clock for Time {
    fn now_s(&self) -> f64 {
        self.0.with_world(|desk| desk.0)
    }
    fn sleep_until_s(&self, t_s: f64) {
        self.0.with_world(|desk| desk.0 = desk.0.max(t_s));
    }
}

/// The emulated chips behind wires that follow a script: so many transactions right, then one wrong.
struct Wires<'a> {
    chips: EmulatedI2c<Desk>,
    script: &'a [u8],
    right: u8,
}

impl<'a> Wires<'a> {
    fn new(chips: EmulatedI2c<Desk>, script: &'a [u8]) -> Self {
        let (right, script) = script.split_first().map_or((u8::MAX, script), |(right, rest)| (*right, rest));
        Self { chips, script, right }
    }
}

impl ErrorType for Wires<'_> {
    type Error = ErrorKind;
}

impl I2c for Wires<'_> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let [answer, right, rest @ ..] = self.script else { return self.chips.transaction(address, operations) };
        if let Some(left) = self.right.checked_sub(1) {
            self.right = left;
            return self.chips.transaction(address, operations);
        }
        (self.script, self.right) = (rest, *right);
        match answer {
            0xA5 => return Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data)),
            // What is written arrives, or does not.
            answer if answer % 2 == 0 => self.chips.transaction(address, operations)?,
            _ => {}
        }
        for operation in operations {
            if let Operation::Read(bytes) = operation {
                bytes.iter_mut().for_each(|byte| *byte ^= answer);
            }
        }
        Ok(())
    }
}

fuzz_target!(|script: &[u8]| {
    let bus = EmulatedBus::new(Desk::default());
    let (time, wires) = (Time(bus.clone()), || Wires::new(bus.handle(), script));
    if let Ok(mut sensor) = RangeSensor::start(wires(), time.clone(), ALLOWED_S) {
        for _ in 0..20 {
            let _ = sensor.poll();
        }
        let _ = sensor.wait(ALLOWED_S);
    }
    if let Ok(mut fan) = Fan::start(wires(), 1526.0) {
        for percent in [0.0, 21.4, 100.0, f64::NAN] {
            if let Ok(held) = fan.drive(Duty::clamped(percent)) {
                assert!((held.percent() - Duty::clamped(percent).percent()).abs() < 0.02, "{held:?}");
            }
        }
        let _ = fan.off();
    }
    let _ = (fan_off(wires()), stop_fan(wires()));
    assert!(time.now_s() < 5.0, "{} s", time.now_s());
});
