//! A CSV file as rows of cells with their line.
//!
//! The separator is a comma, semicolon or tab, whichever the header has most of; a byte order mark, CRLF and empty
//! lines are accepted.

use crate::error::RowsError;
use csv::{ReaderBuilder, StringRecord, Trim};

/// A header and its rows, all of the header's width.
pub(crate) struct Table<'a> {
    pub(crate) name: String,
    text: &'a str,
    header: StringRecord,
    rows: Vec<StringRecord>,
}

impl<'a> Table<'a> {
    /// Parses the bytes; `name` is the file's name in messages.
    pub(crate) fn parse(name: &str, bytes: &'a [u8]) -> Result<Self, RowsError> {
        let name = name.to_owned();
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}'),
            Err(error) => {
                let byte = error.valid_up_to();
                return Err(RowsError::NotUtf8 { name, line: 1 + newlines(&bytes[..byte]), byte });
            }
        };
        if text.trim().is_empty() {
            return Err(RowsError::Empty { name });
        }
        let mut reader =
            ReaderBuilder::new().delimiter(delimiter(text)).trim(Trim::All).flexible(true).from_reader(text.as_bytes());
        let not_a_table = |error: csv::Error| RowsError::NotATable { name: name.clone(), cause: error.to_string() };
        let header = reader.headers().map_err(not_a_table)?.clone();
        let mut rows = reader.into_records().collect::<Result<Vec<_>, _>>().map_err(not_a_table)?;
        while rows.last().is_some_and(|row| row.iter().all(str::is_empty)) {
            rows.pop();
        }
        if rows.is_empty() {
            return Err(RowsError::HeaderOnly { name });
        }
        let table = Self { name, text, header, rows };
        table
            .rows
            .iter()
            .position(|row| row.len() != table.header.len())
            .map_or(Ok(()), |row| Err(table.ragged(row)))?;
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

    /// The line of the header in the file, from 1.
    pub(crate) fn header_line(&self) -> usize {
        line_of(self.text, &self.header)
    }

    /// The line of a row in the file, from 1.
    pub(crate) fn line(&self, row: usize) -> usize {
        self.rows.get(row).map_or(0, |cells| line_of(self.text, cells))
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

fn delimiter(text: &str) -> u8 {
    let header = text.trim_start().lines().next().unwrap_or_default();
    let count = |delimiter: &u8| header.bytes().filter(|byte| byte == delimiter).count();
    // The last of several maxima wins: a header without any of them is that of a comma file.
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}
