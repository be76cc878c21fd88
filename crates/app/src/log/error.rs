//! What can go wrong with a log, each with the file, the place and the next thing to do.

use crate::config::import::ImportError;
use diagnose::RecordingError;
use std::{io, path::PathBuf};

/// Why a log cannot be written or read. Lines count from 1, the header included.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}; check the name and the permissions", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file cannot be unpacked.
    #[error("cannot unpack {} (zstd): {cause}; copy the file again, or pack it again with `zstd`", path.display())]
    Packed {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        cause: String,
    },
    /// The file cannot be created.
    #[error("cannot create the log {}: {source}; check the folder and its permissions", path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A log of this name is there already.
    #[error("{} exists already and is kept; choose another name with --log or remove the file", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// Writing failed.
    #[error("writing {} failed after {cycles} cycles: {cause}; what was written before can be read, check the space on the disk", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Cycles that were written, the last second of them perhaps only in part.
        cycles: u64,
        /// What went wrong.
        cause: String,
    },
    /// The thread that writes could not be started, or ended before its time.
    #[error("the thread that writes {} failed: {cause}; fly again, or without --log", path.display())]
    Thread {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        cause: String,
    },
    /// Nothing in the file.
    #[error("{} is empty; record a flight with `airball simulate` or `airball run`", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// An MCAP file without a readable cycle.
    #[error("{} has no readable message in the channel `cycle`: {cause}; record the flight again", path.display())]
    NoCycles {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// The rows are no recording.
    #[error("{}: {source}", path.display())]
    NotARecording {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        source: RecordingError,
    },
    /// A header, and no rows.
    #[error("{} has a header and no rows of data; check that the recorder ran", path.display())]
    HeaderOnly {
        /// The file.
        path: PathBuf,
    },
    /// A column is not there.
    #[error("{}, line {line}: no column `{column}` for {quantity}, found {found}; rename the column, or map another in the config: [import] {quantity} = {{ column = \"…\", scale = 1.0, offset = 0.0 }}", path.display())]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// Line of the header.
        line: usize,
        /// The column that was looked for.
        column: String,
        /// What it would have been.
        quantity: &'static str,
        /// The columns that are there.
        found: String,
    },
    /// A column is there twice.
    #[error("{}, line {line}: {times} columns are called `{column}`; rename all but one", path.display())]
    RepeatedColumn {
        /// The file.
        path: PathBuf,
        /// Line of the header.
        line: usize,
        /// Its name.
        column: String,
        /// How often it is there.
        times: usize,
    },
    /// Not text.
    #[error("{}, line {line}: byte {byte} is not UTF-8 text, and the file is no MCAP; save the table as CSV in UTF-8", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// Where.
        line: usize,
        /// Where, counted from 0.
        byte: usize,
    },
    /// Text that is no table.
    #[error("{} is no table: {cause}; save it as CSV with one header line", path.display())]
    NotATable {
        /// The file.
        path: PathBuf,
        /// What the parser said.
        cause: String,
    },
    /// A row with too few or too many cells.
    #[error("{}, line {line}: {found} cells where the header has {expected}; complete the row or remove it", path.display())]
    Ragged {
        /// The file.
        path: PathBuf,
        /// Where.
        line: usize,
        /// Cells in the header.
        expected: usize,
        /// Cells in the row.
        found: usize,
    },
    /// A cell that cannot be used.
    #[error("{}, line {line}, column `{column}`: {problem}", path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// Where.
        line: usize,
        /// Which column of the file.
        column: String,
        /// What is wrong.
        problem: CellProblem,
    },
    /// Time went backwards.
    #[error("{}, line {line}: time goes backwards, from {from_s} s in line {from_line} to {to_s} s; sort the rows, or cut the file there", path.display())]
    TimeBackwards {
        /// The file.
        path: PathBuf,
        /// The offending line.
        line: usize,
        /// The row before it.
        from_line: usize,
        /// Its time, seconds.
        from_s: f64,
        /// Time of the offending line, seconds.
        to_s: f64,
    },
    /// The table `[import]` of the config makes no sense.
    #[error(transparent)]
    Import(ImportError),
}

/// What is wrong with a cell.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CellProblem {
    /// Nothing in it.
    #[error(
        "the cell is empty; only position, setpoint, control and the optional sensors may be missing: fill it or remove the row"
    )]
    Empty,
    /// No number.
    #[error("`{0}` is no number; write it with a decimal point and without a unit")]
    NotANumber(String),
    /// NaN, an infinity, or a number that scale and offset take out of range.
    #[error("`{0}` is not finite; leave the cell empty where there was no reading, or remove the row")]
    NotFinite(String),
    /// No yes or no.
    #[error("`{0}` is neither 0, 1, true nor false")]
    NotAFlag(String),
}
