//! The lines of a table before they are parsed: which of them are its header and rows, and what separates their cells.
//!
//! The separator is a comma, semicolon, tab or spaces, whichever the header has most of. A byte order mark, CRLF, empty
//! lines, lines of comment (`#`, `%`, `//`), `sep=;` and what a serial monitor adds ([`crate::serial`]) are accepted. A
//! comment above rows of numbers with as many words as these have cells is their header, as numpy writes it, also
//! behind a label: `# columns: t u y`. Names with single spaces within them may stand two spaces apart. Lines above the
//! header, such as those of an oscilloscope or the first words of a microcontroller, are left out.

use crate::number::{Decimal, clock_s};
use crate::serial::{labels, take_stamps, without_labels};
use csv::StringRecord;

/// Lines of a file that are looked at for its header, chosen by hand: instruments write some twenty lines above it.
const LOOKED_AT: usize = 100;
/// Rows under a header that show that it is one. A row of another width further down is an error of its own, and does
/// not make the header one of the lines that are left out.
const ROWS: usize = 10;

/// The text of a table, line for line as in the file, and how its cells are separated.
pub(crate) struct Plain {
    pub(crate) text: String,
    pub(crate) delimiter: u8,
    /// The names of the columns that are no row of the text: of the comment right above the rows, or of their labels.
    pub(crate) names: Option<StringRecord>,
    /// Whether the last cell of each row is the timestamp of a serial monitor.
    pub(crate) stamp: bool,
}

/// Reads the lines of a text.
pub(crate) fn plain(text: &str) -> Plain {
    let mut lines: Vec<&str> = text.split('\n').collect();
    let mut delimiter = None;
    if let Some(named) = lines.first().and_then(|first| first.trim().strip_prefix("sep=")) {
        delimiter = named.bytes().next();
        lines[0] = "";
    }
    let stamps = take_stamps(&mut lines);
    let mut first = header(&lines).unwrap_or(lines.len());
    let spaced = names_with_spaces(&lines, first);
    if spaced.is_some() {
        first += 1;
    }
    let head = lines.get(first).copied().unwrap_or_default();
    let separator = delimiter.unwrap_or_else(|| separator(head));
    let width = cells(head, separator).len();
    let mut comments = lines[..first].iter().rev().filter_map(|line| of_comment(line));
    let named = comments.find_map(|comment| names_of(comment, separator, width));
    lines[..first].fill("");
    let labels = labels(&cells(head, separator));
    // Any number of spaces separates two cells.
    let delimiter = if separator == b' ' { b'\t' } else { separator };
    let between = char::from(delimiter).to_string();
    let mut plain = String::with_capacity(text.len());
    for (at, line) in lines.iter().enumerate() {
        if !is_blank(line) {
            let unlabelled = labels.as_ref().and_then(|labels| without_labels(&cells(line, separator), labels));
            match unlabelled.or_else(|| (separator == b' ').then(|| cells(line, separator))) {
                Some(cells) => plain.push_str(&cells.join(&between)),
                None => plain.push_str(line),
            }
            if let Some(stamp) = stamps.get(at) {
                plain.push_str(&between);
                plain.push_str(stamp);
            }
        }
        plain.push('\n');
    }
    let names = labels.or(spaced).or(named).map(|names| {
        let stamp = stamps.first().map(|_| "");
        names.into_iter().chain(stamp).collect::<StringRecord>()
    });
    Plain { text: plain, delimiter, names, stamp: !stamps.is_empty() }
}

/// The line of the header: names, as many as the cells of the rows under it, with no such row above. Where there is
/// none, the first line that holds something.
fn header(lines: &[&str]) -> Option<usize> {
    let held = lines.iter().enumerate().filter(|(_, line)| !is_blank(line)).take(LOOKED_AT);
    let held: Vec<(usize, &str)> = held.map(|(at, line)| (at, *line)).collect();
    let is_header = |at: &usize| {
        let separator = separator(held[*at].1);
        let names = cells(held[*at].1, separator);
        let is_row = |line: &str| {
            let cells = cells(line, separator);
            cells.len() == names.len() && cells.iter().any(|cell| is_number(cell))
        };
        // Between names and rows there may be a row of units.
        let under: Vec<&str> = held.iter().skip(at + 2).take(ROWS).map(|(_, line)| *line).collect();
        let as_wide = held.get(at + 1).is_some_and(|(_, line)| cells(line, separator).len() == names.len());
        let named = names.len() > 1 && !names.iter().any(|cell| is_number(cell));
        named
            && as_wide
            && !under.is_empty()
            && under.iter().all(|line| is_row(line))
            && !held[..*at].iter().any(|(_, line)| is_row(line))
    };
    let first = (0..held.len()).find(is_header).unwrap_or(0);
    held.get(first).map(|(at, _)| *at)
}

/// Whether a line holds neither names nor numbers.
fn is_blank(line: &str) -> bool {
    line.trim().is_empty() || of_comment(line).is_some()
}

fn is_number(cell: &str) -> bool {
    Decimal::Point.number(cell).or_else(|| Decimal::Comma.number(cell)).or_else(|| clock_s(cell)).is_some()
}

/// The cells of a line, without the spaces around them. Quotes are left to the parser.
fn cells(line: &str, separator: u8) -> Vec<&str> {
    match separator {
        b' ' => line.split_whitespace().collect(),
        separator => line.split(char::from(separator)).map(str::trim).collect(),
    }
}

/// What stands behind the mark of a line of comment.
fn of_comment(line: &str) -> Option<&str> {
    let line = line.trim();
    let names = ["#", "%", "//"].iter().find_map(|mark| line.strip_prefix(mark))?;
    // A spreadsheet's error in the first cell is no comment.
    (!line.starts_with("#N/A")).then(|| names.trim_start_matches(['#', '%', '/']).trim())
}

/// The names of so many columns in a comment, also behind a label. Spaces or tabs separate them where these separate
/// the cells.
fn names_of(comment: &str, separator: u8, width: usize) -> Option<Vec<&str>> {
    let separator = if separator == b'\t' { b' ' } else { separator };
    let behind_label = comment.split_once(':').map(|(_, names)| names);
    [behind_label, Some(comment)]
        .into_iter()
        .flatten()
        .map(|text| cells(text, separator))
        .find(|names| width > 1 && names.len() == width && !names.iter().any(|name| name.is_empty() || is_number(name)))
}

/// The names of a header that two spaces or more separate, since single ones stand within the names, if the line below
/// has as many cells and the header has another number of words.
fn names_with_spaces<'a>(lines: &[&'a str], header: usize) -> Option<Vec<&'a str>> {
    let (head, row) = (lines.get(header)?, lines.get(header + 1)?);
    let names: Vec<&str> = head.split("  ").map(str::trim).filter(|name| !name.is_empty()).collect();
    let width = cells(row, separator(row)).len();
    let is_by_spaces = separator(head) == b' ' && cells(head, b' ').len() != width && names.len() == width;
    (is_by_spaces && width > 1 && !names.iter().any(|name| is_number(name))).then_some(names)
}

/// The separator of a line: the most frequent of tab, semicolon and comma; spaces where there is none of them.
fn separator(line: &str) -> u8 {
    let count = |delimiter: &u8| line.bytes().filter(|byte| byte == delimiter).count();
    let usual = [b'\t', b';', b','].into_iter().max_by_key(count).filter(|delimiter| count(delimiter) > 0);
    usual.unwrap_or_else(|| if line.split_whitespace().count() > 1 { b' ' } else { b',' })
}
