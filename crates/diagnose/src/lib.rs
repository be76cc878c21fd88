//! The gap between a simulator and a rig.
pub mod recording;

pub use recording::{Recording, RecordingError, Sample};
