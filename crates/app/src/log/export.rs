//! A flight as a table, for whatever reads no MCAP.
//!
//! The header is the one that [`reader`](super::reader) reads, and `fresh`, without which a repeated position would
//! pass for a reading. Numbers are written so that they read back as the same bits.

use super::record::Cycle;
use std::io::{self, Write};

/// The columns, in the order of the signal path.
const HEADER: [&str; 6] = ["time_s", "setpoint_mm", "control_percent", "duty_percent", "position_mm", "fresh"];

/// Writes the cycles as CSV. What is absent is an empty cell.
///
/// # Errors
/// What the writer said.
pub fn csv(cycles: &[Cycle], to: impl Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(to);
    csv.write_record(HEADER).map_err(cause)?;
    let cell = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    for cycle in cycles {
        csv.write_record([
            cell(Some(cycle.time_s)),
            cell(cycle.setpoint_mm),
            cell(cycle.control_percent),
            cell(Some(cycle.duty_percent)),
            cell(cycle.position_mm),
            u8::from(cycle.fresh).to_string(),
        ])
        .map_err(cause)?;
    }
    csv.flush()
}

/// What the writer itself said: a pipe that is closed must be recognised behind the table.
fn cause(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}
