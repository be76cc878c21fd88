//! Two VL53L0X on one bus: both answer at 0x29 after power-on, and only reset tells them apart.
//!
//! ```text
//! second: XSHUT low ──────────────────── XSHUT high ── 0x29 → its own address
//! first:            0x29 → out of the way                                     → 0x29
//! ```
//!
//! XSHUT low is the second sensor's reset: it loses its address with all else. Register 0x8A holds the address until
//! then, or until the power fails. The first sensor ends where it was, so that a rig without a second one finds it
//! there.
//! Source: ST, AN4846 "Using multiple VL53L0X in a single design".

use crate::clock::Clock;
use crate::range_sensor::{ADDRESS, RESET_ALLOWED_S, reset};
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::I2c;

/// Where the first sensor waits while the second is moved. No second sensor may live there.
pub const ASIDE: u8 = 0x2B;
const DEVICE_ADDRESS: u8 = 0x8A;
const SELECT_PAGE_0: [u8; 2] = [0xFF, 0x00];
/// How long reset is held, and how long the sensor may take to boot from it: 1.2 ms (datasheet).
const RESET_S: f64 = 0.002;
const BOOT_S: f64 = 0.005;

/// Why two sensors cannot be given different addresses.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SeparateError<E> {
    /// The line did not move.
    #[error("the line of XSHUT cannot be driven; check [rig.second_sensor] xshut_line")]
    Line,
    /// A sensor does not take its address.
    #[error(
        "I2C {error:?} at the {which} range sensor while it was moved from {from:#04x} to {to:#04x}; check its wiring, \
         and that XSHUT of the second one alone is on the line of [rig.second_sensor]"
    )]
    Bus {
        /// Which sensor.
        which: &'static str,
        /// Where it was.
        from: u8,
        /// Where it should have gone.
        to: u8,
        /// The error of the bus.
        error: E,
    },
}

/// Leaves the first sensor at 0x29 and the second, fresh from its reset, at `address`, wherever a killed program left
/// them.
///
/// # Errors
/// [`SeparateError`]: a sensor or the line does not answer.
pub fn separate<I: I2c>(
    mut i2c: I,
    xshut: &mut impl OutputPin,
    clock: &impl Clock,
    address: u8,
) -> Result<(), SeparateError<I::Error>> {
    xshut.set_low().map_err(|_| SeparateError::Line)?;
    clock.sleep_until_s(clock.now_s() + RESET_S);
    // A program that was killed half way left it there.
    if i2c.write(ADDRESS, &SELECT_PAGE_0).is_err() {
        let _ = relocate(&mut i2c, "first", ASIDE, ADDRESS);
    }
    // Or in the middle of a reset, in which it would not receive another address.
    let reset = reset(&mut i2c, clock, clock.now_s() + RESET_ALLOWED_S);
    reset.map_err(|error| SeparateError::Bus { which: "first", from: ADDRESS, to: ASIDE, error })?;
    relocate(&mut i2c, "first", ADDRESS, ASIDE)?;
    let moved = release(&mut i2c, xshut, clock, address);
    relocate(&mut i2c, "first", ASIDE, ADDRESS)?;
    moved
}

fn release<I: I2c>(
    i2c: &mut I,
    xshut: &mut impl OutputPin,
    clock: &impl Clock,
    address: u8,
) -> Result<(), SeparateError<I::Error>> {
    xshut.set_high().map_err(|_| SeparateError::Line)?;
    clock.sleep_until_s(clock.now_s() + BOOT_S);
    relocate(i2c, "second", ADDRESS, address)
}

fn relocate<I: I2c>(i2c: &mut I, which: &'static str, from: u8, to: u8) -> Result<(), SeparateError<I::Error>> {
    let moved = i2c.write(from, &SELECT_PAGE_0).and_then(|()| i2c.write(from, &[DEVICE_ADDRESS, to]));
    moved.map_err(|error| SeparateError::Bus { which, from, to, error })
}
