//! `airball log info` and `airball log export`.

use super::{note, say};
use crate::log::{export, flight};
use crate::report::summary::Summary;
use anyhow::Result;
use std::path::Path;

/// Says what is in a log.
///
/// # Errors
/// A log that cannot be read.
pub fn info(path: &Path) -> Result<()> {
    let log = flight::read(path)?;
    if let Some(lost) = &log.truncated {
        note(format_args!("{}: {lost}", path.display()));
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
