//! Corrections of units and signs: the lines of `[import]` that a finding asks for.
//!
//! ```text
//! quantity = value·scale + offset                                       as read
//! corrected = quantity·s + o = value·(scale·s) + (offset·s + o)         as a finding says
//! corrected = value·(scale·s) + offset                                  of a position, where a finding says no o
//! ```
//!
//! The offset of a position is in millimetres and places the column's own zero; another unit or sign of the column does
//! not move that.

use crate::record::finding::Finding;
use crate::record::implausible::DutyScale;
use crate::record::source_columns::SourceColumns;
use crate::record::units::{digits, length, nearest_scale};
use std::fmt::{self, Display, Formatter};

/// A scale by hover is that of a usual unit within this factor; by the gain, of which an effect takes a part, within
/// the other.
const NEAR_BY_HOVER: f64 = 1.15;
const NEAR_BY_GAIN: f64 = 2.0;

/// Seconds.
pub(super) const MILLISECOND: f64 = 1e-3;

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
        let keeps_place = self.quantity == Quantity::Position && self.offset == 0.0;
        let offset = if keeps_place { source.offset } else { source.offset * self.scale + self.offset };
        let offset = if offset == 0.0 { String::new() } else { format!(", offset = {}", digits(offset)) };
        let scale = digits(source.scale * self.scale);
        format!("{key} = {{ column = {}, scale = {scale}{offset}{} }}", source.quoted, source.further_keys)
    }
}

impl Display for Correction {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.line(&SourceColumns::default()))
    }
}

impl Finding {
    /// The finding, with the lines of `[import]` that it asks for as they are for a record from these columns.
    #[must_use]
    pub fn in_columns(&self, columns: &SourceColumns) -> String {
        let corrections = self.corrections().into_iter();
        corrections.fold(self.to_string(), |said, one| said.replace(&one.to_string(), &one.line(columns)))
    }

    /// The corrections that its sentence asks for.
    fn corrections(&self) -> Vec<Correction> {
        match *self {
            Self::FractionalDuty => vec![duty(100.0)],
            Self::DutyBeyondPercent { scale: DutyScale(Some(scale)), .. } => vec![duty(scale)],
            Self::DutyFarBelowHover { scale, offset_percent, .. } => vec![duty(scale).with_offset(offset_percent)],
            Self::SlowRows { .. } => vec![time(MILLISECOND)],
            Self::PositionReversed { offset_mm, .. } => vec![position(-1.0).with_offset(offset_mm)],
            Self::InputReversed { .. } => vec![duty(-1.0)],
            Self::InputInverted { .. } => vec![inverted()],
            Self::SignReversed { .. } => vec![duty(-1.0), position(-1.0)],
            Self::DutyUnit { scale, .. } => vec![by_hover(scale)],
            Self::PositionUnit { ratio, .. } => vec![by_length(ratio)],
            Self::GainUnit { ratio, .. } => vec![by_gain(ratio), by_length(ratio)],
            Self::TimeUnit { scale } => vec![time(scale)],
            _ => Vec::new(),
        }
    }
}

pub(super) fn time(scale: f64) -> Correction {
    Correction::scale(Quantity::Time, scale)
}

pub(super) fn duty(scale: f64) -> Correction {
    Correction::scale(Quantity::Duty, scale)
}

/// 100 % less the duty.
pub(super) fn inverted() -> Correction {
    duty(-1.0).with_offset(100.0)
}

pub(super) fn position(scale: f64) -> Correction {
    Correction::scale(Quantity::Position, scale)
}

/// Of a duty whose hover is off by a factor.
pub(super) fn by_hover(scale: f64) -> Correction {
    duty(nearest_scale(scale, NEAR_BY_HOVER))
}

/// Of a duty whose gain is off by a factor.
pub(super) fn by_gain(ratio: f64) -> Correction {
    duty(nearest_scale(ratio, NEAR_BY_GAIN))
}

/// Of a position whose gain is off by a factor.
pub(super) fn by_length(ratio: f64) -> Correction {
    position(length(ratio).1)
}

#[cfg(test)]
mod tests {
    use super::{Correction, Quantity};
    use crate::record::source_columns::SourceColumns;

    #[test]
    fn a_correction_is_composed_with_the_conversion_that_is_there() {
        let mut columns = SourceColumns::default();
        columns.position_mm.quoted = r#""y \"raw\"""#.into();
        columns.position_mm.scale = 10.0;
        columns.position_mm.offset = -40.0;
        columns.position_mm.further_keys = ", minus = \"zero\"".into();
        let turned = Correction::scale(Quantity::Position, -1.0).with_offset(583.0);
        let line = turned.line(&columns);
        let said = r#"position_mm = { column = "y \"raw\"", scale = -10, offset = 623, minus = "zero" }"#;
        assert_eq!(line, said);
        // Another unit does not move the column's zero.
        let in_metres = Correction::scale(Quantity::Position, 1e3).line(&columns);
        assert!(in_metres.contains("scale = 10000, offset = -40,"), "{in_metres}");
        assert_eq!(
            Correction::scale(Quantity::Time, 1e-3).to_string(),
            "time_s = { column = \"time_s\", scale = 0.001 }"
        );
    }
}
