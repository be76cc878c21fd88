//! Which column is the time, the input, the position and the setpoint: by what a user says, by names, by the numbers.

use super::asked::Asked;
use super::by_fit::{by_fit, drives_better_than_setpoint};
use super::flaw::{counts_rows, flaw, grows, moves, nearly_grows};
use super::names::Name;
use super::scales;
use super::words::{COMMANDS, INPUTS, POSITIONS, SETPOINTS, SPEEDS, SUPPLIES, TIMES};
use rows::{Sheet, SheetColumn, shown};
use std::fmt::{self, Display, Formatter};

/// A quantity that a column may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Time.
    Time,
    /// What drives the rig.
    Input,
    /// Where it is.
    Position,
    /// Where it shall be.
    Setpoint,
}

/// A column, and what its role rests on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// Its name.
    pub column: String,
    /// The reason, in words.
    pub why: &'static str,
}

impl Named {
    /// Whether only its unit says what it is.
    pub(super) fn is_by_unit(&self) -> bool {
        self.why == BY_UNIT
    }
}

/// The roles of the columns of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Roles {
    /// Time.
    pub time: Named,
    /// What drives the rig; of a servo, its command.
    pub input: Named,
    /// The column that is subtracted from the input: of a servo, its position.
    pub minus: Option<String>,
    /// Where it is, or its speed.
    pub position: Named,
    /// Whether the column of the position holds a speed.
    pub is_speed: bool,
    /// Where it shall be.
    pub setpoint: Option<Named>,
}

impl Roles {
    /// The roles of a servo: its input is its command minus its position.
    pub(super) fn servo(time: Named, position: Named, command: Named) -> Self {
        let input = Named { why: SERVO, ..command.clone() };
        let minus = Some(position.column.clone());
        Self { time, input, minus, position, is_speed: false, setpoint: Some(command) }
    }

    /// The input in words.
    #[must_use]
    pub fn input(&self) -> String {
        let minus = self.minus.as_ref().map_or(String::new(), |other| format!(" minus `{}`", shown(other)));
        format!("`{}`{minus}", shown(&self.input.column))
    }

    /// What the column of the position holds.
    #[must_use]
    pub const fn output(&self) -> &'static str {
        if self.is_speed { "speed" } else { "position" }
    }
}

/// Why a column is not found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRole {
    /// No column has the name that was given.
    #[error("no column `{name}` for the {role}{flaw}; there are {columns}")]
    Unknown {
        /// The role.
        role: Role,
        /// The name.
        name: String,
        /// What is wrong with a column of this name.
        flaw: String,
        /// The columns.
        columns: String,
    },
    /// No column looks like it.
    #[error("no column looks like the {role}{flaw}; name it with {}; there are {columns}", role.advice())]
    NotFound {
        /// The role.
        role: Role,
        /// What is wrong with a column whose name says that it is this.
        flaw: String,
        /// The columns.
        columns: String,
    },
}

impl Role {
    /// The flag that names its column.
    #[must_use]
    pub const fn flag(self) -> &'static str {
        match self {
            Self::Time => "--time",
            Self::Input => "--input",
            Self::Position => "--position",
            Self::Setpoint => "--setpoint",
        }
    }

    /// How to say which column it is.
    fn advice(self) -> String {
        let without = if self == Self::Time { ", or give the time between two rows with --period SECONDS" } else { "" };
        format!("{} COLUMN{without}", self.flag())
    }

    /// The lists of words of which one is in the name of its column.
    const fn words(self) -> &'static [&'static [&'static str]] {
        match self {
            Self::Time => &[TIMES],
            Self::Input => &[INPUTS],
            Self::Position => &[POSITIONS, SPEEDS],
            Self::Setpoint => &[SETPOINTS],
        }
    }
}

impl Display for Role {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Time => "time",
            Self::Input => "input",
            Self::Position => "position",
            Self::Setpoint => "setpoint",
        })
    }
}

const BY_USER: &str = "as said";
const BY_NAME: &str = "by its name";
const BY_UNIT: &str = "by its unit";
const BY_ORDER: &str = "it only grows";
const SERVO: &str = "a servo: its command minus its position";

/// A column with what is known of it.
pub(super) struct Candidate<'a> {
    pub(super) column: &'a SheetColumn,
    pub(super) name: Name,
}

