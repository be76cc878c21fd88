//! `airball log info`, `airball log export` and `airball log recover`.

use super::{say, warn};
use crate::log::{export, flight, recover as mended};
use crate::report::flight::summary::Summary;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Exit status of a recovery that lost something.
const LOSSY: u8 = 3;

/// Prints the contents of a log.
///
/// # Errors
/// A log that cannot be read.
pub fn info(path: &Path) -> Result<()> {
    let log = flight::read(path)?;
    if let Some(lost) = &log.truncated {
        warn(format_args!("{}: {lost}", path.display()));
    }
    let about = &log.about;
    say(format_args!("command   {}", about.command.as_deref().unwrap_or("unknown")))?;
    say(format_args!("version   {}", about.version.as_deref().unwrap_or("unknown")))?;
    say(format_args!("started   {}", about.started.as_deref().unwrap_or("unknown")))?;
    if let Some(seed) = about.seed {
        say(format_args!("seed      {seed}"))?;
    }
    say(Summary::of(&log.cycles, None).to_string().trim_end())?;
    for event in &log.events {
        say(format_args!("{:9.3} s  {:<8} {}", event.time_s, event.kind, event.text))?;
    }
    Ok(())
}

/// Writes the cycles of a log as CSV to standard output.
///
/// # Errors
/// A log that cannot be read, or an output that cannot be written.
pub fn export(path: &Path) -> Result<()> {
    let log = flight::read(path)?;
    export::csv(&log.cycles, std::io::stdout().lock())?;
    Ok(())
}

/// Writes a whole log from the readable parts of a damaged one, and prints what is lost. Returns the exit status: 0 for
/// a complete log, 3 for less; an error if nothing could be read.
///
/// # Errors
/// A log of which nothing can be read, or a new one that cannot be written.
pub fn recover(path: &Path, out: Option<&Path>) -> Result<u8> {
    let flight = flight::read(path)?;
    let out = out.map_or_else(|| path.with_extension("recovered.mcap"), PathBuf::from);
    let written = mended::write(&flight, &out)?;
    say(format_args!("{}: {} cycles, {} events", out.display(), written.cycles, written.events))?;
    if flight.complete {
        say("all of the flight is in it")?;
        return Ok(0);
    }
    let lost = flight.truncated.unwrap_or_else(|| "the log does not say how the flight ended".into());
    warn(format_args!("some of the flight is lost: {lost}"));
    Ok(LOSSY)
}
