//! A CSV file as rows of cells with their line.
//!
//! The separator is a comma, semicolon, tab or spaces, whichever the header has most of. A byte order mark, CRLF, empty
//! lines, lines of comment (`#`, `%`, `//`), a row of units under the header and `sep=;` are accepted. A comment right
//! above rows of numbers is their header, as numpy writes it; without any header the columns are called `column1`, ….

use crate::error::RowsError;
use crate::foreign::foreign;
use crate::number::{Decimal, clock_s};
use crate::text::decoded;
use csv::{ReaderBuilder, StringRecord, Trim};
use std::fmt::Write;

/// A header and its rows, all of the header's width.
pub(crate) struct Table {
    pub(crate) name: String,
    /// The text of the file, comments blanked, line for line.
    text: String,
    header: StringRecord,
    header_line: usize,
    units: Option<StringRecord>,
    rows: Vec<StringRecord>,
    decimal: Decimal,
}

impl Table {
    /// Parses the bytes; `name` is the file's name in messages.
    pub(crate) fn parse(name: &str, bytes: &[u8]) -> Result<Self, RowsError> {
        if let Some((format, advice)) = foreign(bytes) {
            return Err(RowsError::Foreign { name: name.into(), format, advice });
        }
        let decoded = decoded(name, bytes)?;
        if decoded.trim().is_empty() {
            return Err(RowsError::Empty { name: name.into() });
        }
        let Plain { text, delimiter, comment } = plain(&decoded);
        let mut rows = records(name, &text, delimiter)?;
        while rows.last().is_some_and(|row| row.iter().all(str::is_empty)) {
            rows.pop();
        }
        let decimal = if delimiter == b',' { Decimal::Point } else { Decimal::of(rows.iter().flatten()) };
        let is_number = |cell: &str| decimal.number(cell).is_some() || clock_s(cell).is_some();
        let first = rows.first().ok_or_else(|| RowsError::HeaderOnly { name: name.into() })?;
        let header_line = line_of(&text, first);
        let header = if first.iter().all(is_number) {
            let named = comment.filter(|names| names.len() == first.len());
            named.unwrap_or_else(|| (1..=first.len()).map(|number| format!("column{number}")).collect())
        } else {
            rows.remove(0)
        };
        let has = |row: usize| rows.get(row).is_some_and(|cells: &StringRecord| cells.iter().any(is_number));
        let units = !rows.is_empty() && !has(0) && has(1) && rows[0].len() == header.len();
        let units = units.then(|| rows.remove(0));
        if rows.is_empty() {
            return Err(RowsError::HeaderOnly { name: name.into() });
        }
        let table = Self { name: name.into(), text, header, header_line, units, rows, decimal };
        let ragged = table.rows.iter().position(|row| row.len() != table.header.len());
        ragged.map_or(Ok(()), |row| Err(table.ragged(row)))?;
        Ok(table)
    }

    /// Number of rows of data.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The names of the columns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = &str> {
        self.header.iter()
    }

    /// A cell, without the spaces around it. Rows and columns count from 0.
    pub(crate) fn cell(&self, row: usize, column: usize) -> &str {
        self.rows.get(row).and_then(|cells| cells.get(column)).unwrap_or_default()
    }

    /// A cell of the row of units under the header, if there is one.
    pub(crate) fn unit(&self, column: usize) -> Option<&str> {
        self.units.as_ref()?.get(column).filter(|unit| !unit.is_empty())
    }

    /// The number or the moment in a cell; NaN where it says that there is none. `None`: it is something else.
    pub(crate) fn number(&self, row: usize, column: usize) -> Option<f64> {
        let cell = self.cell(row, column);
        self.decimal.number(cell).or_else(|| clock_s(cell))
    }

    /// The line of the header in the file, from 1.
    pub(crate) fn header_line(&self) -> usize {
        self.header_line
    }

    /// The line of a row in the file, from 1.
    pub(crate) fn line(&self, row: usize) -> usize {
        self.rows.get(row).map_or(0, |cells| line_of(&self.text, cells))
    }

    fn ragged(&self, row: usize) -> RowsError {
        let found = self.rows.get(row).map_or(0, StringRecord::len);
        RowsError::Ragged { name: self.name.clone(), line: self.line(row), expected: self.header.len(), found }
    }
}

/// Counted from the record's byte: the parser's own line is that of the empty lines before it.
fn line_of(text: &str, record: &StringRecord) -> usize {
    let byte = record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(usize::MAX));
    let (before, rest) = text.as_bytes().split_at(byte.min(text.len()));
    let empty = rest.iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    1 + newlines(before) + newlines(&rest[..empty])
}

fn newlines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

/// A text without its comments, and how its cells are separated.
struct Plain {
    text: String,
    delimiter: u8,
    /// The cells of the comment right above the rows.
    comment: Option<StringRecord>,
}

fn plain(text: &str) -> Plain {
    let mut lines: Vec<&str> = text.split('\n').collect();
    let mut delimiter = None;
    if let Some(named) = lines.first().and_then(|first| first.trim().strip_prefix("sep=")) {
        delimiter = named.bytes().next();
        lines[0] = "";
    }
    let first = lines.iter().position(|line| !line.trim().is_empty() && of_comment(line).is_none());
    let above = first.and_then(|first| lines[..first].iter().rev().find_map(|line| of_comment(line)));
    let head = first.and_then(|first| lines.get(first)).copied().unwrap_or_default();
    let delimiter = delimiter.unwrap_or_else(|| separator(head));
    let spaces = delimiter == b' ';
    let separated = |line: &str| line.split_whitespace().collect::<Vec<_>>().join("\t");
    let mut plain = String::with_capacity(text.len());
    for line in &lines {
        match line {
            line if of_comment(line).is_some() => {}
            // Writing to a string cannot fail.
            line if spaces => drop(write!(plain, "{}", separated(line))),
            line => plain.push_str(line),
        }
        plain.push('\n');
    }
    let delimiter = if spaces { b'\t' } else { delimiter };
    let cells = |names: &str| {
        let names = if spaces { separated(names) } else { names.into() };
        names.split(char::from(delimiter)).map(str::trim).collect::<StringRecord>()
    };
    Plain { text: plain, delimiter, comment: above.map(cells) }
}

/// What stands behind the mark of a line of comment.
fn of_comment(line: &str) -> Option<&str> {
    let line = line.trim();
    let names = ["#", "%", "//"].iter().find_map(|mark| line.strip_prefix(mark))?;
    // A spreadsheet's error in the first cell is no comment.
    (!line.starts_with("#N/A")).then(|| names.trim_start_matches(['#', '%', '/']).trim())
}

/// The separator of a line: the most frequent of tab, semicolon and comma; spaces where there is none of them.
fn separator(line: &str) -> u8 {
    let count = |delimiter: &u8| line.bytes().filter(|byte| byte == delimiter).count();
    let usual = [b'\t', b';', b','].into_iter().max_by_key(count).filter(|delimiter| count(delimiter) > 0);
    usual.unwrap_or_else(|| if line.split_whitespace().count() > 1 { b' ' } else { b',' })
}

fn records(name: &str, text: &str, delimiter: u8) -> Result<Vec<StringRecord>, RowsError> {
    let reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .trim(Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let not_a_table = |error: csv::Error| RowsError::NotATable { name: name.into(), cause: error.to_string() };
    reader.into_records().collect::<Result<_, _>>().map_err(not_a_table)
}