/// The roles of the columns of a table.
///
/// # Errors
/// [`NoRole`]: a named column does not exist, or none looks like the time, the input or the position.
pub fn roles(sheet: &Sheet, asked: &Asked) -> Result<Roles, NoRole> {
    let all: Vec<Candidate<'_>> =
        sheet.columns.iter().map(|column| Candidate { column, name: Name::of(column) }).collect();
    let columns = Columns { all: &all };
    let time = columns.time(asked)?;
    let moving: Vec<&Candidate<'_>> =
        all.iter().filter(|one| one.column.name != time.column && moves(one.column)).collect();
    let (position, is_speed) = columns.position(asked, &moving)?;
    let others: Vec<&Candidate<'_>> = match &position {
        Some(found) => moving.iter().filter(|one| one.column.name != found.column).copied().collect(),
        None => moving.clone(),
    };
    let is_position = |one: &&Candidate<'_>| position.as_ref().is_some_and(|found| found.column == one.column.name);
    let found = all.iter().find(is_position);
    let number = found.map(|one| one.name.number.as_str()).unwrap_or_default();
    let said = |among: &[&Candidate<'_>], words: &[&str]| columns.named(among, number, words, found.as_slice());
    let is_setpoint = |one: &&&Candidate<'_>| asked.setpoint.as_ref() == Some(&one.column.name);
    let may_drive = |one: &&&Candidate<'_>| !is_setpoint(one) && !one.name.says(SUPPLIES);
    let possible_inputs: Vec<&Candidate<'_>> = others.iter().filter(may_drive).copied().collect();
    let drives: Vec<&Candidate<'_>> = possible_inputs.iter().filter(|one| one.name.is_drive()).copied().collect();
    let input = match columns.given(Role::Input, asked.input.as_deref())? {
        Some(found) => Some(found),
        None => said(&possible_inputs, INPUTS).or_else(|| said(&drives, COMMANDS)).or_else(|| only_by_unit(&drives)),
    };
    let setpoint = match columns.given(Role::Setpoint, asked.setpoint.as_deref())? {
        Some(found) => Some(found),
        None => said(&others, SETPOINTS)
            .or_else(|| said(&others, COMMANDS).filter(|_| input.is_some() || position.is_some())),
    };
    let setpoint = setpoint.filter(|found| input.as_ref().is_none_or(|input| input.column != found.column));
    match (input, position, setpoint) {
        (Some(input), Some(position), setpoint) => Ok(Roles { time, input, minus: None, position, is_speed, setpoint }),
        (None, Some(position), Some(setpoint)) if !is_speed => {
            let input = columns.driving(asked, &others, [&time, &position, &setpoint]);
            Ok(match input {
                Some(input) => Roles { time, input, minus: None, position, is_speed, setpoint: Some(setpoint) },
                None => Roles::servo(time, position, setpoint),
            })
        }
        (input, position, setpoint) => {
            let free = moving.iter().filter(|one| setpoint.as_ref().is_none_or(|set| set.column != one.column.name));
            let free: Vec<&Candidate<'_>> = free.copied().collect();
            let time_column = all.iter().find(|one| one.column.name == time.column);
            let pair = time_column
                .and_then(|time| by_fit((time, scale_of(time, asked)), &free, input.as_ref(), position.as_ref()));
            let missing = if position.is_none() { Role::Position } else { Role::Input };
            let (found_input, found_position) = pair.ok_or_else(|| columns.not_found(missing))?;
            let (input, position) = (input.unwrap_or(found_input), position.unwrap_or(found_position));
            Ok(Roles { time, input, minus: None, position, is_speed, setpoint })
        }
    }
}

/// The column whose unit alone says what it is; `None`: there are several, or none.
fn only_by_unit(of_unit: &[&Candidate<'_>]) -> Option<Named> {
    let [found] = of_unit else { return None };
    Some(Named { column: found.column.name.clone(), why: BY_UNIT })
}

/// Seconds per unit of the time.
fn scale_of(time: &Candidate<'_>, asked: &Asked) -> f64 {
    asked.period_s.or(asked.time_scale).unwrap_or_else(|| scales::time(time.column).scale)
}

/// The columns of a table.
struct Columns<'a> {
    all: &'a [Candidate<'a>],
}

