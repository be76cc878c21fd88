//! A CSV file as rows of cells with their line.
//!
//! A row of units under the header is accepted. What is read off the lines before they are parsed, the separator among
//! it, is in [`plain`](mod@crate::plain). Without any header the columns are called `column1`, ….

use crate::error::RowsError;
use crate::foreign::foreign;
use crate::number::{Decimal, clock_s};
use crate::plain::{Plain, plain};
use crate::serial::STAMP;
use crate::text::decoded;
use csv::{ReaderBuilder, StringRecord, Trim};

/// A header and its rows, all of the header's width.
pub(crate) struct Table {
    pub(crate) name: String,
    /// The text of the file, comments blanked, line for line.
    text: String,
    header: StringRecord,
    header_line: usize,
    units: Option<StringRecord>,
    rows: Rows,
    decimal: Decimal,
    /// The last line, if it was left out because its row is not complete.
    cut: Option<usize>,
}

/// All rows of a file, header and units among them. The cells lie one behind another in one text: a record of the
/// parser for each row would take five times the memory of the file.
#[derive(Default)]
struct Rows {
    cells: String,
    /// Where each cell ends.
    ends: Vec<usize>,
    rows: Vec<Row>,
    /// How many of the rows are header and units.
    before: usize,
}

/// A row of the file.
#[derive(Clone, Copy)]
struct Row {
    /// Where it begins in the text.
    byte: usize,
    /// Its first cell, and the number of its cells.
    first: usize,
    count: usize,
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
        let Plain { text, delimiter, names, stamp } = plain(&decoded);
        let is_ended = decoded.ends_with(['\n', '\r']);
        drop(decoded);
        let mut rows = Rows::of(name, &text, delimiter)?;
        let decimal = Decimal::of(rows.all_cells());
        let is_number = |cell: &str| decimal.number(cell).is_some() || clock_s(cell).is_some();
        let first = rows.record(0).ok_or_else(|| RowsError::HeaderOnly { name: name.into() })?;
        let header_line = rows.line(&text, 0);
        let is_row = first.iter().all(|cell| cell.is_empty() || is_number(cell)) && first.iter().any(is_number);
        let header = if is_row {
            let named = names.filter(|names| names.len() == first.len());
            named.unwrap_or_else(|| (1..=first.len()).map(|number| format!("column{number}")).collect())
        } else {
            rows.before += 1;
            first
        };
        let header = if stamp { with_stamp(&header) } else { header };
        let has = |row: usize| rows.record(row).is_some_and(|cells| cells.iter().any(is_number));
        let units = rows.record(0).filter(|units| !has(0) && has(1) && units.len() == header.len());
        rows.before += usize::from(units.is_some());
        if rows.len() == 0 {
            return Err(RowsError::HeaderOnly { name: name.into() });
        }
        let cut = if is_ended { None } else { rows.drop_short_last(&text, header.len()) };
        let table = Self { name: name.into(), text, header, header_line, units, rows, decimal, cut };
        let ragged = (0..table.len()).find(|row| table.rows.width(*row) != table.header.len());
        ragged.map_or(Ok(()), |row| Err(table.ragged(row)))?;
        Ok(table)
    }

    /// What is missing at the end of the file, in words.
    pub(crate) fn loss(&self) -> Option<String> {
        let line = self.cut?;
        Some(format!("its last line, {line}, is an incomplete row and was left out: the recording was cut off there"))
    }

    /// Number of rows of data.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Number of columns.
    pub(crate) fn width(&self) -> usize {
        self.header.len()
    }

    /// The names of the columns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = &str> {
        self.header.iter()
    }

    /// A cell, without the spaces around it. Rows and columns count from 0.
    pub(crate) fn cell(&self, row: usize, column: usize) -> &str {
        self.rows.cell(row, column)
    }

    /// Whether each cell of a row is as in the row before.
    pub(crate) fn repeats_row_before(&self, row: usize) -> bool {
        row > 0 && (0..self.width()).all(|column| self.cell(row, column) == self.cell(row - 1, column))
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
        self.rows.line(&self.text, row)
    }

    fn ragged(&self, row: usize) -> RowsError {
        let (name, found) = (self.name.clone(), self.rows.width(row));
        let expected = self.header.len();
        if self.len() > 1 && (0..self.len()).all(|other| self.rows.width(other) == found) {
            return RowsError::HeaderMismatch { name, line: self.header_line(), expected, found };
        }
        RowsError::Ragged { name, line: self.line(row), expected, found }
    }
}

impl Rows {
    /// All rows, of any width, without the empty ones at the end.
    fn of(name: &str, text: &str, delimiter: u8) -> Result<Self, RowsError> {
        let mut reader = ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .trim(Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let not_a_table = |error: csv::Error| RowsError::NotATable { name: name.into(), cause: error.to_string() };
        let (mut found, mut record) = (Self::default(), StringRecord::new());
        while reader.read_record(&mut record).map_err(not_a_table)? {
            found.rows.push(Row { byte: byte_of(&record), first: found.ends.len(), count: record.len() });
            for cell in &record {
                found.cells.push_str(cell);
                found.ends.push(found.cells.len());
            }
        }
        let is_empty = |row: &Row| (row.first..row.first + row.count).all(|cell| found.text_of(cell).is_empty());
        let kept = found.rows.iter().rposition(|row| !is_empty(row)).map_or(0, |last| last + 1);
        found.rows.truncate(kept);
        Ok(found)
    }

    /// Drops the last row if it has fewer cells than `width`, and others remain. Returns its line.
    fn drop_short_last(&mut self, text: &str, width: usize) -> Option<usize> {
        let last = self.len().checked_sub(2)? + 1;
        let line = (self.width(last) < width).then(|| self.line(text, last))?;
        self.rows.pop();
        Some(line)
    }

    /// The text of a cell, counted from the first of the first row.
    fn text_of(&self, cell: usize) -> &str {
        let start = cell.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        self.ends.get(cell).and_then(|end| self.cells.get(start..*end)).unwrap_or_default()
    }

    fn all_cells(&self) -> impl Iterator<Item = &str> {
        (0..self.ends.len()).map(|cell| self.text_of(cell))
    }

    /// A row of data.
    fn row(&self, row: usize) -> Option<Row> {
        self.rows.get(self.before.checked_add(row)?).copied()
    }

    fn len(&self) -> usize {
        self.rows.len().saturating_sub(self.before)
    }

    fn width(&self, row: usize) -> usize {
        self.row(row).map_or(0, |row| row.count)
    }

    fn cell(&self, row: usize, column: usize) -> &str {
        self.row(row).filter(|row| column < row.count).map_or("", |row| self.text_of(row.first + column))
    }

    /// A row as the parser gave it.
    fn record(&self, row: usize) -> Option<StringRecord> {
        self.row(row).map(|_| (0..self.width(row)).map(|column| self.cell(row, column)).collect())
    }

    fn line(&self, text: &str, row: usize) -> usize {
        self.row(row).map_or(0, |row| line_of(text, row.byte))
    }
}

/// A header whose last column is the timestamps.
fn with_stamp(header: &StringRecord) -> StringRecord {
    header.iter().take(header.len().saturating_sub(1)).chain([STAMP]).collect()
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
