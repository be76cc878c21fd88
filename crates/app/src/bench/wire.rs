//! The bus of `[bus] device`: the kernel's, or an emulated one behind a socket.

use super::socket::SocketBus;
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, Operation};
use i2cdev::core::{I2CMessage, I2CTransfer};
use i2cdev::linux::{LinuxI2CBus, LinuxI2CError, LinuxI2CMessage};
use linux_embedded_hal::I2CError;
use std::error;
use std::fmt;
use std::path::Path;

/// One handle of the bus. Each chip's driver owns one; the kernel serialises their requests.
pub enum Wire {
    /// A device file of the kernel.
    Kernel(LinuxI2CBus),
    /// The socket of `airball emulate`.
    Socket(SocketBus),
}

/// An error of the bus. Its `Debug` is the system's error, without the name of the kind of bus.
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
    /// What the system reported.
    pub fn open(bus: &config::Bus) -> Result<Self, Box<dyn error::Error + Send + Sync>> {
        match bus.socket() {
            Some(path) => Ok(Self::Socket(SocketBus::open(Path::new(path))?)),
            None => Ok(Self::Kernel(LinuxI2CBus::new(&bus.device)?)),
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
            Self::Kernel(bus) => transfer(bus, address, operations).map_err(|error| WireError::Kernel(error.into())),
            Self::Socket(bus) => bus.transaction(address, operations).map_err(WireError::Socket),
        }
    }
}

/// A transaction on the kernel's bus. The chips' drivers write, or write and read: these messages are on the stack,
/// because a cycle must not allocate, and `linux-embedded-hal`, whose errors are used here, builds a list of them on
/// the heap.
fn transfer(bus: &mut LinuxI2CBus, address: u8, operations: &mut [Operation<'_>]) -> Result<(), LinuxI2CError> {
    match operations {
        [] => return Ok(()),
        [only] => bus.transfer(&mut [message(address, only)]),
        [first, second] => bus.transfer(&mut [message(address, first), message(address, second)]),
        more => bus.transfer(&mut more.iter_mut().map(|one| message(address, one)).collect::<Vec<_>>()),
    }
    .map(drop)
}

fn message<'a>(address: u8, operation: &'a mut Operation<'_>) -> LinuxI2CMessage<'a> {
    let message = match operation {
        Operation::Write(bytes) => LinuxI2CMessage::write(bytes),
        Operation::Read(bytes) => LinuxI2CMessage::read(bytes),
    };
    message.with_address(address.into())
}

#[cfg(test)]
mod tests {
    use super::Wire;
    use config::Bus;
    use embedded_hal::i2c::I2c;

    #[test]
    fn transactions_as_in_a_cycle_allocate_nothing_on_the_kernels_bus() {
        // Opens as a bus does, and refuses its requests.
        let mut bus = Wire::open(&Bus { device: "/dev/null".into() }).unwrap();
        let mut distance = [0; 2];
        let allocated = allocation_counter::measure(|| {
            assert!(bus.write_read(0x29, &[0x1e], &mut distance).is_err());
            assert!(bus.write(0x40, &[0x06, 0, 0, 0, 8]).is_err());
        });
        assert_eq!(allocated.count_total, 0);
    }
}
