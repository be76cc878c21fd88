//! The tables of the config file, in the order of the signal path. A command checks for the tables it needs.

use super::Rig;
use super::mqtt::MqttConfig;
use super::predistorted;
use super::source_columns::source_columns;
use super::topics::Topics;
use control::check::{OutOfRange, within};
use control::compensation::Compensation;
use control::controller::{Controllers, Kind};
use control::observer::Observer;
use control::waveform::Waveform;
use diagnose::SourceColumns;
use plant::{DefinitionTable, Model, Unsound};
use rows::Import;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Everything that a config file may hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tables {
    /// `[rig]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<Rig>,
    /// `[bus]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bus: Option<Bus>,
    /// `[loop]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r#loop: Option<Loop>,
    /// `[reference]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
    /// `[controller]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub controller: Option<Controllers>,
    /// `[observer]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observer: Option<Observer>,
    /// `[compensation]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compensation: Option<Compensation>,
    /// `[safety]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safety: Option<Safety>,
    /// `[mqtt]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt: Option<MqttConfig>,
    /// `[log]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log: Option<Log>,
    /// `[plant]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<Model>,
    /// `[effect.NAME]`: effects that a user wrote.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub effect: BTreeMap<String, DefinitionTable>,
    /// `[import]`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub import: Option<Import>,
}

/// `[bus]`: where the chips are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bus {
    /// Device file of the I2C bus, or `unix:` and the socket of `airball emulate`.
    pub device: String,
}

impl Bus {
    /// The socket of an emulated bus, where the device is not one of the kernel.
    #[must_use]
    pub fn socket(&self) -> Option<&str> {
        self.device.strip_prefix("unix:")
    }
}

/// `[loop]`: when the cycle runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Loop {
    /// Time from one deadline to the next, seconds.
    pub period_s: f64,
    /// A cycle that begins later than this after its deadline is counted as late, seconds.
    pub late_after_s: f64,
}

/// `[reference]`: the setpoint without commands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Setpoint over time, mm.
    pub setpoint_mm: Waveform,
}

/// `[safety]`: limits of every command and experiment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Safety {
    /// Smallest setpoint, mm.
    pub setpoint_min_mm: f64,
    /// Largest setpoint, mm.
    pub setpoint_max_mm: f64,
    /// Smallest duty in flight, percent.
    pub duty_min_percent: f64,
    /// Largest duty in flight, percent.
    pub duty_max_percent: f64,
    /// How long the fan holds hover without a new reading before it is turned off, seconds.
    pub coast_s: f64,
    /// How far the cycles may fall behind their deadlines before the fan is turned off, seconds.
    #[serde(default = "half_a_second")]
    pub stall_s: f64,
    /// When a ball counts as stuck; absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stuck: Option<Stuck>,
}

/// `[safety] stuck`: a ball that does not move although the controller pushes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stuck {
    /// The controller commands at least this much, percent of duty about hover.
    pub control_percent: f64,
    /// For at least this time, seconds.
    pub after_s: f64,
}

/// Two hover duties of one rig that differ by more than this factor are in different units.
const HOVERS: f64 = 5.0;

/// For configs from before this limit existed.
fn half_a_second() -> f64 {
    0.5
}

/// `[log]`: where logs are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Log {
    /// Directory of the logs, created when missing; relative to where the command runs.
    pub directory: String,
    /// File that keeps the last fault over a restart; absent: none is kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_fault: Option<PathBuf>,
    /// A flight in real time begins a new file after this time, seconds; absent: one file per flight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part_s: Option<f64>,
    /// The oldest logs of the directory are deleted when all together are larger than this, megabytes; absent: none is
    /// deleted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep_mb: Option<f64>,
}

impl Tables {
    /// Checks every number of every table that is present.
    ///
    /// # Errors
    /// The table (dotted) and the first thing wrong in it.
    pub fn check(&self) -> Result<(), (String, Unsound)> {
        self.check_loop().map_err(|(table, error)| (table, error.into()))?;
        self.plant
            .as_ref()
            .map_or(Ok(()), Model::check)
            .map_err(|(table, error)| (if table.is_empty() { "plant".into() } else { format!("plant.{table}") }, error))
    }

