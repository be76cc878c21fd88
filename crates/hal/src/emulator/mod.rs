//! Register-level emulators of the chips on one emulated bus, and the lines beside it, so that the real drivers run
//! without hardware.
//!
//! ```text
//! driver → EmulatedI2c → EmulatedBus → chip → World      (fault injection sits between bus and chip)
//! ```
//!
//! A chip keeps its registers when the program on the other side of the bus starts again, as the real one does.

mod bus;
mod fault;
mod lines;
mod pca9685;
mod vl53l0x;
mod world;

pub use bus::{EmulatedBus, EmulatedI2c};
pub use fault::Fault;
pub use lines::{EmulatedEdges, EmulatedLine};
pub use world::World;
