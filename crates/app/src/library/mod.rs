//! The commands as functions, for programs in other languages: the same computation as the command line, with values
//! instead of files and lines.
//!
//! Documents are those of `--json`, to the last digit. Flags of a command are given as words, so that names, defaults
//! and checks are those of the command line.

mod belief;
mod diagnosed;
mod flags;
mod flown;
mod log;
mod others;

pub use belief::Belief;
pub use diagnosed::{Diagnosed, FreeRunPoints, Pictured};
pub use flown::{Flown, Programme, fly};
pub use log::Log;
pub use others::{Made, design, export_fmu, identify, is_log, propose, replay, summarise, tell_apart};

pub use crate::commands::{Usage, with_causes};
pub use crate::log::LogError;
pub use config::ConfigError;
pub use diagnose::{Options, Progress, ProgressStep, Recording, RecordingError, Sample};