impl Columns<'_> {
    fn names(&self) -> String {
        let names: Vec<String> = self.all.iter().map(|one| format!("`{}`", shown(&one.column.name))).take(20).collect();
        names.join(", ")
    }

    fn not_found(&self, role: Role) -> NoRole {
        let named = self.all.iter().filter(|one| role.words().iter().any(|words| one.name.says(words)));
        let is_near = |one: &Candidate<'_>| nearly_grows(one.column) || counts_rows(one.column);
        let nearly = self.all.iter().filter(|one| role == Role::Time && is_near(one));
        let flaw = named.chain(nearly).find_map(|one| flaw(role, one.column)).unwrap_or_default();
        NoRole::NotFound { role, flaw, columns: self.names() }
    }

    /// The column that a user names.
    fn given(&self, role: Role, name: Option<&str>) -> Result<Option<Named>, NoRole> {
        let Some(name) = name else { return Ok(None) };
        let is_there = self.all.iter().any(|one| one.column.name == name && !one.column.values.is_empty());
        let named = self.all.iter().find(|one| one.column.name == name);
        let flaw = || named.and_then(|one| flaw(role, one.column)).unwrap_or_default();
        let unknown = || NoRole::Unknown { role, name: shown(name), flaw: flaw(), columns: self.names() };
        is_there.then(|| Some(Named { column: name.into(), why: BY_USER })).ok_or_else(unknown)
    }

    fn time(&self, asked: &Asked) -> Result<Named, NoRole> {
        if let Some(given) = self.given(Role::Time, asked.time.as_deref())? {
            return Ok(given);
        }
        let grows: Vec<&Candidate<'_>> = self.all.iter().filter(|one| grows(one.column)).collect();
        let named = self.named(&grows, "", TIMES, &[]);
        // The first, unless it counts the rows: then it says nothing of the time between them.
        let has_period = |one: &Candidate<'_>| one.name.unit.is_some() || asked.period_s.is_some();
        let unnamed = || {
            let mut all = grows.iter().filter(|one| !one.column.name.is_empty());
            let counts = all.clone().rfind(|one| has_period(one));
            all.find(|one| !counts_rows(one.column)).or(counts)
        };
        let by_order = || unnamed().map(|one| Named { column: one.column.name.clone(), why: BY_ORDER });
        named.or_else(by_order).ok_or_else(|| self.not_found(Role::Time))
    }

    /// The column of the position, and whether it holds a speed.
    fn position(&self, asked: &Asked, moving: &[&Candidate<'_>]) -> Result<(Option<Named>, bool), NoRole> {
        if let Some(given) = self.given(Role::Position, asked.speed.as_deref())? {
            return Ok((Some(given), true));
        }
        if let Some(given) = self.given(Role::Position, asked.position.as_deref())? {
            return Ok((Some(given), false));
        }
        let is_input = |one: &&&Candidate<'_>| asked.input.as_deref() == Some(one.column.name.as_str());
        let free: Vec<&Candidate<'_>> = moving.iter().filter(|one| !is_input(one)).copied().collect();
        let may_be_position = |one: &&&Candidate<'_>| !one.name.says(SPEEDS) && !one.name.says(SETPOINTS);
        let possible: Vec<&Candidate<'_>> = free.iter().filter(may_be_position).copied().collect();
        let inputs: Vec<&Candidate<'_>> = moving.iter().filter(|one| one.name.says(INPUTS)).copied().collect();
        // `commanded position` beside `encoder position` is where the rig shall be.
        let read: Vec<&Candidate<'_>> = possible.iter().filter(|one| !one.name.says(COMMANDS)).copied().collect();
        let is_position = |one: &&&Candidate<'_>| one.name.is_length_or_angle() && !one.name.says(INPUTS);
        let by_unit = || only_by_unit(&read.iter().filter(is_position).copied().collect::<Vec<_>>());
        let by_name = |among| self.named(among, "", POSITIONS, &inputs);
        if let Some(found) = by_name(&read).or_else(by_unit).or_else(|| by_name(&possible)) {
            return Ok((Some(found), false));
        }
        let found = self.named(&free, "", SPEEDS, &inputs);
        let is_speed = found.is_some();
        Ok((found, is_speed))
    }

    /// The input whose name says nothing, beside a position and a setpoint. `None`: the rig is a servo.
    fn driving(&self, asked: &Asked, others: &[&Candidate<'_>], named: [&Named; 3]) -> Option<Named> {
        let of = |named: &Named| self.all.iter().find(|one| one.column.name == named.column);
        let [time, position, setpoint] = named.map(of);
        let (time, position, setpoint) = (time?, position?, setpoint?);
        let is_free = |one: &&&Candidate<'_>| one.column.name != setpoint.column.name;
        let free: Vec<&Candidate<'_>> = others.iter().filter(is_free).copied().collect();
        drives_better_than_setpoint((time, scale_of(time, asked)), &free, position, setpoint)
    }

    /// The first column with one of these words; before others one with this number, then one of the same part of the
    /// rig as one `beside`. Of columns with the same name it is one with a unit.
    fn named(
        &self,
        among: &[&Candidate<'_>],
        number: &str,
        words: &[&str],
        beside: &[&Candidate<'_>],
    ) -> Option<Named> {
        let is_beside = |one: &Candidate<'_>| beside.iter().any(|other| self.are_of_one_part(one, other));
        let rank = |one: &&&Candidate<'_>| (one.name.number == number, is_beside(one));
        // Of several with the highest rank `max_by_key` takes the last one.
        let one = among.iter().rev().filter(|one| one.name.says(words)).max_by_key(rank)?;
        let with_unit = among.iter().find(|other| one.name.is_without_unit_of(&other.name)).unwrap_or(one);
        Some(Named { column: with_unit.column.name.clone(), why: BY_NAME })
    }

    /// Whether two names share a word that most columns do not have: `trolley_position` and `trolley_voltage`.
    fn are_of_one_part(&self, one: &Candidate<'_>, other: &Candidate<'_>) -> bool {
        let is_rare = |word: &str| 2 * self.all.iter().filter(|any| any.name.says(&[word])).count() <= self.all.len();
        one.column.name != other.column.name && one.name.shared(&other.name).any(is_rare)
    }
}
