//! The plant: from duty to the reading of the position, effect by effect, in the order of the signal path.
//!
//! ```text
//! duty → [ actuator → air → ball → sensor ] → position
//! ```
//!
//! [`Model`] is the belief about a rig (the config's `[plant]`), [`Effects`] the part of it that can be
//! switched, [`Motion`] the state, [`Simulator`] a rig that flies by the model and its noise.
//! Position in mm, upward; velocity in mm/s; acceleration in mm/s²; duty in percent; time in s.
//! Mathematics comes from `libm` only, so that every target computes the same bits.

mod effect;
pub mod effects;
mod model;
mod motion;
mod normal;
mod rk4;
mod simulator;

pub use effect::{Effect, Entry, Param, Stage};
pub use effects::Effects;
pub use model::{Model, Noise};
pub use motion::Motion;
pub use normal::Normal;
pub use simulator::Simulator;
