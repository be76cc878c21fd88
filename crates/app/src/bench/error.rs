//! Why the bench does not start, or does not stop.

use super::wire::WireError;
use hal::FanError;
use rig::StartError;

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
        /// What the system reported.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Another process flies this rig.
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
        /// The table that needs it.
        table: &'static str,
        /// What the system reported.
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
        /// Number of attempts.
        tries: u32,
        /// The error of the last attempt.
        source: FanError<WireError>,
    },
}