    /// Everything but the plant.
    fn check_loop(&self) -> Result<(), (String, OutOfRange)> {
        let at = |table: &str| {
            let table = table.to_owned();
            move |error| (table, error)
        };
        self.rig.as_ref().map_or(Ok(()), Rig::check).map_err(at("rig"))?;
        self.r#loop.map_or(Ok(()), |table| table.check()).map_err(at("loop"))?;
        let controllers = self.controller.as_ref().map_or(Ok(()), Controllers::check);
        controllers.map_err(|(table, error)| (format!("controller.{table}"), error))?;
        if let Some(observer) = &self.observer {
            observer.believed.check().map_err(at("observer.believed"))?;
            observer.check().map_err(at("observer"))?;
        }
        self.compensation.as_ref().map_or(Ok(()), Compensation::check).map_err(at("compensation"))?;
        self.safety.map_or(Ok(()), |table| table.check()).map_err(at("safety"))?;
        self.log.as_ref().map_or(Ok(()), Log::check).map_err(at("log"))?;
        if let Some(reference) = &self.reference {
            let (min, max) = self.safety.map_or((-1e6, 1e6), |s| (s.setpoint_min_mm, s.setpoint_max_mm));
            reference.setpoint_mm.check(min, max).map_err(at("reference.setpoint_mm"))?;
        }
        self.check_across().map_err(|(table, error)| (table.to_owned(), error))
    }
}

impl Tables {
    /// Checks the constraints between tables.
    fn check_across(&self) -> Result<(), (&'static str, OutOfRange)> {
        let Some(safety) = self.safety else { return Ok(()) };
        if let Some(rig) = &self.rig {
            within("setpoint_max_mm", safety.setpoint_max_mm, 0.0, rig.sensor_to_bottom_mm)
                .map_err(|error| ("safety", error))?;
        }
        if let Some(compensation) = &self.compensation {
            let (lowest, highest) = (safety.duty_min_percent, safety.duty_max_percent);
            within("hover_duty_percent", compensation.hover_duty_percent, lowest, highest)
                .map_err(|error| ("compensation", error))?;
        }
        Ok(())
    }

    /// The columns that a record is read from.
    pub fn source_columns(&self) -> SourceColumns {
        self.import.as_ref().map(source_columns).unwrap_or_default()
    }

    /// Tells the model the length of a turn, where the unit of the imported position says that it is an angle.
    pub(super) fn turn_of_an_angle(&mut self) {
        if let Some((plant, import)) = self.plant.as_mut().zip(self.import.as_ref()) {
            plant.turn_mm = plant.turn_mm.or_else(|| import.position_mm.turn());
        }
    }

    /// Checks what is not a number: names and files.
    ///
    /// # Errors
    /// The dotted key, and what is wrong with it.
    pub fn check_words(&self) -> Result<(), (&'static str, String)> {
        if let Some(rig) = &self.rig {
            Topics::new(&rig.name).map_err(|error| ("rig.name", error.to_string()))?;
            rig.check_wiring()?;
        }
        if self.bus.as_ref().is_some_and(|bus| bus.device.is_empty()) {
            return Err(("bus.device", "it is empty; give the I2C bus, for instance /dev/i2c-1".into()));
        }
        if self.mqtt.as_ref().is_some_and(|mqtt| mqtt.port == Some(0)) {
            return Err(("mqtt.port", "no broker listens on port 0; the usual one is 1883, 8883 with TLS".into()));
        }
        self.check_observed()?;
        self.check_hover().map_err(|message| ("plant.hover_duty_percent", message))?;
        self.check_stall().map_err(|message| ("safety.stall_s", message))?;
        self.check_controller().map_err(|message| ("controller", message))?;
        predistorted::check(self)?;
        self.import.as_ref().map_or(Ok(()), Import::check).map_err(|error| ("import", error.to_string()))
    }

