//! The bus that `[bus] device` names: the kernel's, or an emulated one behind a socket.

use super::socket::SocketBus;
use crate::config;
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, Operation};
use linux_embedded_hal::{I2CError, I2cdev};
use std::error;
use std::fmt;
use std::path::Path;

/// One handle of the bus. Give each chip its own: one for both would reopen the device file whenever the address
/// changes, twice a cycle.
pub enum Wire {
    /// A device file of the kernel.
    Kernel(I2cdev),
    /// The socket of `airball emulate`.
    Socket(SocketBus),
}

/// What went wrong on the bus. Its `Debug` is what the system said, without the name of the kind of bus.
pub enum WireError {
    /// On the kernel's bus.
    Kernel(I2CError),
    /// On an emulated one.
    Socket(ErrorKind),
}

impl Wire {
    /// Opens the bus.
    ///
    /// # Errors
    /// What the system said.
    pub fn open(bus: &config::Bus) -> Result<Self, Box<dyn error::Error + Send + Sync>> {
        match bus.socket() {
            Some(path) => Ok(Self::Socket(SocketBus::open(Path::new(path))?)),
            None => Ok(Self::Kernel(I2cdev::new(&bus.device)?)),
        }
    }
}

impl fmt::Debug for WireError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kernel(error) => error.fmt(f),
            Self::Socket(kind) => fmt::Debug::fmt(kind, f),
        }
    }
}

impl Error for WireError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Kernel(error) => error.kind(),
            Self::Socket(kind) => *kind,
        }
    }
}

impl ErrorType for Wire {
    type Error = WireError;
}

impl I2c for Wire {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), WireError> {
        match self {
            Self::Kernel(bus) => bus.transaction(address, operations).map_err(WireError::Kernel),
            Self::Socket(bus) => bus.transaction(address, operations).map_err(WireError::Socket),
        }
    }
}
