//! One file per command: it reads flags and tables, calls the analysis or flight, and prints the result.

mod about;
pub mod compare;
pub mod config;
pub mod design;
pub mod diagnose;
pub(crate) mod diagnosing;
pub(crate) mod each;
pub mod emulate;
pub mod export;
pub mod fan_off;
pub(crate) mod flying;
pub mod guard;
pub mod identify;
pub mod init;
pub mod live;
pub mod log;
pub mod measure;
pub mod monitor;
mod output;
mod owner;
pub mod replay;
pub mod run;
pub mod simulate;

pub use output::{Usage, fail, reader_is_gone, with_causes};
use output::{announce, may_write, note, say, typed, warn, write};
