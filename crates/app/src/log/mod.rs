//! What a flight leaves behind, and how it is read again.
//!
//! Writing: [`recorder`] (what the loop sees) → [`queue`] (real time) → [`writer`] → MCAP.
//! Reading: [`reader`] → `packed` (zstd, if it is) → [`flight`] (MCAP) or `table` and `columns` (CSV, mapped by
//! [`import`](crate::config::import)) → recording.
//! Mending: [`flight`] → [`recover`] → a new MCAP.
//! Other rigs' files become ours by [`import`](crate::config::import); ours become tables by [`export`].

mod columns;
pub mod error;
pub mod event;
pub mod export;
pub mod files;
pub mod flight;
pub mod header;
mod packed;
pub mod queue;
pub mod reader;
pub mod recorder;
mod records;
pub mod recover;
pub mod rotation;
mod schema;
mod table;
pub mod writer;

#[cfg(test)]
pub(crate) mod tests;

pub use error::LogError;
