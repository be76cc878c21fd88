//! A complete log from the readable parts of a damaged one.

use super::LogError;
use super::flight::Flight;
use super::header::{Header, SIMULATED_START};
use super::writer::{LogSummary, LogWriter};
use std::io::{Seek, Write};
use std::path::Path;

/// Placeholder for lost metadata.
const UNKNOWN: &str = "unknown";

/// Writes the flight to a new file at `path`: cycles and events in the order of time, with schemas and summary.
///
/// # Errors
/// [`LogError`]: the file already exists or cannot be written.
pub fn write(flight: &Flight, path: &Path) -> Result<LogSummary, LogError> {
    copy(flight, LogWriter::create(path, &header(flight))?)
}

/// The metadata of the new log.
#[must_use]
pub fn header(flight: &Flight) -> Header {
    let about = &flight.about;
    let text = |known: &Option<String>| known.clone().unwrap_or_else(|| UNKNOWN.into());
    let started = about.started.as_deref().and_then(|at| humantime::parse_rfc3339(at).ok());
    Header {
        version: text(&about.version),
        command: text(&about.command),
        seed: about.seed,
        started: started.unwrap_or(SIMULATED_START),
        config_toml: flight.config_toml.clone().unwrap_or_default(),
    }
}

/// Writes the flight into an empty log.
///
/// # Errors
/// [`LogError::Write`].
pub fn copy<W: Write + Seek>(flight: &Flight, mut log: LogWriter<W>) -> Result<LogSummary, LogError> {
    let mut events = flight.events.iter().peekable();
    for cycle in &flight.cycles {
        while let Some(event) = events.next_if(|event| event.time_s < cycle.time_s) {
            log.message(event)?;
        }
        log.cycle(cycle)?;
    }
    for event in events {
        log.message(event)?;
    }
    log.finish()
}
