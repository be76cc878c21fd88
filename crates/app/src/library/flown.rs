//! A simulated flight as a value: its log in memory.

use super::{Belief, Log};
use crate::commands::flying::{header, plan_of};
use crate::commands::simulate;
use crate::files;
use crate::flight::experiment::Experiment;
use crate::flight::vocabulary::Cycle;
use crate::log::header::SIMULATED_START;
use crate::log::reader;
use crate::log::recorder::Inline;
use crate::log::writer::LogWriter;
use anyhow::{Result, anyhow};
use std::io::Cursor;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The name of a log that is in no file.
const IN_MEMORY: &str = "simulated.mcap";

/// A flight of the simulated rig.
pub struct Flown {
    /// Its log.
    pub log: Log,
    /// The same as the bytes of an MCAP file.
    bytes: Vec<u8>,
    /// The fault that ended it, in words.
    pub fault: Option<String>,
}

/// The programme of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Programme<'a> {
    /// The reference of the config.
    Reference,
    /// The experiment in a file.
    File(&'a Path),
    /// The text of an experiment that is in no file.
    Text(&'a str),
}

/// Flies the simulated rig in virtual time, as `airball simulate` does, until it is over or `stop` is set.
///
/// # Errors
/// A config that lacks a table, an experiment that is not sound, a flight that left no log.
pub fn fly(
    belief: &Belief,
    programme: Programme<'_>,
    seed: u64,
    duration_s: Option<f64>,
    stop: &AtomicBool,
) -> Result<Flown> {
    const COMMAND: &str = "simulate";
    let plan = plan_of(COMMAND, belief.0.clone(), |safety| match programme {
        Programme::Reference => Ok(None),
        Programme::File(path) => Experiment::read(path, safety).map(Some),
        Programme::Text(text) => Experiment::own("the experiment", text, safety).map(Some),
    })?;
    let path = Path::new(IN_MEMORY);
    let mut bytes = Vec::new();
    let header = header(&plan, Some(seed), SIMULATED_START);
    let mut recorder = Inline::new(LogWriter::to(Cursor::new(&mut bytes), path, &header)?);
    let outcome = simulate::fly(COMMAND, &plan, seed, duration_s, &mut recorder, stop)?;
    recorder.finish()?;
    let held = reader::parse(path, &bytes, None)?;
    Ok(Flown { log: Log::of(IN_MEMORY.into(), held), bytes, fault: outcome.fault.map(|fault| fault.to_string()) })
}

impl Flown {
    /// Writes the log. A file that exists is kept.
    ///
    /// # Errors
    /// The file exists, or its folder cannot take it.
    pub fn save(&self, path: &Path) -> Result<()> {
        let name = path.display();
        if path.exists() {
            return Err(anyhow!("{name} exists and is kept; give the log another name"));
        }
        files::write(path, &self.bytes)
            .map_err(|error| anyhow!("cannot write the log {name}: {error}; check the folder"))
    }

    /// A column of the cycles by its name in the log; not a number where a cycle lacks it.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let (_, of) = COLUMNS.iter().find(|(known, _)| *known == name)?;
        Some(self.log.held.cycles.iter().map(|cycle| of(cycle).unwrap_or(f64::NAN)).collect())
    }

    /// The names of the columns.
    pub fn columns() -> impl Iterator<Item = &'static str> {
        COLUMNS.iter().map(|(name, _)| *name)
    }
}

/// A quantity of a cycle.
type Quantity = fn(&Cycle) -> Option<f64>;

/// The quantities of a cycle that are numbers, by their names in the log.
const COLUMNS: [(&str, Quantity); 16] = [
    ("time_s", |cycle| Some(cycle.time_s)),
    ("period_s", |cycle| Some(cycle.period_s)),
    ("setpoint_mm", |cycle| cycle.setpoint_mm),
    ("control_percent", |cycle| cycle.control_percent),
    ("commanded_duty_percent", |cycle| Some(cycle.commanded_duty_percent)),
    ("duty_percent", |cycle| Some(cycle.duty_percent)),
    ("position_mm", |cycle| cycle.position_mm),
    ("fresh", |cycle| Some(f64::from(u8::from(cycle.fresh)))),
    ("position2_mm", |cycle| cycle.position2_mm),
    ("fan_rpm", |cycle| cycle.fan_rpm),
    ("velocity_mm_per_s", |cycle| cycle.velocity_mm_per_s),
    ("estimated_position_mm", |cycle| cycle.estimated_position_mm),
    ("estimated_fan_percent", |cycle| cycle.estimated_fan_percent),
    ("estimated_disturbance_percent", |cycle| cycle.estimated_disturbance_percent),
    ("innovation_mm", |cycle| cycle.innovation_mm),
    ("innovation_test_ratio", |cycle| cycle.innovation_test_ratio),
];
