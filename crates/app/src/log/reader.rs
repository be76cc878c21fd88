//! From any log to a recording: our own MCAP, that of another program, Parquet, or any CSV, packed with zstd or gzip or
//! not.
//!
//! A cycle becomes a row, with a position only if it was measured in that cycle; a repeated one is no reading.

use super::LogError;
use super::event::EventMessage;
use super::flight::{self, Flight};
use super::foreign;
use super::header::About;
use super::packed::unpacked;
use super::parquet;
use crate::flight::vocabulary::Cycle;
use diagnose::{Finding, FlightFinding, Recording, Sample, check, mistakes, plausible};
use plant::Model;
use rows::{Import, RowsError, Sheet};
use std::{borrow::Cow, fs, path::Path};

/// A log for replay and diagnosis.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedLog {
    /// The rows.
    pub recording: Recording,
    /// The log's metadata; of a CSV, none.
    pub about: About,
    /// The config that was in force, if the log has it.
    pub config_toml: Option<String>,
    /// The control periods; of a CSV, none.
    pub cycles: Vec<Cycle>,
    /// The events; of a CSV, none.
    pub events: Vec<EventMessage>,
    /// What is missing from the file, in words and numbers, if anything is: a warning.
    pub truncated: Option<String>,
}

impl LoadedLog {
    /// Discards the readings that are no position of a ball in the pipe of `model`: the sensor's codes for "no target",
    /// and those far outside.
    pub fn discard_implausible_readings(&mut self, model: &Model) {
        if let Cow::Owned(seen) = plausible(Cow::Borrowed(&self.recording), model) {
            self.recording = seen;
        }
    }

    /// What is wrong with the record beside `model`, which is believed, and whether units, signs or columns are.
    /// Implausible readings are discarded.
    pub fn check(&mut self, model: &Model) -> (Vec<Finding>, bool) {
        let mut findings = check(&self.recording, model);
        self.discard_implausible_readings(model);
        let wrong = mistakes(model, std::slice::from_ref(&self.recording));
        for FlightFinding { finding, .. } in &wrong {
            if !findings.contains(finding) {
                findings.push(*finding);
            }
        }
        (findings, !wrong.is_empty())
    }

    /// When a command first changed the controller, its numbers or the experiment, s; infinite if none did.
    #[must_use]
    pub fn law_changes_at_s(&self) -> f64 {
        let changes =
            |text: &str| ["gains ", "controller ", "numbers ", "experiment "].iter().any(|kind| text.starts_with(kind));
        let change = self.events.iter().find(|event| changes(&event.text) && event.text.ends_with("accepted"));
        change.map_or(f64::INFINITY, |event| event.time_s)
    }

    /// Keeps the `rows` in the middle, and what happened during them, of a log that has more.
    pub fn keep_middle(&mut self, rows: usize) {
        let all = self.recording.samples();
        let start = all.len().saturating_sub(rows) / 2;
        let Some(middle) = all.get(start..start + rows).filter(|middle| middle.len() < all.len()) else { return };
        let [Some(first), Some(last)] = [middle.first(), middle.last()].map(|row| row.map(|row| row.time_s)) else {
            return;
        };
        let Ok(recording) = Recording::new(middle.to_vec()) else { return };
        self.recording = recording;
        self.cycles.retain(|cycle| (first..=last).contains(&cycle.time_s));
        self.cycles.shrink_to_fit();
        self.events.retain(|event| (first..=last).contains(&event.time_s));
    }
}

/// Reads a log, recognised by its first bytes. `import` maps the columns of a CSV.
///
/// # Errors
/// [`LogError`] names the file, the place, what is there and what to do.
pub fn read(path: &Path, import: Option<&Import>) -> Result<LoadedLog, LogError> {
    parse(path, &bytes(path)?, import)
}

/// The bytes of a log, unpacked.
fn bytes(path: &Path) -> Result<Vec<u8>, LogError> {
    if path.is_dir() {
        return Err(LogError::Folder { path: path.into() });
    }
    let bytes = fs::read(path).map_err(|source| LogError::Open { path: path.into(), source })?;
    Ok(unpacked(path, &bytes)?.into_owned())
}

