//! The columns that a record was read from, and how a finding changes their conversion.
//!
//! ```text
//! quantity = value·scale + offset                                       as read
//! corrected = quantity·s + o = value·(scale·s) + (offset·s + o)         as a finding says
//! ```

use crate::record::units::digits;
use std::fmt::{self, Display, Formatter};

/// The source of a quantity: a column, and the conversion of its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceColumn {
    /// Its name in the file.
    pub column: String,
    /// Our unit per theirs.
    pub scale: f64,
    /// Added after scaling, in our unit.
    pub offset: f64,
    /// Further keys of the column in `[import]`, such as `, integrate = true`; they stay as they are.
    pub further_keys: String,
}

/// The sources of the quantities that a finding may change.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceColumns {
    /// Of the time, s.
    pub time_s: SourceColumn,
    /// Of the duty, percent.
    pub duty_percent: SourceColumn,
    /// Of the position, mm.
    pub position_mm: SourceColumn,
}

impl Default for SourceColumns {
    /// Columns with the names of the quantities, in our units.
    fn default() -> Self {
        let own =
            |name: &str| SourceColumn { column: name.into(), scale: 1.0, offset: 0.0, further_keys: String::new() };
        Self { time_s: own("time_s"), duty_percent: own("duty_percent"), position_mm: own("position_mm") }
    }
}

/// A quantity whose conversion may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Quantity {
    Time,
    Duty,
    Position,
}

/// A correction of a quantity, in our unit: corrected = scale·quantity + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Correction {
    quantity: Quantity,
    scale: f64,
    offset: f64,
}

impl Correction {
    pub(crate) fn scale(quantity: Quantity, scale: f64) -> Self {
        Self { quantity, scale, offset: 0.0 }
    }

    pub(crate) fn with_offset(self, offset: f64) -> Self {
        Self { offset, ..self }
    }

    /// The line of the table `[import]` that corrects a quantity read from these columns.
    pub(crate) fn line(self, columns: &SourceColumns) -> String {
        let (key, source) = match self.quantity {
            Quantity::Time => ("time_s", &columns.time_s),
            Quantity::Duty => ("duty_percent", &columns.duty_percent),
            Quantity::Position => ("position_mm", &columns.position_mm),
        };
        // A name between quotation marks of TOML.
        let name = source.column.replace('\\', "\\\\").replace('"', "\\\"");
        let offset = source.offset * self.scale + self.offset;
        let offset = if offset == 0.0 { String::new() } else { format!(", offset = {}", digits(offset)) };
        let scale = digits(source.scale * self.scale);
        format!("{key} = {{ column = \"{name}\", scale = {scale}{offset}{} }}", source.further_keys)
    }
}

impl Display for Correction {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.line(&SourceColumns::default()))
    }
}

#[cfg(test)]
mod tests {
    use super::{Correction, Quantity, SourceColumns};

    #[test]
    fn a_correction_is_composed_with_the_conversion_that_is_there() {
        let mut columns = SourceColumns::default();
        columns.position_mm.column = "y \"raw\"".into();
        columns.position_mm.scale = 10.0;
        columns.position_mm.offset = -40.0;
        columns.position_mm.further_keys = ", minus = \"zero\"".into();
        let turned = Correction::scale(Quantity::Position, -1.0).with_offset(583.0);
        let line = turned.line(&columns);
        let said = r#"position_mm = { column = "y \"raw\"", scale = -10, offset = 623, minus = "zero" }"#;
        assert_eq!(line, said);
        assert_eq!(
            Correction::scale(Quantity::Time, 1e-3).to_string(),
            "time_s = { column = \"time_s\", scale = 0.001 }"
        );
    }
}
