//! A definition as text: as a table of a config file, and its formulas for people.

use super::definition::Definition;
use super::table::{ParameterTable, StateTable};
use crate::effect::Stage;
use std::fmt::{Display, Formatter, Result, Write};

impl Definition {
    /// What it is, for people: its formulas in a fenced block.
    #[must_use]
    pub fn physics(&self) -> String {
        let table = self.table();
        let (sum, unit) = match table.stage {
            Stage::Actuator => ("duty += ", "percent"),
            Stage::Air | Stage::Ball => ("a = ", "mm/s²"),
            Stage::Sensor => ("reading += ", "mm"),
        };
        let mut lines = format!("An effect that a user wrote.\n\n```text\n{sum}{}      {unit}\n", table.adds);
        for (name, StateTable { rate, start }) in &table.states {
            // Writing to a string cannot fail.
            let _ = writeln!(lines, "d{name}/dt = {rate}      at rest {name} = {start}");
        }
        lines + "```"
    }
}

impl Display for Definition {
    /// Its table `[effect.NAME]` in TOML.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (name, table) = (self.entry().name, self.table());
        writeln!(f, "[effect.{name}]")?;
        for (key, text) in
            [("stage", table.stage.name()), ("adds", &table.adds), ("looks", &table.looks), ("mend", &table.mend)]
        {
            writeln!(f, "{key} = {}", Quoted(text))?;
        }
        for (key, parameter) in &table.parameters {
            writeln!(f, "parameters.{key} = {}", Inline(parameter))?;
        }
        for (key, state) in &table.states {
            writeln!(f, "states.{key} = {{ rate = {}, start = {} }}", Quoted(&state.rate), Quoted(&state.start))?;
        }
        Ok(())
    }
}

/// A parameter as an inline table.
struct Inline<'a>(&'a ParameterTable);

impl Display for Inline<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let ParameterTable { neutral, value, scale, low, high, unit } = self.0;
        f.write_str("{ ")?;
        for (key, number) in [("neutral", neutral), ("value", value), ("scale", scale)] {
            if let Some(number) = number {
                write!(f, "{key} = {number:?}, ")?;
            }
        }
        write!(f, "low = {low:?}, high = {high:?}, unit = {} }}", Quoted(unit))
    }
}

/// Text as a basic string of TOML.
struct Quoted<'a>(&'a str);

impl Display for Quoted<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_char('"')?;
        for letter in self.0.chars() {
            match letter {
                '"' | '\\' => write!(f, "\\{letter}")?,
                letter if letter.is_control() => write!(f, "\\u{:04x}", u32::from(letter))?,
                letter => f.write_char(letter)?,
            }
        }
        f.write_char('"')
    }
}

/// A text of the user for a message: as long as a formula may be, and printable.
pub(super) fn shown(text: &str) -> String {
    let mut printable = String::new();
    for letter in text.chars().take(formula::MAX_CHARACTERS) {
        if letter.is_control() { printable.extend(letter.escape_debug()) } else { printable.push(letter) }
    }
    if text.chars().nth(formula::MAX_CHARACTERS).is_some() {
        printable.push('…');
    }
    printable
}
