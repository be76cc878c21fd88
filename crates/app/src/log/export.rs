//! A flight as a table, for programs that do not read MCAP.
//!
//! The header is the one that [`reader`](super::reader) reads, and `fresh`, without which a repeated position would
//! count as a reading. The signals of a second sensor and a tachometer are columns where the flight has them. Numbers
//! are written so that they read back as the same bits.

use crate::flight::vocabulary::Cycle;
use std::io::{self, Write};

/// The columns, in the order of the signal path.
const HEADER: [&str; 6] = ["time_s", "setpoint_mm", "control_percent", "duty_percent", "position_mm", "fresh"];

/// A column that only some flights have.
type Signal = (&'static str, fn(&Cycle) -> Option<f64>);

const SIGNALS: [Signal; 2] = [("position2_mm", |cycle| cycle.position2_mm), ("fan_rpm", |cycle| cycle.fan_rpm)];

/// Writes the cycles as CSV. An absent value is an empty cell.
///
/// # Errors
/// The writer's error.
pub fn csv(cycles: &[Cycle], to: impl Write) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(to);
    let had = |(_, of): &&Signal| cycles.iter().any(|cycle| of(cycle).is_some());
    let signals: Vec<&Signal> = SIGNALS.iter().filter(had).collect();
    csv.write_record(HEADER.into_iter().chain(signals.iter().map(|(name, _)| *name))).map_err(cause)?;
    let cell = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    for cycle in cycles {
        let always = [
            cell(Some(cycle.time_s)),
            cell(cycle.setpoint_mm),
            cell(cycle.control_percent),
            cell(Some(cycle.duty_percent)),
            cell(cycle.position_mm),
            u8::from(cycle.fresh).to_string(),
        ];
        let signals = signals.iter().map(|(_, of)| cell(of(cycle)));
        csv.write_record(always.into_iter().chain(signals)).map_err(cause)?;
    }
    csv.flush()
}

/// The writer's own error: a closed pipe must be recognised behind the error of the table.
fn cause(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}
