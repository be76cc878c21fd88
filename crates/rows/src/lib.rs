//! From a CSV of any rig to the rows of a recording.
//!
//! ```text
//! bytes → table (cells with their line) → columns (mapped by `[import]`, in our units) → samples → recording
//! ```
//!
//! No file and no network access: the caller passes the bytes, and their name for messages.

mod clock;
mod columns;
mod error;
mod foreign;
mod hold;
mod import;
mod number;
mod plain;
mod serial;
mod sheet;
mod shown;
mod table;
mod text;
mod wrap;

#[cfg(test)]
mod dialect_tests;
#[cfg(test)]
mod tests;

pub use clock::spread_if_coarse;
pub use error::{CellProblem, RowsError};
pub use hold::held_if_sparse;
pub use import::{Column, Import};
pub use sheet::{Sheet, SheetColumn, TextCell, sheet};
pub use shown::{printable, shown};

use diagnose::{Recording, Sample};
use table::Table;

/// Reads the rows of a CSV. `name` is the file's name in messages; `import` maps the columns.
///
/// # Errors
/// [`RowsError`] names the file, the line, what is there and the next step.
pub fn samples(name: &str, bytes: &[u8], import: &Import) -> Result<Vec<Sample>, RowsError> {
    columns::map(&Table::parse(name, bytes)?, import)
}

/// Reads a CSV as a recording, with what is missing at its end, in words: a recorder that is cut off leaves half a row.
///
/// # Errors
/// As [`recording`].
pub fn recording_and_loss(name: &str, bytes: &[u8], import: &Import) -> Result<(Recording, Option<String>), RowsError> {
    let table = Table::parse(name, bytes)?;
    let recording = Recording::new(columns::map(&table, import)?);
    let recording = recording.map_err(|source| RowsError::NotARecording { name: name.into(), source })?;
    Ok((recording, table.loss()))
}

/// Reads a CSV as a recording.
///
/// # Errors
/// As [`samples`], and rows that do not make a recording.
pub fn recording(name: &str, bytes: &[u8], import: &Import) -> Result<Recording, RowsError> {
    recording_and_loss(name, bytes, import).map(|(recording, _)| recording)
}
