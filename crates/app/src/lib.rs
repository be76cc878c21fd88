//! The application.
pub mod command;
pub mod log;
