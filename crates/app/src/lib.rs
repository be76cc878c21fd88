//! The application: everything around control law, plant and diagnosis. See ARCHITECTURE.md.
//!
//! Its layers, each of which knows only those above it: `config`, `rig`, `flight`, `log` and `mqtt`, `analysis`, `report`, `commands`.

pub mod analysis;
pub mod cli;
pub mod commands;
pub mod config;
pub mod flight;
pub mod gallery;
pub mod log;
pub mod mqtt;
pub mod report;
pub mod rig;
