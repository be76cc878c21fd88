//! Logs of flights: writing and reading.
//!
//! Writing: [`recorder`] (interface of the loop) → [`queue`] (real time) → [`writer`] → MCAP.
//! Reading: [`reader`] → `packed` (zstd, if it is) → [`flight`] (MCAP), or `parquet` (Parquet to CSV) and the crate
//! [`rows`] (CSV) → recording.
//! Repair: [`flight`] → [`recover`] → a new MCAP.
//! Other rigs' files are converted by [`rows::Import`]; ours become tables by [`export`].

mod contained;
pub mod error;
pub mod event;
pub mod export;
pub mod files;
pub mod flight;
mod foreign;
pub mod header;
mod packed;
mod parquet;
pub mod queue;
pub mod reader;
pub mod recorder;
mod records;
pub mod recover;
pub mod rotation;
mod schema;
pub mod writer;

#[cfg(test)]
pub(crate) mod tests;

pub use error::LogError;