/// A log of a rig that nobody has described: our own flight, or a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Undescribed {
    /// A flight, and the config that it holds.
    Flight(Option<String>),
    /// A table, column by column, and a sentence about the channels of an MCAP file that could not be read.
    Table(Sheet, Option<String>),
}

/// Reads what a log says about itself.
///
/// # Errors
/// As [`read`].
pub fn undescribed(path: &Path) -> Result<Undescribed, LogError> {
    let bytes = bytes(path)?;
    match flight_or_table(path, &bytes, None)? {
        FlightOrTable::Flight(flight) => Ok(Undescribed::Flight(flight.config_toml)),
        FlightOrTable::Table(table, unread) => match rows::sheet(&path.display().to_string(), &table) {
            Ok(sheet) => Ok(Undescribed::Table(sheet, unread)),
            Err(error) => Err(beside_unread(error, unread)),
        },
    }
}

/// Reads the bytes of a log that is not packed; `path` is only its name in messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8], import: Option<&Import>) -> Result<LoadedLog, LogError> {
    let import = import.cloned().unwrap_or_default();
    match flight_or_table(path, bytes, Some(&import))? {
        FlightOrTable::Flight(flight) => from_flight(path, *flight),
        FlightOrTable::Table(table, unread) => {
            from_table(path, &table, &import).map_err(|error| beside_unread(error, unread))
        }
    }
}

/// The error of a table, with the channels that it lacks.
fn beside_unread(source: RowsError, unread: Option<String>) -> LogError {
    match unread {
        Some(unread) => LogError::UnreadChannels { unread, source },
        None => source.into(),
    }
}

/// What a log holds.
enum FlightOrTable<'a> {
    /// A flight of airball.
    Flight(Box<Flight>),
    /// Anything else, as CSV, and a sentence about the channels that could not be read.
    Table(Cow<'a, [u8]>, Option<String>),
}

fn flight_or_table<'a>(path: &Path, bytes: &'a [u8], import: Option<&Import>) -> Result<FlightOrTable<'a>, LogError> {
    if parquet::is_parquet(bytes) {
        return parquet::table(path, bytes).map(|csv| FlightOrTable::Table(Cow::Owned(csv), None));
    }
    if !flight::is_mcap(bytes) {
        return Ok(FlightOrTable::Table(Cow::Borrowed(bytes), None));
    }
    match flight::parse(path, bytes) {
        Ok(flight) => Ok(FlightOrTable::Flight(Box::new(flight))),
        Err(none @ LogError::NoCycles { .. }) => match foreign::table(path, bytes, import) {
            Some(table) => table.map(|table| FlightOrTable::Table(Cow::Owned(table.csv), table.unread)),
            None => Err(none),
        },
        Err(error) => Err(error),
    }
}

fn from_table(path: &Path, bytes: &[u8], import: &Import) -> Result<LoadedLog, RowsError> {
    let (recording, truncated) = rows::recording_and_loss(&path.display().to_string(), bytes, import)?;
    Ok(LoadedLog {
        recording,
        about: About::default(),
        config_toml: None,
        cycles: Vec::new(),
        events: Vec::new(),
        truncated,
    })
}

fn from_flight(path: &Path, flight: Flight) -> Result<LoadedLog, LogError> {
    let Flight { about, config_toml, cycles, events, truncated, .. } = flight;
    let samples = cycles.iter().map(sample).collect();
    let recording = Recording::new(samples).map_err(|source| LogError::NotARecording { path: path.into(), source })?;
    Ok(LoadedLog { recording, about, config_toml, cycles, events, truncated })
}

/// The row of a recording for a cycle.
#[must_use]
pub fn sample(cycle: &Cycle) -> Sample {
    Sample {
        time_s: cycle.time_s,
        setpoint_mm: cycle.setpoint_mm,
        control_percent: cycle.control_percent,
        duty_percent: cycle.duty_percent,
        position_mm: cycle.position_mm.filter(|_| cycle.fresh),
        fan_rpm: cycle.fan_rpm,
        position2_mm: cycle.position2_mm,
    }
}
