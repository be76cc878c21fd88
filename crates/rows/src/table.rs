//! A CSV file as rows of cells with their line.
//!
//! The separator is a comma, semicolon or tab, whichever the header has most of; a byte order mark, CRLF and empty
//! lines are accepted.

use crate::error::RowsError;
use csv::{ReaderBuilder, StringRecord, Trim};

/// A header and its rows, all of the header's width. The cells lie one behind another in one text: a record of the parser
/// for each row would take five times the memory of the file.
pub(crate) struct Table<'a> {
    pub(crate) name: String,
    text: &'a str,
    header: StringRecord,
    cells: String,
    /// Where each cell ends.
    ends: Vec<usize>,
    rows: Vec<Row>,
}

/// A row of the table.
struct Row {
    /// Where it begins in the file's text.
    byte: usize,
    /// Its first cell, and the number of its cells.
    first: usize,
    count: usize,
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
        let mut table = Self::of_text(text, name)?;
        while table.rows.last().is_some_and(|row| table.is_empty(row)) {
            table.rows.pop();
        }
        if table.rows.is_empty() {
            return Err(RowsError::HeaderOnly { name: table.name });
        }
        table.rows.iter().find(|row| row.count != table.header.len()).map_or(Ok(()), |row| Err(table.ragged(row)))?;
        Ok(table)
    }

    /// Header and all rows, of any width.
    fn of_text(text: &'a str, name: String) -> Result<Self, RowsError> {
        let mut reader =
            ReaderBuilder::new().delimiter(delimiter(text)).trim(Trim::All).flexible(true).from_reader(text.as_bytes());
        let not_a_table = |error: csv::Error| RowsError::NotATable { name: name.clone(), cause: error.to_string() };
        let header = reader.headers().map_err(not_a_table)?.clone();
        let (mut cells, mut ends, mut rows) = (String::new(), Vec::new(), Vec::new());
        let mut record = StringRecord::new();
        while reader.read_record(&mut record).map_err(not_a_table)? {
            rows.push(Row { byte: byte_of(&record), first: ends.len(), count: record.len() });
            for cell in &record {
                cells.push_str(cell);
                ends.push(cells.len());
            }
        }
        Ok(Self { name, text, header, cells, ends, rows })
    }

    fn is_empty(&self, row: &Row) -> bool {
        (row.first..row.first + row.count).all(|cell| self.text_of(cell).is_empty())
    }

    /// The text of a cell, counted from the first of the first row.
    fn text_of(&self, cell: usize) -> &str {
        let start = cell.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        self.ends.get(cell).and_then(|end| self.cells.get(start..*end)).unwrap_or_default()
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
        self.rows.get(row).filter(|row| column < row.count).map_or("", |row| self.text_of(row.first + column))
    }

    /// The line of the header in the file, from 1.
    pub(crate) fn header_line(&self) -> usize {
        line_of(self.text, byte_of(&self.header))
    }

    /// The line of a row in the file, from 1.
    pub(crate) fn line(&self, row: usize) -> usize {
        self.rows.get(row).map_or(0, |row| line_of(self.text, row.byte))
    }

    fn ragged(&self, row: &Row) -> RowsError {
        let line = line_of(self.text, row.byte);
        RowsError::Ragged { name: self.name.clone(), line, expected: self.header.len(), found: row.count }
    }
}

/// Where a record begins in the text.
fn byte_of(record: &StringRecord) -> usize {
    record.position().map_or(0, |position| usize::try_from(position.byte()).unwrap_or(usize::MAX))
}

/// Counted from the record's byte: the parser's own line is that of the empty lines before it.
fn line_of(text: &str, byte: usize) -> usize {
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
