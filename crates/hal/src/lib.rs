//! Chips of the rig: the VL53L0X range sensor and the PCA9685 fan driver, each over its own handle of any
//! `embedded-hal` 1.0 bus, and register-level emulators of both so that the same drivers run on a desk. Beside the bus:
//! the fan's tachometer, and the line that tells two range sensors apart.
//!
//! ```text
//! app → RangeSensor → vl53l0x      → WithStatus → DeadlineI2c → bus   (wire or emulator)
//! app → Fan         → pwm_pca9685                             → bus   (wire or emulator)
//! app → Tachometer  → Edges                                   → line  (GPIO or emulator)
//! ```
//!
//! This crate reports and obeys. It never decides what to do about a fault.

mod clock;
mod deadline;
pub mod emulator;
mod fan;
mod range_sensor;
mod range_status;
mod read_back;
mod separate;
mod tachometer;
#[cfg(test)]
mod tests;

pub use clock::Clock;
pub use deadline::{Deadline, DeadlineError, DeadlineI2c};
pub use fan::{Fan, FanError, fan_off, stop as stop_fan};
pub use range_sensor::{BUDGET_US, Range, RangeError, RangeSensor};
pub use range_status::RangeStatus;
pub use separate::{ASIDE, SeparateError, separate};
pub use tachometer::{Edges, Tachometer};
