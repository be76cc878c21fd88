//! Register-level emulators of both chips on one emulated bus, so that the real drivers run without hardware.
//!
//! ```text
//! driver → EmulatedI2c → EmulatedBus → chip → World      (fault injection sits between bus and chip)
//! ```
//!
//! A chip keeps its registers when the program on the other side of the bus starts again, as the real one does.

mod bus;
mod fault;
mod pca9685;
mod vl53l0x;
mod world;

pub use bus::{EmulatedBus, EmulatedI2c};
pub use fault::Fault;
pub use world::World;
