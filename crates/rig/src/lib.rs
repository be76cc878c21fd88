//! The hardware interface: the cycle uses hardware only through [`Rig`]. The bench, the simulated rig in real time and
//! the simulated rig in virtual time are one [`Chips`] over different buses and clocks; nothing else differs.
//!
//! ```text
//!            bench                    simulated, real time        simulated, virtual time
//! bus        /dev/i2c-1, a handle     emulated, a handle          emulated, a handle
//!            for each chip            for each chip               for each chip
//! lines      GPIO                     emulated                    emulated
//! clock      monotonic                monotonic                   the emulated world's own
//! ```
//!
//! `/dev/i2c-1` may also be the socket of `airball emulate`: the same binary with emulated chips that outlive it.
//!
//! [`Direct`] is a simulated rig with unknown chips, for rigs of other makers.

mod chips;
mod clock;
mod direct;
mod error;
mod lines;
mod pulses;
mod range;
mod second;
mod shared_setpoint;
mod simulated;
mod stepped;
#[cfg(test)]
mod tests;

pub use chips::{Chips, Wiring};
pub use clock::WorldClock;
pub use direct::Direct;
pub use error::StartError;
pub use lines::{Lines, Pin};
pub use simulated::{
    PlantWorld, SimulatedRig, SimulatedStartError, emulated_bus, simulated_in_real_time, simulated_in_virtual_time,
    start, with_signals,
};
pub use stepped::{Seen, Stepped};

use control::{Duty, Millimetres};
use embedded_hal::i2c::ErrorKind;
use hal::RangeStatus;

/// The sensor's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sighting {
    /// Position of the ball.
    Ball(Millimetres),
    /// No new reading since the last one.
    NotReady,
    /// A reading without a ball: no target, or one beyond the pipe.
    NoBall {
        /// What the sensor reported, mm from its window.
        reported_mm: u16,
    },
    /// A distance that the sensor marks as not valid.
    Doubtful {
        /// The sensor's status of it.
        status: RangeStatus,
        /// The reported distance, mm from its window.
        reported_mm: u16,
    },
}

/// Position, duty and clock; a second position and the fan's speed where the rig has them.
pub trait Rig {
    /// Seconds since a fixed start; never goes back.
    fn now_s(&self) -> f64;

    /// Returns at `t_s` or as soon after it as the system allows.
    fn sleep_until_s(&self, t_s: f64);

    /// Waits for the sensor's next reading, so that a loop that starts now runs just after each reading rather than
    /// just before.
    ///
    /// # Errors
    /// The error of the bus, or `Other` when the sensor remains silent.
    fn align(&mut self) -> Result<(), ErrorKind>;

    /// Reads the sensor, without waiting.
    ///
    /// # Errors
    /// The error of the bus.
    fn position(&mut self) -> Result<Sighting, ErrorKind>;

    /// Reads the second sensor, without waiting. `None`: the rig has none.
    fn second_position(&mut self) -> Option<Result<Sighting, ErrorKind>> {
        None
    }

    /// The fan's speed by its tachometer, rpm, without waiting. `None`: the rig has none.
    fn fan_rpm(&mut self) -> Option<f64> {
        None
    }

    /// The setpoint of the duty that is written next: effects of a simulated rig may depend on it. A real rig sees the
    /// duty alone.
    fn set_setpoint(&mut self, setpoint_mm: Option<f64>) {
        let _ = setpoint_mm;
    }

    /// Writes a duty and returns the one in the chip.
    ///
    /// # Errors
    /// The error of the bus.
    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind>;
}
