//! The range status: what the sensor thinks of its own distance, fetched in one burst with it.
//!
//! ```text
//! register   0x14                        0x1E 0x1F
//!            status in bits 6 to 3       distance, mm
//! ```
//!
//! The driver crate reads the distance alone, two bytes from 0x1E. [`WithStatus`] makes that a read of twelve bytes
//! from 0x14, as ST's `VL53L0X_GetRangingMeasurementData` does: one transaction as before, and both are of one
//! measurement.
//!
//! Source: ST's API, `VL53L0X_get_pal_range_status` and `VL53L0X_DEVICEERROR_…` in `vl53l0x_device.h`.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use embedded_hal::i2c::{ErrorType, I2c, Operation};

const STATUS: u8 = 0x14;
const DISTANCE: u8 = 0x1E;
const BURST: usize = (DISTANCE - STATUS) as usize + 2;
/// "Range complete", the only status of a distance that can be trusted.
const VALID: u8 = 11;

/// The sensor's verdict on a distance: 11 is a valid range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RangeStatus(u8);

impl RangeStatus {
    /// The status in the value of register 0x14.
    #[must_use]
    pub const fn of_register(value: u8) -> Self {
        Self((value >> 3) & 0x0F)
    }

    /// Whether the distance beside it is one.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        self.0 == VALID
    }

    /// The number, 0 to 15.
    #[must_use]
    pub const fn code(self) -> u8 {
        self.0
    }
}

impl fmt::Display for RangeStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = match self.0 {
            1..=3 => "its laser or supply failed",
            4 => "too little light came back",
            6 | 9 => "the light's phase does not fit",
            8 | 10 => "the target is too near",
            VALID => "valid",
            _ => "no range",
        };
        write!(f, "{} ({words})", self.0)
    }
}

/// The status that came with the last distance. Clones share it: the driver owns the bus, we keep this.
#[derive(Clone, Default)]
pub(crate) struct LastStatus {
    register: Arc<AtomicU8>,
}

impl LastStatus {
    pub(crate) fn get(&self) -> RangeStatus {
        RangeStatus::of_register(self.register.load(Ordering::Relaxed))
    }
}

/// A bus that fetches the status whenever the driver asks for the distance.
pub(crate) struct WithStatus<I> {
    bus: I,
    last: LastStatus,
}

impl<I> WithStatus<I> {
    pub(crate) fn new(bus: I, last: LastStatus) -> Self {
        Self { bus, last }
    }
}

impl<I: I2c> ErrorType for WithStatus<I> {
    type Error = I::Error;
}

impl<I: I2c> I2c for WithStatus<I> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Self::Error> {
        let [Operation::Write([DISTANCE]), Operation::Read(distance @ [_, _])] = operations else {
            return self.bus.transaction(address, operations);
        };
        let mut burst = [0; BURST];
        self.bus.write_read(address, &[STATUS], &mut burst)?;
        self.last.register.store(burst[0], Ordering::Relaxed);
        distance.copy_from_slice(&burst[BURST - 2..]);
        Ok(())
    }
}
