//! Errors for rows that cannot become a recording.

use crate::record::units::short;

/// Why rows cannot become a recording. Row numbers count from 1 at the first row of data.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// No rows.
    #[error("it has no rows of data; record a flight with `airball simulate` or `airball run`")]
    Empty,
    /// Too few readings.
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
        /// The row.
        row: usize,
        /// Time of the row before.
        from_s: f64,
        /// Time of the row.
        to_s: f64,
    },
    /// Time is constant.
    #[error("time is {time_s} s in every row; name the column of the time in [import] time_s")]
    NoTime {
        /// The time of every row.
        time_s: f64,
    },
    /// A gap that is too long to forecast across.
    #[error(
        "no row for {} s before row {row}, {} s after the first row; cut the log there, or, if time is not in seconds \
         but, for instance, in milliseconds, write [import] time_s = {{ column = \"NAME\", scale = 0.001 }}",
        short(to_s - from_s), short(*from_s)
    )]
    Hole {
        /// The row after the gap.
        row: usize,
        /// Time of the row before, seconds after the first row.
        from_s: f64,
        /// Time of the row, seconds after the first row.
        to_s: f64,
    },
    /// A value that is not finite.
    #[error("{quantity} at row {row} is {value}; remove the row or mend the recorder")]
    NotFinite {
        /// The row.
        row: usize,
        /// The quantity.
        quantity: &'static str,
        /// The value.
        value: f64,
    },
}
