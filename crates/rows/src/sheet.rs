//! A table as columns of numbers, before anybody has said what they mean.

use crate::error::RowsError;
use crate::table::Table;

/// The columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// In their order in the file.
    pub columns: Vec<SheetColumn>,
    /// Number of rows of data.
    pub rows: usize,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetColumn {
    /// Its name in the header.
    pub name: String,
    /// Its unit, where a row of units has it.
    pub unit: Option<String>,
    /// Its numbers, `None` where there is none; empty where the column holds something else.
    pub values: Vec<Option<f64>>,
}

/// Reads a CSV without a mapping. `name` is the file's name in messages.
///
/// # Errors
/// [`RowsError`]: the file is no table.
pub fn sheet(name: &str, bytes: &[u8]) -> Result<Sheet, RowsError> {
    let table = Table::parse(name, bytes)?;
    let columns = table.columns().enumerate().map(|(index, name)| SheetColumn {
        name: name.into(),
        unit: table.unit(index).map(Into::into),
        values: (0..table.len()).map(|row| value(&table, row, index)).collect::<Option<_>>().unwrap_or_default(),
    });
    Ok(Sheet { columns: columns.collect(), rows: table.len() })
}

/// The number in a cell. Outer `None`: it holds something else.
#[expect(clippy::option_option, reason = "no number, and something else than a number")]
fn value(table: &Table, row: usize, column: usize) -> Option<Option<f64>> {
    if table.cell(row, column).is_empty() {
        return Some(None);
    }
    table.number(row, column).map(|value| Some(value).filter(|value| value.is_finite()))
}
