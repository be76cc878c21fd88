//! The table `[import]` of the config: the columns of another rig's CSV, and their units.
//!
//! ```text
//! quantity = value·scale + offset
//! quantity = scale·∫ value dt + offset      with integrate = true, for a column that holds a speed
//! value = column − other                    with minus = "other", for a servo whose input is the error of its position
//! value = the last one                      with hold = true, in a row whose cell is empty
//! ```
//!
//! The integral is by trapezoids over the file's own time, from 0 at the first reading; `offset` is then the initial
//! position of the ball. A constant error of the speed is not removed.

use crate::error::RowsError;
use core::f64::consts::TAU;
use serde::{Deserialize, Serialize};

/// The source of each quantity of a foreign CSV. An absent quantity is read from the column of its own name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Import {
    /// Time, seconds.
    #[serde(default = "time_s")]
    pub time_s: Column,
    /// Commanded position, millimetres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub setpoint_mm: Option<Column>,
    /// Duty, percent.
    #[serde(default = "duty_percent")]
    pub duty_percent: Column,
    /// Position, millimetres, upward.
    #[serde(default = "position_mm")]
    pub position_mm: Column,
    /// Fan speed of a tachometer, revolutions per minute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fan_rpm: Option<Column>,
    /// Position of a second sensor, millimetres, upward.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position2_mm: Option<Column>,
}

/// A column and the conversion of its numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Its name in the header of the file.
    pub column: String,
    /// Our unit per theirs.
    #[serde(default = "one")]
    pub scale: f64,
    /// Added after scaling, in our unit.
    #[serde(default)]
    pub offset: f64,
    /// The name of another column, subtracted before scaling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minus: Option<String>,
    /// The column holds a speed; integrate it over time.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub integrate: bool,
    /// The column is a time coarser than the rows; spread the rows of each timestamp evenly up to the next one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub spread: bool,
    /// The log fills the column in some rows only; an empty cell repeats the last value, and rows before the first one
    /// are left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hold: bool,
}

/// Units of an angle, in lower case, and how many of each one turn has.
const ANGLES: [(&str, f64); 6] =
    [("rad", TAU), ("mrad", 1e3 * TAU), ("deg", 360.0), ("degrees", 360.0), ("°", 360.0), ("rev", 1.0)];

impl Column {
    /// One turn in our unit, if the name ends in the unit of an angle: `theta_rad`, `angle [deg]`.
    #[must_use]
    pub fn turn(&self) -> Option<f64> {
        let mut words = self.column.rsplit(|letter: char| !(letter.is_alphabetic() || letter == '°'));
        let unit = words.find(|word| !word.is_empty())?.to_lowercase();
        let angle = ANGLES.iter().find(|(name, _)| *name == unit)?;
        (!self.integrate).then_some(angle.1 * self.scale.abs())
    }

    /// A column whose numbers are already in our unit.
    #[must_use]
    pub fn named(name: &str) -> Self {
        let (integrate, spread, hold) = (false, false, false);
        Self { column: name.into(), scale: one(), offset: 0.0, minus: None, integrate, spread, hold }
    }
}

impl Default for Import {
    fn default() -> Self {
        Self {
            time_s: time_s(),
            setpoint_mm: None,
            duty_percent: duty_percent(),
            position_mm: position_mm(),
            fan_rpm: None,
            position2_mm: None,
        }
    }
}

impl Import {
    /// Checks the values: scales must be numbers other than zero, offsets must be numbers, and an integral is allowed
    /// only for a quantity whose derivative is a speed.
    ///
    /// # Errors
    /// [`RowsError::Import`] names the first wrong quantity and key.
    pub fn check(&self) -> Result<(), RowsError> {
        let columns = [
            ("time_s", Some(&self.time_s)),
            ("setpoint_mm", self.setpoint_mm.as_ref()),
            ("duty_percent", Some(&self.duty_percent)),
            ("position_mm", Some(&self.position_mm)),
            ("fan_rpm", self.fan_rpm.as_ref()),
            ("position2_mm", self.position2_mm.as_ref()),
        ];
        columns.into_iter().try_for_each(|(quantity, column)| column.map_or(Ok(()), |c| check_column(quantity, c)))
    }
}

