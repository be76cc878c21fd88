//! The bench: the real bus of a Raspberry Pi.

use super::chips::{Chips, StartError};
use super::clock::Monotonic;
use crate::config;
use linux_embedded_hal::I2CError;
use linux_embedded_hal::I2cdev;

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
    /// A chip does not start.
    #[error("bus {device}: {source}")]
    Start {
        /// The device file.
        device: String,
        /// Which chip and why.
        source: Box<StartError<I2CError, I2CError>>,
    },
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
