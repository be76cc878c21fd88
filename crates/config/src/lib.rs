//! The config file: one TOML file, every number with its unit in its key, unknown keys refused.
//!
//! `tables` is its content, `signals` the optional ones of `[rig]`, `written` the effects that a user wrote; `load` reads
//! it, merges patches and locates errors.

mod error;
mod load;
mod merge;
pub mod mqtt;
mod plain_words;
mod predistorted;
mod rig;
mod signals;
pub mod source_columns;
mod tables;
pub mod topics;
pub mod words;
mod written;

/// The config that every command takes where none is named.
pub const USUAL: &str = "config.toml";

pub use error::ConfigError;
pub use load::{Config, parse_file, parse_text};
pub use plain_words::plain_words;
pub use predistorted::with_other_control;
pub use rig::Rig;
pub use signals::{SecondSensor, Tachometer};
pub use tables::{Bus, Loop, Reference, Safety, Stuck, Tables};
pub use written::OWN_EFFECT_ADVICE;
