//! The bench: the interface of [`rig`] over the hardware of a Raspberry Pi, or over the socket of `airball emulate`,
//! the same binary with emulated chips that outlive it.

mod chips;
mod clock;
mod enable_line;
mod error;
mod gpio;
mod guard;
mod lines;
mod socket;
mod socket_lines;
mod wire;

pub use chips::{bench, claim, turn_off};
pub use clock::Monotonic;
pub use enable_line::EnableLine;
pub use error::BenchError;
pub use guard::{Guard, GuardError, Heard, Ward};
pub use socket::serve;
pub use socket_lines::Served;
