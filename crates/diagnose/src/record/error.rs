//! Rows that no recording can be made of.

/// Why rows are no recording. Row numbers count from 1 at the first row of data.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Nothing in it.
    #[error("it has no rows of data; record a flight with `airball simulate` or `airball run`")]
    Empty,
    /// Too few readings to say anything.
    #[error("it has {readings} readings, too few to compare with a model; at least {needed} are needed")]
    TooShort {
        /// Readings found.
        readings: usize,
        /// Readings needed.
        needed: usize,
    },
    /// Time went backwards.
    #[error("time goes backwards at row {row}, from {from_s} s to {to_s} s; sort the rows or cut the log there")]
    TimeBackwards {
        /// The offending row.
        row: usize,
        /// Time of the row before.
        from_s: f64,
        /// Time of the row.
        to_s: f64,
    },
    /// Time stands still.
    #[error("time is {time_s} s in every row; name the column of the time in [import] time_s")]
    NoTime {
        /// The time of every row.
        time_s: f64,
    },
    /// A hole that no forecast can cross.
    #[error(
        "no row for {} s before row {row}, from {from_s} s to {to_s} s; cut the log there, or, if time is not in \
         seconds, give its unit as [import] time_s.scale", to_s - from_s
    )]
    Hole {
        /// The row after the hole.
        row: usize,
        /// Time of the row before.
        from_s: f64,
        /// Time of the row.
        to_s: f64,
    },
    /// A number that is none.
    #[error("{quantity} at row {row} is {value}; remove the row or mend the recorder")]
    NotFinite {
        /// The offending row.
        row: usize,
        /// Which quantity.
        quantity: &'static str,
        /// What it is.
        value: f64,
    },
}
