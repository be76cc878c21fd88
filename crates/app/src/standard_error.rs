//! Lines on standard error, which may be closed at any time: `eprintln!` would panic.

use crate::wrapped::wrapped;
use rows::printable;
use std::fmt::Display;
use std::io::{Write, stderr};
use std::os::fd::AsFd;
use terminal_size::{Width, terminal_size_of};

/// Something to know. A closed standard error is not a failure.
pub fn note(line: impl Display) {
    line_of("note", line);
}

/// Something to look at: the command goes on, and its result may not be what was asked for.
pub fn warn(line: impl Display) {
    line_of("warning", line);
}

/// What went wrong.
pub fn fail(line: impl Display) {
    line_of("error", line);
}

fn line_of(kind: &str, line: impl Display) {
    plain(format_args!("{kind}: {line}"));
}

/// A line that says itself what kind it is.
pub fn plain(line: impl Display) {
    let to = stderr().lock();
    let text = for_reader(&to, &line.to_string());
    let _ = writeln!({ to }, "{text}");
}

/// Control characters escaped, and lines wrapped where the reader is a terminal.
pub fn for_reader(to: impl AsFd, text: &str) -> String {
    let text = printable(text);
    match terminal_size_of(to) {
        Some((Width(columns), _)) => wrapped(&text, columns.into()),
        None => text,
    }
}