fn check_column(quantity: &'static str, column: &Column) -> Result<(), RowsError> {
    let wrong = |key, value, hint| Err(RowsError::Import { quantity, key, value, hint });
    if !column.scale.is_finite() || column.scale == 0.0 {
        return wrong("scale", column.scale.to_string(), "it must be a finite number other than 0");
    }
    if !column.offset.is_finite() {
        return wrong("offset", column.offset.to_string(), "it must be a finite number");
    }
    if let Some(other) = column.minus.as_ref().filter(|_| quantity == "time_s") {
        return wrong("minus", format!("{other:?}"), "times are not subtracted; give the column of the time alone");
    }
    if column.spread && quantity != "time_s" {
        return wrong("spread", true.to_string(), "only times are spread, between one timestamp and the next");
    }
    if column.hold && quantity != "duty_percent" {
        return wrong("hold", true.to_string(), "only the input is held between its values; another cell may be empty");
    }
    if column.integrate && !matches!(quantity, "position_mm" | "position2_mm") {
        return wrong("integrate", true.to_string(), "only the speed of the ball can be integrated, to a position");
    }
    Ok(())
}

fn one() -> f64 {
    1.0
}

fn time_s() -> Column {
    Column::named("time_s")
}

fn duty_percent() -> Column {
    Column::named("duty_percent")
}

fn position_mm() -> Column {
    Column::named("position_mm")
}

#[cfg(test)]
mod tests {
    use super::{Column, Import};

    #[test]
    fn what_is_absent_is_read_from_the_column_of_its_own_name() {
        let import: Import = toml::from_str(r#"position_mm = { column = "angle_deg", scale = 2.0 }"#).unwrap();
        assert_eq!(import.time_s, Column::named("time_s"));
        assert_eq!(import.position_mm, Column { scale: 2.0, ..Column::named("angle_deg") });
        assert_eq!(toml::from_str::<Import>("").unwrap(), Import::default());
    }

    #[test]
    fn the_table_survives_writing_and_reading() {
        let speed = Column { integrate: true, offset: 5.0, ..Column::named("v") };
        let import = Import { position_mm: speed, fan_rpm: Some(Column::named("tacho")), ..Import::default() };
        assert_eq!(toml::from_str::<Import>(&toml::to_string(&import).unwrap()).unwrap(), import);
    }

    #[test]
    fn a_name_with_the_unit_of_an_angle_tells_the_length_of_a_turn() {
        let turn = |name: &str| Column { scale: -10.0, ..Column::named(name) }.turn();
        assert_eq!(turn("angle_deg"), Some(3600.0));
        assert_eq!(turn("Theta [rad]"), Some(20.0 * std::f64::consts::PI));
        for other in ["position_mm", "deg_per_s", "speed_rad_s", "gradient", "rad", ""] {
            assert_eq!(turn(other).is_some(), other == "rad", "{other}");
        }
        assert_eq!(Column { integrate: true, ..Column::named("rate_deg") }.turn(), None);
    }

    #[test]
    fn a_misspelt_key_is_answered_with_the_known_ones() {
        let error = toml::from_str::<Import>(r#"position = { column = "x" }"#).unwrap_err().to_string();
        assert!(error.contains("`position`") && error.contains("`position_mm`"), "{error}");
        let error = toml::from_str::<Import>(r#"time_s = { column = "x", factor = 2 }"#).unwrap_err().to_string();
        assert!(error.contains("`factor`") && error.contains("`scale`"), "{error}");
    }

    #[test]
    fn a_scale_of_zero_and_an_integral_of_time_are_refused() {
        let zero = Import { duty_percent: Column { scale: 0.0, ..Column::named("u") }, ..Import::default() };
        assert!(zero.check().unwrap_err().to_string().starts_with("[import] duty_percent: scale = 0;"));
        let integral = Import { time_s: Column { integrate: true, ..Column::named("t") }, ..Import::default() };
        assert!(integral.check().unwrap_err().to_string().starts_with("[import] time_s: integrate = true;"));
        let spread = Import { duty_percent: Column { spread: true, ..Column::named("u") }, ..Import::default() };
        assert!(spread.check().unwrap_err().to_string().starts_with("[import] duty_percent: spread = true;"));
        let held = Import { position_mm: Column { hold: true, ..Column::named("y") }, ..Import::default() };
        assert!(held.check().unwrap_err().to_string().starts_with("[import] position_mm: hold = true;"));
        let endless = Import { time_s: Column { offset: f64::NAN, ..Column::named("t") }, ..Import::default() };
        assert!(endless.check().unwrap_err().to_string().starts_with("[import] time_s: offset = NaN;"));
        Import::default().check().unwrap();
    }
}
