//! The bench: the real bus of a Raspberry Pi.

use super::chips::{Chips, StartError};
use super::clock::Monotonic;
use crate::config;
use linux_embedded_hal::I2CError;
use linux_embedded_hal::I2cdev;
use nix::fcntl::{Flock, FlockArg};
use std::fs::File;

/// Why the bench does not start.
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
    #[error("the I2C bus {device} is taken by another program that flies this rig; end that flight first")]
    Taken {
        /// The device file.
        device: String,
    },
    /// A chip does not start.
    #[error("bus {device}: {source}")]
    Start {
        /// The device file.
        device: String,
        /// Which chip and why.
        source: Box<StartError<I2CError, I2CError>>,
    },
}

/// Claims the bus for one flight: a second one would drive the same fan.
///
/// # Errors
/// [`BenchError`]: the device file is missing, or taken.
pub fn claim(bus: &config::Bus) -> Result<Flock<File>, BenchError> {
    let device = bus.device.clone();
    let file = File::options().read(true).write(true).open(&device);
    let file = file.map_err(|source| BenchError::Open { device: device.clone(), source: Box::new(source) })?;
    Flock::lock(file, FlockArg::LockExclusiveNonblock).map_err(|_| BenchError::Taken { device })
}

/// Opens the real bus, a handle for each chip: one handle for both would reopen the device file whenever the
/// address changes, twice a cycle.
///
/// # Errors
/// [`BenchError`] names the device file and what to do.
pub fn bench(bus: &config::Bus, rig: &config::Rig) -> Result<Chips<I2cdev, I2cdev, Monotonic>, BenchError> {
    let open = || {
        I2cdev::new(&bus.device)
            .map_err(|source| BenchError::Open { device: bus.device.clone(), source: Box::new(source) })
    };
    Chips::start((open()?, open()?), Monotonic::start(), rig.sensor_to_bottom_mm, rig.fan_pwm_hz)
        .map_err(|source| BenchError::Start { device: bus.device.clone(), source: Box::new(source) })
}