    /// Whether the tables that the observer needs are present.
    fn check_observed(&self) -> Result<(), (&'static str, String)> {
        let Some((rig, observer)) = self.rig.as_ref().zip(self.observer) else { return Ok(()) };
        let missing = |table: &str| {
            format!("there is no [{table}] whose readings it could use; add that table, or leave this key out")
        };
        if observer.tachometer.is_some() && rig.tachometer.is_none() {
            return Err(("observer.tachometer", missing("rig.tachometer")));
        }
        if observer.second_sensor_mm.is_some() && rig.second_sensor.is_none() {
            return Err(("observer.second_sensor_mm", missing("rig.second_sensor")));
        }
        Ok(())
    }

    /// Whether the two tables that hold the hover duty mean the same unit. A plant that differs from what its
    /// controllers believe is a gap; one that differs by a factor is a fraction, or counts.
    fn check_hover(&self) -> Result<(), String> {
        let Some((plant, compensation)) = self.plant.as_ref().zip(self.compensation.as_ref()) else { return Ok(()) };
        let (here, there) = (plant.hover_duty_percent, compensation.hover_duty_percent);
        let differ = here != 0.0 && there != 0.0 && !(1.0 / HOVERS..=HOVERS).contains(&(here / there));
        if !differ {
            return Ok(());
        }
        Err(format!(
            "it is {here}, and [compensation] hover_duty_percent = {there}: one of them is in another unit (a \
             fraction, or counts); both are in percent of duty: hover_duty_percent = {there}"
        ))
    }

    /// Whether a flight tolerates one late cycle.
    fn check_stall(&self) -> Result<(), String> {
        let Some((safety, table)) = self.safety.zip(self.r#loop) else { return Ok(()) };
        let (stall_s, period_s) = (safety.stall_s, table.period_s);
        if stall_s > period_s {
            return Ok(());
        }
        Err(format!(
            "{stall_s} s is not longer than [loop] period_s = {period_s} s: one late cycle would end the flight; give three periods or more"
        ))
    }

    /// Whether the named controllers are present, and what they need.
    fn check_controller(&self) -> Result<(), String> {
        let Some(controllers) = &self.controller else { return Ok(()) };
        let known = Kind::ALL.map(Kind::name).join(", ");
        match (controllers.first(), controllers.active) {
            (None, Some(kind)) => {
                let name = kind.name();
                Err(format!(
                    "active = \"{name}\", and there is no table [controller.{name}]; write it, or name another"
                ))
            }
            (None, None) => Err(format!("it holds no controller; write a table of one of {known}")),
            (Some(_), _) => match controllers.needs_observer().filter(|_| self.observer.is_none()) {
                Some(key) => {
                    Err(format!("{key} needs the table [observer]; copy it from the config.toml of the project"))
                }
                None => Ok(()),
            },
        }
    }
}

impl Loop {
    fn check(&self) -> Result<(), OutOfRange> {
        within("period_s", self.period_s, 0.005, 1.0)?;
        within("late_after_s", self.late_after_s, 0.0, 1.0)
    }
}

impl Log {
    fn check(&self) -> Result<(), OutOfRange> {
        self.part_s.map_or(Ok(()), |part_s| within("part_s", part_s, 10.0, 1e6))?;
        self.keep_mb.map_or(Ok(()), |keep_mb| within("keep_mb", keep_mb, 1.0, 1e6))
    }
}

impl Safety {
    fn check(&self) -> Result<(), OutOfRange> {
        within("setpoint_max_mm", self.setpoint_max_mm, 0.0, 2000.0)?;
        within("setpoint_min_mm", self.setpoint_min_mm, 0.0, self.setpoint_max_mm)?;
        within("duty_max_percent", self.duty_max_percent, 0.0, 100.0)?;
        within("duty_min_percent", self.duty_min_percent, 0.0, self.duty_max_percent)?;
        within("coast_s", self.coast_s, 0.0, 10.0)?;
        within("stall_s", self.stall_s, 0.05, 10.0)?;
        let Some(stuck) = self.stuck else { return Ok(()) };
        within("stuck.control_percent", stuck.control_percent, 0.1, 100.0)?;
        within("stuck.after_s", stuck.after_s, 0.2, 60.0)
    }
}
