//! Text of a foreign file for a message: short, and without effect on a terminal.

use std::fmt::Write;

/// Longest text that is shown, characters.
const LONGEST: usize = 60;

/// Most names that a list shows.
const MOST: usize = 20;

/// The text with its control characters escaped. Line ends and tabs are kept.
#[must_use]
pub fn printable(text: &str) -> String {
    escaped(text.chars(), |letter| matches!(letter, '\n' | '\t'))
}

/// The first 60 characters of a text from a file, control characters, line ends and tabs escaped.
#[must_use]
pub fn shown(text: &str) -> String {
    let mut short = escaped(text.chars().take(LONGEST), |_| false);
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}

/// The first 20 of some names, and the number of the others.
pub(crate) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let (mut first, mut others) = (Vec::new(), 0);
    for name in names {
        if first.len() < MOST { first.push(format!("`{}`", shown(name))) } else { others += 1 }
    }
    let list = first.join(", ");
    if others > 0 { format!("{list} and {others} more") } else { list }
}

/// Escaped as TOML and JSON do, so that a document of these stays one. Marks that turn the direction of text are no
/// control characters, and hide text as well.
fn escaped(letters: impl Iterator<Item = char>, kept: impl Fn(char) -> bool) -> String {
    let turns = |letter| matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    letters.fold(String::new(), |mut text, letter| {
        if (letter.is_control() || turns(letter)) && !kept(letter) {
            // Writing to a string cannot fail.
            let _ = write!(text, "\\u{:04x}", u32::from(letter));
        } else {
            text.push(letter);
        }
        text
    })
}
