//! From the columns of a table to the rows of a recording, by the config's `[import]`.
//!
//! Equations and units are those of [`import`](crate::import).

use crate::clock::spread;
use crate::error::{CellProblem, RowsError};
use crate::hold::held;
use crate::import::{Column, Import};
use crate::sheet::Sheet;
use crate::shown::{listed, shown};
use crate::table::Table;
use crate::wrap::unwrapped;
use diagnose::Sample;

/// Finds the columns and converts their numbers.
pub(crate) fn map(table: &Table, import: &Import) -> Result<Vec<Sample>, RowsError> {
    import.check()?;
    let time = Found::required(table, "time_s", &import.time_s)?;
    let setpoint = Found::optional(table, "setpoint_mm", import.setpoint_mm.as_ref())?;
    let control = Found::optional(table, "control_percent", None)?;
    let duty = Found::required(table, "duty_percent", &import.duty_percent)?;
    let position = Found::required(table, "position_mm", &import.position_mm)?;
    let fan_rpm = Found::optional(table, "fan_rpm", import.fan_rpm.as_ref())?;
    let position2 = Found::optional(table, "position2_mm", import.position2_mm.as_ref())?;
    let fresh = Found::optional(table, "fresh", None)?;

    let mut time_s = time.times(table)?;
    check_order(table, &time_s)?;
    if import.time_s.spread {
        spread(&mut time_s);
    }
    let duty_percent = match duty.hold {
        true => duty.converted(table, &time_s)?,
        false => duty.all(table)?.into_iter().map(Some).collect(),
    };
    let position_mm = position.converted(table, &time_s)?;
    let convert = |found: Option<Found<'_>>| found.map_or(Ok(Vec::new()), |found| found.converted(table, &time_s));
    let (setpoint_mm, control_percent) = (convert(setpoint)?, convert(control)?);
    let (fan_rpm, position2_mm) = (convert(fan_rpm)?, convert(position2)?);
    let at = |values: &[Option<f64>], row: usize| values.get(row).copied().flatten();
    // A logger that writes a row twice repeats its noise as well, and two such readings are no two measurements.
    let is_copy = |row: usize| table.repeats_row_before(row) && time_s[row] == time_s[row - 1];
    let known = time_s.iter().zip(&duty_percent).enumerate().filter_map(|(row, (&time_s, duty_percent))| {
        let has_reading = [&position_mm, &fan_rpm, &position2_mm].iter().any(|of| at(of, row).is_some());
        let is_used = !is_copy(row) && (has_reading || duty.is_written(table, row));
        is_used.then_some((row, time_s, (*duty_percent)?))
    });
    let samples = known.map(|(row, time_s, duty_percent)| {
        let read = fresh.as_ref().map_or(Ok(true), |fresh| fresh.flag(table, row))?;
        Ok(Sample {
            time_s,
            setpoint_mm: at(&setpoint_mm, row),
            control_percent: at(&control_percent, row),
            duty_percent,
            position_mm: at(&position_mm, row).filter(|_| read),
            fan_rpm: at(&fan_rpm, row),
            position2_mm: at(&position2_mm, row),
        })
    });
    samples.collect()
}

/// A column of the table, and the conversion of its numbers to our units.
struct Found<'a> {
    index: usize,
    /// The column that is subtracted.
    minus: Option<usize>,
    name: &'a str,
    scale: f64,
    offset: f64,
    integrate: bool,
    hold: bool,
}

impl<'a> Found<'a> {
    fn required(table: &Table, quantity: &'static str, column: &'a Column) -> Result<Self, RowsError> {
        let missing = |name: &str| RowsError::MissingColumn {
            name: table.name.clone(),
            line: table.header_line(),
            column: name.into(),
            quantity,
            found: listed(table.columns()),
        };
        let find = |name: &str| Self::look_up(table, name)?.ok_or_else(|| missing(name));
        let minus = column.minus.as_deref().map(find).transpose()?;
        Ok(Self { minus, ..Self::at(find(&column.column)?, column) })
    }

    /// A column that `[import]` maps must exist; another one is used if a column of its own name exists.
    fn optional(table: &Table, quantity: &'static str, column: Option<&'a Column>) -> Result<Option<Self>, RowsError> {
        let Some(column) = column else {
            let index = Self::look_up(table, quantity)?;
            return Ok(index.map(|index| Self {
                index,
                minus: None,
                name: quantity,
                scale: 1.0,
                offset: 0.0,
                integrate: false,
                hold: false,
            }));
        };
        Self::required(table, quantity, column).map(Some)
    }

    fn at(index: usize, column: &'a Column) -> Self {
        let Column { column: name, scale, offset, integrate, hold, .. } = column;
        Self { index, minus: None, name, scale: *scale, offset: *offset, integrate: *integrate, hold: *hold }
    }

    fn look_up(table: &Table, name: &str) -> Result<Option<usize>, RowsError> {
        let times = table.columns().filter(|column| *column == name).count();
        if times > 1 {
            let (file, line) = (table.name.clone(), table.header_line());
            return Err(RowsError::RepeatedColumn { name: file, line, column: name.into(), times });
        }
        // The number of the row is beside the columns.
        let row = (name == Sheet::ROW).then(|| table.width());
        Ok(table.columns().position(|column| column == name).or(row))
    }

    /// The column as times, every cell a number: a counter that wraps goes on.
    fn times(&self, table: &Table) -> Result<Vec<f64>, RowsError> {
        let counts = self.numbers(table)?;
        self.in_our_units(table, unwrapped(&counts).unwrap_or(counts))
    }

