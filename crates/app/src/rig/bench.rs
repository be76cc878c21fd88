//! The bench: the bus of a Raspberry Pi, or the one that `airball emulate` serves in its place.

use super::chips::{Chips, StartError, Wiring};
use super::clock::Monotonic;
use super::lines::{Lines, output_enable};
use super::wire::{Wire, WireError};
use crate::config;
use hal::{Clock, FanError, stop_fan};
use std::fmt;
use std::fs::{File, TryLockError};
use std::str::FromStr;

/// Between two attempts to turn the fan off.
const RETRY_S: f64 = 0.02;

/// The line of output-enable, in one word of a command line: `CHIP:LINE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnableLine {
    chip: String,
    line: u32,
}

impl EnableLine {
    /// The line that a rig's table names.
    #[must_use]
    pub fn of(rig: &config::Rig) -> Option<Self> {
        rig.output_enable.map(|pin| Self { chip: rig.gpio_chip.clone(), line: pin.line })
    }
}

impl fmt::Display for EnableLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.chip, self.line)
    }
}

impl FromStr for EnableLine {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let both = word.rsplit_once(':').and_then(|(chip, line)| Some((chip.to_owned(), line.parse().ok()?)));
        let (chip, line) = both.ok_or_else(|| format!("{word} is no CHIP:LINE, for instance /dev/gpiochip0:17"))?;
        Ok(Self { chip, line })
    }
}

/// Why the bench does not start, or does not stop.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The bus cannot be opened.
    #[error(
        "cannot open the I2C bus {device}: {source}; on a Raspberry Pi switch I2C on with `raspi-config` (or \
         dtparam=i2c_arm=on) and join the group i2c, or name another bus in [bus] device; \
         without a rig, fly the simulated one with `--sim`"
    )]
    Open {
        /// The device file.
        device: String,
        /// What the system said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Somebody else flies this rig.
    #[error(
        "the I2C bus {device} is taken by another program that flies this rig, or by the guard of a flight that was \
         killed; end that flight first"
    )]
    Taken {
        /// The device file.
        device: String,
    },
    /// A GPIO line cannot be taken.
    #[error(
        "cannot take line {line} of {chip} for [{table}]: {source}; see with `gpioinfo` which lines there are and who holds \
         them, join the group gpio, name another chip in [rig] gpio_chip, or delete the table"
    )]
    Line {
        /// The chip's device file.
        chip: String,
        /// The line.
        line: u32,
        /// The table that asks for it.
        table: &'static str,
        /// What the system said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A chip does not start.
    #[error("bus {device}: {source}")]
    Start {
        /// The device file.
        device: String,
        /// Which chip and why.
        source: Box<StartError<WireError, WireError>>,
    },
    /// The fan does not stop.
    #[error("the fan could not be turned off in {tries} attempts: bus {device}: {source}; switch off its supply now")]
    StaysOn {
        /// The device file.
        device: String,
        /// How often it was tried.
        tries: u32,
        /// What the last attempt met.
        source: FanError<WireError>,
    },
}

/// Claims the bus for one flight: a second one would drive the same fan. A copy of the file holds the claim, too.
///
/// # Errors
/// [`BenchError`]: the device file is missing, or taken.
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

/// Opens the bus, a handle for each chip, and the lines beside it, and starts the chips.
///
/// # Errors
/// [`BenchError`] names the device file and what to do.
pub fn bench(bus: &config::Bus, rig: &config::Rig) -> Result<Chips<Wire, Wire, Monotonic>, BenchError> {
    let clock = Monotonic::start();
    let lines = Lines::of_bench(bus, rig, clock)?;
    let second = rig.second_sensor.map(|_| open(bus)).transpose()?;
    let wiring = Wiring { sensor: open(bus)?, second, fan: open(bus)?, lines };
    Chips::start(wiring, clock, rig)
        .map_err(|source| BenchError::Start { device: bus.device.clone(), source: Box::new(source) })
}

/// Turns the fan off and reads back that it is, again and again for `allowed_s` seconds if need be: a bus that is stuck
/// may come free, a supply return. Where there is a line of output-enable and nobody else holds it, the outputs are off meanwhile.
///
/// # Errors
/// [`BenchError`] of the last attempt.
pub fn turn_off(bus: &config::Bus, enable: Option<&EnableLine>, allowed_s: f64) -> Result<(), BenchError> {
    let clock = Monotonic::start();
    let mut outputs = None;
    for tries in 1.. {
        // A loop that hangs holds the line; the bus works all the same.
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
