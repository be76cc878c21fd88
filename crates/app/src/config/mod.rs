//! The config file: one TOML file, every number with its unit in its key, unknown keys refused.
//!
//! `tables` is what it may hold, `load` reads it, merges patches and says where a mistake stands.

mod load;
mod tables;

pub use load::{Config, ConfigError, parse_file, parse_text};
pub use tables::{Bus, Log, Loop, Reference, Rig, Safety, Stuck, Tables};
