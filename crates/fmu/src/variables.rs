//! The variables of an FMU: fixed ones, then the numbers of the model in the order of its tables.

use plant::Model;
use toml::{Table, Value};

/// Reference of the duty, percent.
pub const DUTY: u32 = 0;
/// Reference of the setpoint, mm.
pub const SETPOINT: u32 = 1;
/// Reference of the reading, mm.
pub const POSITION: u32 = 2;
/// Reference of the true position, mm.
pub const BALL: u32 = 3;
/// Reference of the true velocity, mm/s.
pub const VELOCITY: u32 = 4;
/// Reference of the acceleration that the fan gives about hover, mm/s².
pub const FAN: u32 = 5;
/// Reference of the speed of the fan, rpm.
pub const RPM: u32 = 6;
/// Reference of the duty as the chip holds it, percent.
pub const HELD: u32 = 7;
/// Reference of whether the reading is new.
pub const FRESH: u32 = 8;
/// Reference of the seed of the noise.
pub const SEED: u32 = 9;
/// Reference of whether noise is on.
pub const NOISE: u32 = 10;
/// Reference of the first parameter of the model; the others follow it.
const FIRST_PARAMETER: u32 = 100;

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Real,
    /// A whole number.
    Integer,
    /// Yes or no.
    Boolean,
}

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Given before each step.
    Input,
    /// Read after each step.
    Output,
    /// Given before the simulation.
    Parameter,
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name; of a parameter its dotted key in the config.
    pub name: String,
    /// Its number in calls.
    pub reference: u32,
    /// Its type.
    pub kind: Kind,
    /// What it is for.
    pub role: Role,
    /// Its unit, where it has one.
    pub unit: Option<&'static str>,
    /// What it is.
    pub description: String,
    /// Its value before the simulation; booleans as 0 and 1. Of an output, what it is before it is known.
    pub start: f64,
}

/// All variables of a model.
#[must_use]
pub fn variables(model: &Model) -> Vec<Variable> {
    let mut all = fixed(model);
    let numbers = Table::try_from(model).unwrap_or_default();
    let mut found = Vec::new();
    flatten("plant", &Value::Table(numbers), &mut found);
    all.extend((FIRST_PARAMETER..).zip(found).map(|(reference, (name, kind, start))| Variable {
        description: format!("{name} of the config"),
        unit: None,
        role: Role::Parameter,
        name,
        reference,
        kind,
        start,
    }));
    all
}

/// Name, reference, type, purpose, unit, description and start of a variable.
type Row = (&'static str, u32, Kind, Role, Option<&'static str>, &'static str, f64);

fn fixed(model: &Model) -> Vec<Variable> {
    use Kind::{Boolean, Integer, Real};
    use Role::{Input, Output, Parameter};
    let middle = model.middle_mm();
    let rows: [Row; 11] = [
        ("duty_percent", DUTY, Real, Input, Some("%"), "Duty of the fan during the next step", 0.0),
        ("setpoint_mm", SETPOINT, Real, Input, Some("mm"), "Setpoint, for effects that depend on it", middle),
        ("position_mm", POSITION, Real, Output, Some("mm"), "Reading of the sensor; the last one without a new", 0.0),
        ("ball_mm", BALL, Real, Output, Some("mm"), "True position of the ball above the bottom", 0.0),
        ("velocity_mm_per_s", VELOCITY, Real, Output, Some("mm/s"), "True velocity of the ball, upward", 0.0),
        ("fan_mm_per_s2", FAN, Real, Output, Some("mm/s2"), "Speed of the fan, as acceleration about hover", 0.0),
        ("fan_rpm", RPM, Real, Output, Some("rpm"), "Speed by the tachometer; 0 without one", 0.0),
        ("held_duty_percent", HELD, Real, Output, Some("%"), "Duty as the chip of the fan holds it", 0.0),
        ("fresh", FRESH, Boolean, Output, None, "Whether the reading is new", 0.0),
        ("seed", SEED, Integer, Parameter, None, "Seed of the noise", 1.0),
        ("noise", NOISE, Boolean, Parameter, None, "Whether the noise of [plant.noise] is on", 1.0),
    ];
    let made = rows.map(|(name, reference, kind, role, unit, description, start)| Variable {
        name: name.into(),
        reference,
        kind,
        role,
        unit,
        description: description.into(),
        start,
    });
    made.into()
}

/// The numbers of a table by their dotted keys.
fn flatten(name: &str, value: &Value, found: &mut Vec<(String, Kind, f64)>) {
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| flatten(&format!("{name}.{key}"), value, found)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(at, item)| flatten(&format!("{name}[{}]", at + 1), item, found));
        }
        Value::Float(number) => found.push((name.to_owned(), Kind::Real, *number)),
        #[expect(clippy::cast_precision_loss, reason = "a number that a person wrote")]
        Value::Integer(number) => found.push((name.to_owned(), Kind::Integer, *number as f64)),
        Value::Boolean(_) | Value::String(_) | Value::Datetime(_) => {}
    }
}

/// The table with the values that `value` gives for the names of its numbers.
pub(super) fn with_values(name: &str, table: &Value, value: &dyn Fn(&str) -> Option<f64>) -> Value {
    match table {
        Value::Table(table) => {
            let each = table.iter().map(|(key, one)| (key.clone(), with_values(&format!("{name}.{key}"), one, value)));
            Value::Table(each.collect())
        }
        Value::Array(items) => {
            let each = items.iter().enumerate();
            Value::Array(each.map(|(at, one)| with_values(&format!("{name}[{}]", at + 1), one, value)).collect())
        }
        Value::Float(_) => value(name).map_or_else(|| table.clone(), Value::Float),
        #[expect(clippy::cast_possible_truncation, reason = "an integer of FMI has 32 bits")]
        Value::Integer(_) => value(name).map_or_else(|| table.clone(), |number| Value::Integer(number as i64)),
        Value::Boolean(_) | Value::String(_) | Value::Datetime(_) => table.clone(),
    }
}
