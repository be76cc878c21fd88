//! Errors of a table, each with the file, the line and the next step.

use diagnose::RecordingError;

/// Why a CSV is not a recording. Lines count from 1, the header included.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RowsError {
    /// The file is empty.
    #[error("{name} is empty; record a flight with `airball simulate` or `airball run`")]
    Empty {
        /// The file.
        name: String,
    },
    /// The rows do not make a recording.
    #[error("{name}: {source}")]
    NotARecording {
        /// The file.
        name: String,
        /// What is wrong with them.
        source: RecordingError,
    },
    /// A header, and no rows.
    #[error("{name} has a header and no rows of data; check that the recorder ran")]
    HeaderOnly {
        /// The file.
        name: String,
    },
    /// A column is missing.
    #[error(
        "{name}, line {line}: no column `{column}` for {quantity}, found {found}; rename the column, or map another in \
         the config: [import] {quantity} = {{ column = \"…\", scale = 1.0, offset = 0.0 }}; or let `airball diagnose \
         {name} --init` find all columns and propose a config"
    )]
    MissingColumn {
        /// The file.
        name: String,
        /// Line of the header.
        line: usize,
        /// The missing column.
        column: String,
        /// The quantity of that column.
        quantity: &'static str,
        /// The existing columns.
        found: String,
    },
    /// Several columns have the same name.
    #[error("{name}, line {line}: {times} columns are called `{column}`; rename all but one")]
    RepeatedColumn {
        /// The file.
        name: String,
        /// Line of the header.
        line: usize,
        /// Its name.
        column: String,
        /// Number of columns with it.
        times: usize,
    },
    /// Not text.
    #[error("{name}, line {line}: byte {byte} is no text, and the file is no MCAP; save the table as CSV in UTF-8")]
    NotText {
        /// The file.
        name: String,
        /// The line.
        line: usize,
        /// Offset in bytes, counted from 0.
        byte: usize,
    },
    /// Not UTF-16 text, though it begins as such.
    #[error("{name} is not UTF-16 text, though it begins as such; save the table as CSV in UTF-8")]
    NotUtf16 {
        /// The file.
        name: String,
    },
    /// A file of another format.
    #[error("{name} is {format}, and no CSV; {advice}")]
    Foreign {
        /// The file.
        name: String,
        /// Its format.
        format: &'static str,
        /// How to make a CSV of it.
        advice: &'static str,
    },
    /// Text that is not a table.
    #[error("{name} is no table: {cause}; save it as CSV with one header line")]
    NotATable {
        /// The file.
        name: String,
        /// The parser's message.
        cause: String,
    },
    /// A row with too few or too many cells.
    #[error("{name}, line {line}: {found} cells where the header has {expected}; complete the row or remove it")]
    Ragged {
        /// The file.
        name: String,
        /// The line.
        line: usize,
        /// Cells in the header.
        expected: usize,
        /// Cells in the row.
        found: usize,
    },
    /// A header with fewer or more names than every row has cells.
    #[error(
        "{name}, line {line}: the header has {expected} names, and every row has {found} cells; give each column its \
         name, or remove the header: the columns are then called column1, column2, …"
    )]
    HeaderMismatch {
        /// The file.
        name: String,
        /// Line of the header.
        line: usize,
        /// Names in the header.
        expected: usize,
        /// Cells in each row.
        found: usize,
    },
    /// A cell that cannot be used.
    #[error("{name}, line {line}, column `{column}`: {problem}")]
    Cell {
        /// The file.
        name: String,
        /// The line.
        line: usize,
        /// The column of the file.
        column: String,
        /// What is wrong.
        problem: CellProblem,
    },
    /// Time decreased.
    #[error(
        "{name}, line {line}: time goes backwards, from {from_s} s in line {from_line} to {to_s} s; sort the rows, or cut the file there"
    )]
    TimeBackwards {
        /// The file.
        name: String,
        /// The wrong line.
        line: usize,
        /// The row before it.
        from_line: usize,
        /// Its time, seconds.
        from_s: f64,
        /// Time of the wrong line, seconds.
        to_s: f64,
    },
    /// The table `[import]` of the config is invalid.
    #[error("[import] {quantity}: {key} = {value}; {hint}")]
    Import {
        /// The quantity.
        quantity: &'static str,
        /// The key.
        key: &'static str,
        /// Its value.
        value: String,
        /// The expected value.
        hint: &'static str,
    },
}

/// What is wrong with a cell.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CellProblem {
    /// It is empty or NaN.
    #[error(
        "the cell holds no reading, it is empty or NaN; only position, setpoint, control and the optional sensors may \
         be missing: fill it or remove the row, or, where the log writes the input in some rows only, add hold = true \
         to [import] duty_percent, and it is held between them"
    )]
    Empty,
    /// It is not a number.
    #[error("`{0}` is no number; write it with a decimal point and without a unit")]
    NotANumber(String),
    /// An infinity, or a number that scale and offset take out of range.
    #[error("`{0}` is not finite; leave the cell empty where there was no reading, or remove the row")]
    NotFinite(String),
    /// It is not a truth value.
    #[error("`{0}` is neither 0, 1, true nor false")]
    NotAFlag(String),
}
