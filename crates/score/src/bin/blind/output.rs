//! Standard output and standard error, either of which may be closed at any time: `println!` would panic.

use anyhow::Result;
use std::fmt::Display;
use std::io::{ErrorKind, Write, stderr, stdout};

/// A line of the result on standard output.
pub(crate) fn say(line: impl Display) -> Result<()> {
    Ok(writeln!(stdout().lock(), "{line}")?)
}

/// A note for the user at the terminal, on standard error. A closed standard error is not a failure.
pub(crate) fn note(line: impl Display) {
    let _ = writeln!(stderr().lock(), "blind: {line}");
}

/// An error, with those of its causes that its own text does not name.
pub(crate) fn with_causes(error: &anyhow::Error) -> String {
    let in_a_line = |words: &str| words.split_whitespace().collect::<Vec<_>>().join(" ");
    error.chain().skip(1).map(|cause| in_a_line(&cause.to_string())).fold(error.to_string(), |said, cause| {
        if in_a_line(&said).contains(&cause) { said } else { format!("{said}; the cause: {cause}") }
    })
}

/// Whether the program failed only because the reader of its output has closed it, as `head` does.
pub(crate) fn reader_is_gone(error: &anyhow::Error) -> bool {
    let broken = |error: &std::io::Error| error.kind() == ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(broken))
}
