//! A log as a value.

use super::Belief;
use crate::log::LogError;
use crate::log::header::About;
use crate::log::reader::{self, LoadedLog};
use diagnose::{Recording, RecordingError, Sample};
use std::path::Path;

/// A log, and the name that messages give it.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    name: String,
    pub(super) held: LoadedLog,
}

impl Log {
    /// Reads an MCAP of this program or a CSV. `belief` says which columns are what.
    ///
    /// # Errors
    /// [`LogError`] names file, place and what to do.
    pub fn read(path: &Path, belief: Option<&Belief>) -> Result<Self, LogError> {
        let import = belief.and_then(|belief| belief.0.tables.import.as_ref());
        Ok(Self { name: path.display().to_string(), held: reader::read(path, import)? })
    }

    /// Rows that are in no file.
    ///
    /// # Errors
    /// [`RecordingError`] names the first row that is wrong.
    pub fn of_rows(name: &str, rows: Vec<Sample>) -> Result<Self, RecordingError> {
        let (recording, about) = (Recording::new(rows)?, About::default());
        let held =
            LoadedLog { recording, about, config_toml: None, cycles: Vec::new(), events: Vec::new(), truncated: None };
        Ok(Self { name: name.into(), held })
    }

    /// The same log under another name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.into(), ..self }
    }

    pub(super) const fn of(name: String, held: LoadedLog) -> Self {
        Self { name, held }
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its rows.
    #[must_use]
    pub const fn recording(&self) -> &Recording {
        &self.held.recording
    }

    /// Whether its rows are all that it holds: no events, no cycles, no config.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        let LoadedLog { config_toml, cycles, events, .. } = &self.held;
        config_toml.is_none() && cycles.is_empty() && events.is_empty()
    }

    /// What is missing from the file, if anything is.
    #[must_use]
    pub fn truncated(&self) -> Option<&str> {
        self.held.truncated.as_deref()
    }
}
