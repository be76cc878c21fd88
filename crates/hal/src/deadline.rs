//! A bus that stops answering at a deadline, and that refuses register values the sensor driver cannot survive.
//!
//! The sensor driver polls up to 65,535 times before it gives up: 6.6 s at 400 kHz, 26 s at 100 kHz. It owns the bus
//! and never gives it back. So the bus itself keeps the time: after the deadline every transaction is an error, and
//! the driver returns the first error it meets. The overshoot is at most one transaction.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, Operation};

use crate::clock::Clock;
use crate::read_back::ReadBack;

/// The moment after which a [`DeadlineI2c`] refuses to work. Clones share it: the driver owns the bus, we keep this.
#[derive(Clone, Debug)]
pub struct Deadline {
    /// Bits of the `f64`, so that the handle may cross threads with the driver.
    bits: Arc<AtomicU64>,
}

impl Deadline {
    /// A deadline at `at_s` on the clock of the bus.
    #[must_use]
    pub fn at(at_s: f64) -> Self {
        Self { bits: Arc::new(AtomicU64::new(at_s.to_bits())) }
    }

    /// Moves the deadline to `at_s`, for every clone.
    pub fn move_to(&self, at_s: f64) {
        self.bits.store(at_s.to_bits(), Ordering::Relaxed);
    }

    /// The deadline in force, seconds on the clock of the bus.
    #[must_use]
    pub fn at_s(&self) -> f64 {
        f64::from_bits(self.bits.load(Ordering::Relaxed))
    }
}

/// Why a guarded transaction failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DeadlineError<E> {
    /// The bus underneath failed.
    #[error("I2C {0:?}; check the wiring, the power and the bus number")]
    Bus(E),
    /// The transaction was not started, because it was too late for it.
    #[error("I2C transaction refused {late_s:.4} s after its deadline; the chip is slow or keeps saying \"not ready\"")]
    DeadlinePassed {
        /// Seconds between the deadline and the refusal.
        late_s: f64,
    },
    /// A register does not hold what was written to it.
    #[error("register {register:#04x} reads {read:#04x}, but {wrote:#04x} was written; check for a stuck or noisy bus")]
    Garbage {
        /// The register, on page 0.
        register: u8,
        /// What the driver wrote last.
        wrote: u8,
        /// What the chip answered.
        read: u8,
    },
}

impl<E: Error> Error for DeadlineError<E> {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Bus(error) => error.kind(),
            Self::DeadlinePassed { .. } | Self::Garbage { .. } => ErrorKind::Other,
        }
    }
}

/// Any I2C bus, until its deadline, with the registers of the range sensor checked on reading.
pub struct DeadlineI2c<I, C> {
    bus: I,
    clock: C,
    deadline: Deadline,
    read_back: ReadBack,
}

impl<I: I2c, C: Clock> DeadlineI2c<I, C> {
    /// Wraps `bus`; keep a clone of `deadline` to move it later.
    pub fn new(bus: I, clock: C, deadline: Deadline) -> Self {
        Self { bus, clock, deadline, read_back: ReadBack::default() }
    }
}

impl<I: I2c, C> ErrorType for DeadlineI2c<I, C> {
    type Error = DeadlineError<I::Error>;
}

impl<I: I2c, C: Clock> I2c for DeadlineI2c<I, C> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Self::Error> {
        let late_s = self.clock.now_s() - self.deadline.at_s();
        if late_s > 0.0 {
            return Err(DeadlineError::DeadlinePassed { late_s });
        }
        self.bus.transaction(address, operations).map_err(DeadlineError::Bus)?;
        self.read_back.check(operations).map_err(|(register, wrote, read)| DeadlineError::Garbage {
            register,
            wrote,
            read,
        })
    }
}
