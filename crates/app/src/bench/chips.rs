//! The bench: the bus of a Raspberry Pi, or the one of `airball emulate`.

use super::clock::Monotonic;
use super::enable_line::EnableLine;
use super::error::BenchError;
use super::lines::{lines, output_enable};
use super::wire::Wire;
use hal::{Clock, stop_fan};
use rig::{Chips, Wiring};
use std::fs::{File, TryLockError};

/// Time between two attempts to turn the fan off.
const RETRY_S: f64 = 0.02;

/// Locks the bus for one flight: a second one would drive the same fan. A copy of the file holds the lock, too.
///
/// # Errors
/// [`BenchError`]: the device file is missing, or locked.
pub fn claim(bus: &config::Bus) -> Result<File, BenchError> {
    let device = bus.device.clone();
    let mut options = File::options();
    options.read(true).write(true);
    // A socket cannot be locked; a file beside it can.
    let file = match bus.socket() {
        Some(path) => options.create(true).truncate(false).open(format!("{path}.lock")),
        None => options.open(&device),
    };
    let file = file.map_err(|source| BenchError::Open { device: device.clone(), source: Box::new(source) })?;
    // Held until the last copy is closed.
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(BenchError::Taken { device }),
        Err(TryLockError::Error(source)) => Err(BenchError::Open { device, source: Box::new(source) }),
    }
}

/// Opens the bus, with a handle for each chip, and the GPIO lines, and starts the chips.
///
/// # Errors
/// [`BenchError`] names the device file and the next step.
pub fn bench(bus: &config::Bus, rig: &config::Rig) -> Result<Chips<Wire, Wire, Monotonic>, BenchError> {
    let clock = Monotonic::start();
    let lines = lines(bus, rig, clock)?;
    let second = rig.second_sensor.map(|_| open(bus)).transpose()?;
    let wiring = Wiring { sensor: open(bus)?, second, fan: open(bus)?, lines };
    Chips::start(wiring, clock, rig)
        .map_err(|source| BenchError::Start { device: bus.device.clone(), source: Box::new(source) })
}

/// Turns the fan off and reads back that it is, repeatedly for up to `allowed_s` seconds: a stuck bus may recover, and
/// a supply may return. Where there is a line of output-enable that no other process holds, the outputs are off
/// meanwhile.
///
/// # Errors
/// [`BenchError`] of the last attempt.
pub fn turn_off(bus: &config::Bus, enable: Option<&EnableLine>, allowed_s: f64) -> Result<(), BenchError> {
    let clock = Monotonic::start();
    let mut outputs = None;
    for tries in 1.. {
        // A hanging loop holds the line; the bus still works.
        outputs = outputs.or_else(|| enable.and_then(|enable| output_enable(bus, &enable.chip, enable.line).ok()));
        let stopped = open(bus).and_then(|wire| {
            let stays_on = |source| BenchError::StaysOn { device: bus.device.clone(), tries, source };
            stop_fan(wire).map_err(stays_on)
        });
        if stopped.is_ok() || clock.now_s() >= allowed_s {
            return stopped;
        }
        clock.sleep_until_s(clock.now_s() + RETRY_S);
    }
    Ok(())
}

fn open(bus: &config::Bus) -> Result<Wire, BenchError> {
    Wire::open(bus).map_err(|source| BenchError::Open { device: bus.device.clone(), source })
}
