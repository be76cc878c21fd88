//! A table as columns of numbers, before anybody has said what they mean.

use crate::error::RowsError;
use crate::table::Table;
use crate::wrap::unwrapped;

/// The columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// In their order in the file.
    pub columns: Vec<SheetColumn>,
    /// Number of rows of data.
    pub rows: usize,
}

impl Sheet {
    /// The name by which `[import]` asks for the number of a row, from 0, in a table without a column of this name.
    pub const ROW: &str = "row";

    /// Adds the numbers of the rows as a column, if there is none of this name.
    pub fn number_rows(&mut self) {
        if self.columns.iter().all(|column| column.name != Self::ROW) {
            let values = (0..self.rows).map(|row| Some(row as f64)).collect();
            self.columns.push(SheetColumn { name: Self::ROW.into(), values, ..SheetColumn::default() });
        }
    }
}

/// A column of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SheetColumn {
    /// Its name in the header.
    pub name: String,
    /// Its unit, where a row of units has it.
    pub unit: Option<String>,
    /// Its numbers, `None` where there is none, those of a counter that wraps going on; empty where the column holds
    /// something else.
    pub values: Vec<Option<f64>>,
    /// The first cell that is no number, where others are.
    pub text: Option<TextCell>,
    /// Line of the first number that is smaller than the one in the row before.
    pub decreases_in: Option<usize>,
}

/// A cell that holds text amid numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextCell {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Its content.
    pub content: String,
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
        ..column(&table, index)
    });
    Ok(Sheet { columns: columns.collect(), rows: table.len() })
}

/// The values of a column, without its name and unit.
fn column(table: &Table, index: usize) -> SheetColumn {
    let cells: Vec<Option<Option<f64>>> = (0..table.len()).map(|row| value(table, row, index)).collect();
    let is_number = |cell: &Option<Option<f64>>| matches!(cell, Some(Some(_)));
    let text = cells.iter().position(Option::is_none).filter(|_| cells.iter().any(is_number));
    let text = text.map(|row| TextCell { line: table.line(row), content: table.cell(row, index).into() });
    let values: Vec<Option<f64>> = cells.into_iter().collect::<Option<_>>().unwrap_or_default();
    let on = values.iter().copied().collect::<Option<Vec<f64>>>().and_then(|values| unwrapped(&values));
    let values = on.map_or(values, |on| on.into_iter().map(Some).collect());
    let decreases = values.windows(2).position(|pair| pair[1].is_some() && pair[1] < pair[0]);
    let decreases_in = decreases.map(|row| table.line(row + 1));
    SheetColumn { values, text, decreases_in, ..SheetColumn::default() }
}

/// The number in a cell. Outer `None`: it holds something else.
#[expect(clippy::option_option, reason = "no number, and something else than a number")]
fn value(table: &Table, row: usize, column: usize) -> Option<Option<f64>> {
    if table.cell(row, column).is_empty() {
        return Some(None);
    }
    table.number(row, column).map(|value| Some(value).filter(|value| value.is_finite()))
}
