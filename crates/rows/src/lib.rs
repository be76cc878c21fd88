//! A CSV of any rig in, the rows of a recording out.
//!
//! ```text
//! bytes → table (cells that know their line) → columns (mapped by `[import]`, in our units) → samples → recording
//! ```
//!
//! Does no file and no network access: whoever calls gives the bytes, and a name of them for messages.

mod columns;
mod error;
mod import;
mod table;

#[cfg(test)]
mod tests;

pub use error::{CellProblem, RowsError};
pub use import::{Column, Import};

use diagnose::{Recording, Sample};
use table::Table;

/// Reads the rows of a CSV. `name` is the file's name in messages; `import` says which columns are ours.
///
/// # Errors
/// [`RowsError`] names the file, the line, what is there and what to do.
pub fn samples(name: &str, bytes: &[u8], import: &Import) -> Result<Vec<Sample>, RowsError> {
    columns::map(&Table::parse(name, bytes)?, import)
}

/// Reads a CSV as a recording.
///
/// # Errors
/// As [`samples`], and rows that are no recording.
pub fn recording(name: &str, bytes: &[u8], import: &Import) -> Result<Recording, RowsError> {
    let samples = samples(name, bytes, import)?;
    Recording::new(samples).map_err(|source| RowsError::NotARecording { name: name.into(), source })
}
