//! Standard output and standard error, either of which may be closed at any time: `println!` would panic.

use anyhow::Result;
use std::fmt::Display;
use std::io::{ErrorKind, Write, stderr, stdout};

/// A line of the result on standard output.
pub(super) fn say(line: impl Display) -> Result<()> {
    Ok(writeln!(stdout().lock(), "{line}")?)
}

/// A word to the person at the terminal, on standard error. Nobody there is no failure.
pub fn note(line: impl Display) {
    let _ = writeln!(stderr().lock(), "airball: {line}");
}

/// Whether a command failed only because whoever read its output has left, as `head` does.
#[must_use]
pub fn reader_is_gone(error: &anyhow::Error) -> bool {
    let broken = |error: &std::io::Error| error.kind() == ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(broken))
}