    /// The column in our units, every cell a number.
    fn all(&self, table: &Table) -> Result<Vec<f64>, RowsError> {
        self.in_our_units(table, self.numbers(table)?)
    }

    fn numbers(&self, table: &Table) -> Result<Vec<f64>, RowsError> {
        let cell = |row| self.number(table, row)?.ok_or_else(|| self.wrong(table, row, CellProblem::Empty));
        (0..table.len()).map(cell).collect()
    }

    fn in_our_units(&self, table: &Table, numbers: Vec<f64>) -> Result<Vec<f64>, RowsError> {
        let ours = numbers.into_iter().map(|value| value * self.scale + self.offset);
        ours.enumerate().map(|(row, value)| self.finite(table, row, value)).collect()
    }

    /// The column in our units; a cell without a reading, empty or NaN, is `None`.
    fn converted(&self, table: &Table, time_s: &[f64]) -> Result<Vec<Option<f64>>, RowsError> {
        let raw = self.raw(table)?;
        let raw = if self.integrate { integral(&raw, time_s) } else { raw };
        let ours = raw.into_iter().map(|value| value.map(|value| value * self.scale + self.offset));
        ours.enumerate().map(|(row, value)| value.map(|value| self.finite(table, row, value)).transpose()).collect()
    }

    /// The numbers of the column, less those of the other one. Where it is held, each of both repeats its last value.
    fn raw(&self, table: &Table) -> Result<Vec<Option<f64>>, RowsError> {
        if !self.hold {
            return (0..table.len()).map(|row| self.number(table, row)).collect();
        }
        let held_of = |column: usize| {
            let cells = (0..table.len()).map(|row| self.in_column(table, row, column));
            cells.collect::<Result<Vec<_>, _>>().map(|cells| held(&cells))
        };
        let values = held_of(self.index)?;
        let Some(minus) = self.minus else { return Ok(values) };
        Ok(values.into_iter().zip(held_of(minus)?).map(|(value, other)| Some(value? - other?)).collect())
    }

    /// Whether the row has a value of its own, and does not repeat an earlier one.
    fn is_written(&self, table: &Table, row: usize) -> bool {
        !self.hold || matches!(self.in_column(table, row, self.index), Ok(Some(_)))
    }

    fn number(&self, table: &Table, row: usize) -> Result<Option<f64>, RowsError> {
        let Some(value) = self.in_column(table, row, self.index)? else { return Ok(None) };
        let Some(minus) = self.minus else { return Ok(Some(value)) };
        Ok(self.in_column(table, row, minus)?.map(|other| value - other))
    }

    /// The number in a cell; `None` where it is empty or says that there is none.
    fn in_column(&self, table: &Table, row: usize, column: usize) -> Result<Option<f64>, RowsError> {
        if column == table.width() {
            return Ok(Some(row as f64));
        }
        let cell = table.cell(row, column);
        if cell.is_empty() {
            return Ok(None);
        }
        let wrong = |problem| Err(self.wrong_in(table, row, column, problem));
        let Some(value) = table.number(row, column) else { return wrong(CellProblem::NotANumber(shown(cell))) };
        // MATLAB, numpy and C write "no reading" as NaN.
        if value.is_nan() {
            return Ok(None);
        }
        if value.is_finite() { Ok(Some(value)) } else { wrong(CellProblem::NotFinite(shown(cell))) }
    }

    fn finite(&self, table: &Table, row: usize, value: f64) -> Result<f64, RowsError> {
        let cell = || CellProblem::NotFinite(shown(table.cell(row, self.index)));
        if value.is_finite() { Ok(value) } else { Err(self.wrong(table, row, cell())) }
    }

    fn flag(&self, table: &Table, row: usize) -> Result<bool, RowsError> {
        match table.cell(row, self.index).to_ascii_lowercase().as_str() {
            "1" | "true" => Ok(true),
            "0" | "false" => Ok(false),
            other => Err(self.wrong(table, row, CellProblem::NotAFlag(shown(other)))),
        }
    }

    fn wrong(&self, table: &Table, row: usize, problem: CellProblem) -> RowsError {
        self.wrong_in(table, row, self.index, problem)
    }

    /// The error of a cell, which may be of the column that is subtracted.
    fn wrong_in(&self, table: &Table, row: usize, column: usize, problem: CellProblem) -> RowsError {
        let column = table.columns().nth(column).filter(|_| column != self.index).unwrap_or(self.name);
        RowsError::Cell { name: table.name.clone(), line: table.line(row), column: column.into(), problem }
    }
}

/// The integral by trapezoids over time, 0 at the first value. A missing value has no integral; the next step spans the
/// gap.
fn integral(values: &[Option<f64>], time_s: &[f64]) -> Vec<Option<f64>> {
    let mut sum = 0.0;
    let mut last: Option<(f64, f64)> = None;
    let integrate = |(value, &time_s): (&Option<f64>, &f64)| {
        let value = (*value)?;
        let (from_s, from) = last.unwrap_or((time_s, value));
        sum += 0.5 * (from + value) * (time_s - from_s);
        last = Some((time_s, value));
        Some(sum)
    };
    values.iter().zip(time_s).map(integrate).collect()
}

fn check_order(table: &Table, time_s: &[f64]) -> Result<(), RowsError> {
    match time_s.windows(2).position(|pair| pair[1] < pair[0]) {
        Some(row) => Err(RowsError::TimeBackwards {
            name: table.name.clone(),
            line: table.line(row + 1),
            from_line: table.line(row),
            from_s: time_s[row],
            to_s: time_s[row + 1],
        }),
        None => Ok(()),
    }
}
