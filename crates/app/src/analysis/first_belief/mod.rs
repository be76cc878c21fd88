//! A first belief about the rig of a foreign CSV: which column is what, in which units, and a linear plant.
//!
//! ```text
//! columns of numbers → roles (names, units, numbers) → scales → rows → linear plant (`diagnose::identify`)
//! ```
//!
//! What a user says comes before what is guessed, and every guess says what it rests on.

mod asked;
mod by_fit;
mod derived;
mod flaw;
mod names;
mod rig_words;
mod roles;
mod scales;
mod words;

use names::Name;
use words::MEASURED;

pub use asked::Asked;
pub use roles::{Named, Role, Roles, roles};
pub use scales::{Scaled, Scales, scales};

use crate::log::LogError;
use crate::log::reader::{self, LoadedLog};
use config::words::Words;
use diagnose::Recording;
use diagnose::identify::{Initial, NoPlant, initial};
use rows::{Column, Import, Sheet};
use std::path::PathBuf;

/// A first belief, with the origin of each of its numbers.
#[derive(Clone, Debug)]
pub struct FirstBelief {
    /// Which column is what.
    pub roles: Roles,
    /// In which units.
    pub scales: Scales,
    /// The table `[import]`.
    pub import: Import,
    /// The words of the rig, where its columns say them.
    pub words: Words,
    /// The plant.
    pub plant: Initial,
    /// Length of all logs, seconds, and their readings.
    pub duration_s: f64,
    /// Number of readings.
    pub readings: usize,
}

/// Why there is no first belief.
#[derive(Debug, thiserror::Error)]
pub enum NoBelief {
    /// A log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The record is of no plant of ours.
    #[error("{path}: with {} as the input and {} as the {}: {source}", roles.input(), roles.position.column, roles.output(), path = path.display())]
    Plant {
        /// The log.
        path: PathBuf,
        /// The columns that were tried.
        roles: Box<Roles>,
        /// The reason.
        source: NoPlant,
    },
}

impl NoBelief {
    /// Whether other columns may give a belief.
    #[must_use]
    pub const fn is_of_columns(&self) -> bool {
        matches!(self, Self::Plant { source: NoPlant::Servo { .. } | NoPlant::NoAnswer { .. } | NoPlant::Still, .. })
    }
}

/// A first belief about the rig of `logs`, whose columns have the `roles` of the first of them. Where the position does
/// not answer a current or torque and there is a command, the rig is a servo.
///
/// # Errors
/// A log that cannot be read with these columns, or is of no plant of ours.
pub fn first_belief(logs: &[PathBuf], sheet: &Sheet, roles: &Roles, asked: &Asked) -> Result<FirstBelief, NoBelief> {
    let found = of_roles(logs, sheet, roles, asked);
    let Err(NoBelief::Plant { source: NoPlant::NoAnswer { .. }, .. }) = &found else { return found };
    as_servo(sheet, roles, asked).and_then(|servo| of_roles(logs, sheet, &servo, asked).ok()).map_or(found, Ok)
}

/// The same rig as a servo. `None`: there is no command, or the input is as said, or neither its name nor a
/// lone unit says that a servo may measure it.
fn as_servo(sheet: &Sheet, roles: &Roles, asked: &Asked) -> Option<Roles> {
    let setpoint = roles.setpoint.clone().filter(|_| !roles.is_speed && roles.minus.is_none())?;
    let input = sheet.columns.iter().find(|column| column.name == roles.input.column)?;
    let may_be_measured = Name::of(input).says(MEASURED) || roles.input.is_by_unit();
    let is_measured = asked.input.is_none() && may_be_measured;
    is_measured.then(|| Roles::servo(roles.time.clone(), roles.position.clone(), setpoint))
}

fn of_roles(logs: &[PathBuf], sheet: &Sheet, roles: &Roles, asked: &Asked) -> Result<FirstBelief, NoBelief> {
    let scales = scales(sheet, roles, asked);
    let mut import = import(roles, &scales);
    let read = |path: &PathBuf| reader::read(path, Some(&import));
    let logs_read = logs.iter().map(read).collect::<Result<Vec<LoadedLog>, _>>()?;
    let recordings: Vec<Recording> = logs_read.into_iter().map(|log| log.recording).collect();
    let of_first = || logs.first().cloned().unwrap_or_default();
    let no_plant = |source| NoBelief::Plant { path: of_first(), roles: Box::new(roles.clone()), source };
    let turn_mm = import.position_mm.turn();
    let unity_gain = scales.unity_gain(roles.minus.is_some());
    let plant = initial(&recordings, scales.bottom_mm, scales.length_mm, turn_mm, unity_gain).map_err(no_plant)?;
    if plant.is_turned {
        import.duty_percent.scale = -import.duty_percent.scale;
    }
    Ok(FirstBelief {
        roles: roles.clone(),
        words: rig_words::rig_words(sheet, roles, &scales),
        scales,
        import,
        plant,
        duration_s: recordings.iter().map(Recording::duration_s).sum(),
        readings: recordings.iter().map(Recording::readings).sum(),
    })
}

fn import(roles: &Roles, scales: &Scales) -> Import {
    let column = |named: &Named, scaled: &Scaled| Column { scale: scaled.scale, ..Column::named(&named.column) };
    let position = column(&roles.position, &scales.position);
    Import {
        time_s: Column { spread: scales.has_coarse_clock, ..column(&roles.time, &scales.time) },
        setpoint_mm: roles.setpoint.as_ref().filter(|_| !roles.is_speed).map(|named| column(named, &scales.position)),
        duty_percent: Column {
            minus: roles.minus.clone(),
            hold: scales.is_input_held,
            ..column(&roles.input, &scales.input)
        },
        position_mm: Column { integrate: roles.is_speed, ..position },
        ..Import::default()
    }
}
