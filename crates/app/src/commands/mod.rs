//! One file a command: reads its flags and tables, calls what does the work, prints the result.

pub mod config;
mod flying;
pub mod log;
pub mod replay;
pub mod run;
pub mod simulate;
