//! The application: everything around control law, plant and diagnosis. See ARCHITECTURE.md.

pub mod assessment;
pub mod cli;
pub mod closed_loop;
pub mod command;
pub mod commands;
pub mod config;
pub mod deadline;
pub mod desk;
pub mod experiment;
pub mod flight;
pub mod gallery;
pub mod last_fault;
pub mod lateness;
pub mod log;
pub mod measured;
pub mod monitor;
pub mod mqtt;
pub mod next;
pub mod pilot;
pub mod real_time;
pub mod report;
pub mod rig;
pub mod upstream;
pub mod watch;
