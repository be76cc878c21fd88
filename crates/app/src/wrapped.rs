//! Sentences wrapped to the width of a terminal.

use textwrap::{Options, WordSeparator, WordSplitter, fill};

/// Narrower terminals get lines of this width.
const NARROWEST: usize = 40;
/// A line is indented below its label up to this column, where the label of a line is followed by two spaces or more.
const DEEPEST: usize = 26;
/// Columns of a table are separated by two spaces or more; a line of prose with a label has fewer of these gaps.
const GAPS_OF_A_ROW: usize = 3;

/// The text with its long lines of prose wrapped, the continuations indented below the text of the line. Rows of tables
/// stay whole.
pub fn wrapped(text: &str, width: usize) -> String {
    let lines = text.split('\n').map(|line| {
        if is_row(line) {
            return line.to_owned();
        }
        let indent = " ".repeat(label(line));
        let options = Options::new(width.max(NARROWEST)).subsequent_indent(&indent).break_words(false);
        let options = options.word_separator(WordSeparator::AsciiSpace).word_splitter(WordSplitter::NoHyphenation);
        fill(line, options)
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Whether a line belongs to a table.
fn is_row(line: &str) -> bool {
    let gaps = line.trim().split("  ").filter(|words| !words.trim().is_empty()).count().saturating_sub(1);
    line.starts_with(['─', '═']) || gaps >= GAPS_OF_A_ROW
}

/// The column at which the text of a line begins: behind its indent, or behind a label and two spaces or more.
fn label(line: &str) -> usize {
    let text = line.trim_start();
    let indent = line.len() - text.len();
    let behind = text.find("  ").map_or(0, |end| end + text[end..].len() - text[end..].trim_start().len());
    [indent + behind, indent].into_iter().find(|column| *column <= DEEPEST).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    #[test]
    fn a_sentence_is_wrapped_and_a_word_that_is_too_long_stays_whole() {
        let path = "a/".repeat(30);
        let text = format!("the file {path} cannot be read; check its name and its permissions");
        let said = wrapped(&text, 50);
        assert_eq!(said, format!("the file\n{path}\ncannot be read; check its name and its permissions"));
    }

    #[test]
    fn continuations_stand_below_the_text_behind_a_label_or_an_indent() {
        let flight = "flight    60.0 s, 3000 cycles, 0 late (worst 0.0 ms), 0 missed";
        assert_eq!(wrapped(flight, 40), "flight    60.0 s, 3000 cycles, 0 late\n          (worst 0.0 ms), 0 missed");
        let mend = "                       mend: set the pipe upright";
        assert_eq!(wrapped(mend, 40), format!("{0}mend: set the\n{0}pipe upright", " ".repeat(23)));
    }

    #[test]
    fn rows_of_tables_stay_whole() {
        let row = "as believed                   3.08    5.72    8.78     17.37";
        let boxed = " forecast ahead      model   the ball stays put   noise alone   model / noise ";
        let rule = "─".repeat(80);
        for line in [row, boxed, &rule] {
            assert_eq!(wrapped(line, 40), line);
        }
    }
}
