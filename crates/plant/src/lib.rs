//! The plant: from duty to the reading of the position, effect by effect, in the order of the signal path.
//!
//! ```text
//! duty → [ actuator → air → ball → sensor ] → position
//! ```
//!
//! [`Model`] is the belief about a rig (the config's `[plant]`), [`Effects`] the part of it that can be
//! switched, [`Actuator`] the way from the duty to the commanded acceleration, [`Motion`] the state behind it,
//! [`Simulator`] a rig that flies by the model and its noise, [`Rotor`] the speed of its fan.
//! Position in mm, upward; velocity in mm/s; acceleration in mm/s²; duty in percent; time in s.
//! Mathematics comes from `libm` only, so that every target computes the same bits.

mod acts;
mod actuator;
mod effect;
pub mod effects;
mod flow;
mod lag;
mod linear;
mod model;
mod motion;
mod normal;
mod rate;
mod rk4;
mod root;
mod rotor;
mod rounding;
mod sensor;
mod settled;
mod signal_path;
mod simulator;
mod stops;
mod tangent;
mod unsound;
mod written;

pub use acts::{Acts, Changes, Conditions, Follows, Late, Readings, Senses, Slews, Summary, is_beyond_the_noise};
pub use actuator::Actuator;
pub use effect::{Difference, Effect, Entry, Form, InColumn, Neutral, Param, Scale, Similar, Stage, Start};
pub use effects::Effects;
pub use linear::Slopes;
pub use model::{Model, Noise};
pub use motion::{Input, Motion, OWN_STATES};
pub use normal::Normal;
pub use rotor::Rotor;
pub use settled::Settled;
pub use simulator::Simulator;
pub use tangent::{Derivatives, Friction};
pub use unsound::Unsound;
pub use written::{Definition, DefinitionError, DefinitionTable, ParameterTable, StateTable, WrittenEffects};
