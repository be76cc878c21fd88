//! A log and a config in, a diagnosis out: what `diagnose` does to one log and `blind` to a folder of them.

use crate::closed_loop::ClosedLoop;
use crate::config::{Config, Tables};
use crate::log::reader::{self, LoadedLog};
use crate::next::{Advice, advise};
use crate::report::diagnosis::DiagnosisDocument;
use anyhow::Result;
use diagnose::{Diagnosis, Options, Verdict};
use plant::Model;
use std::path::{Path, PathBuf};

/// A log and the belief about the rig that wrote it.
pub(super) struct Asked {
    /// The belief.
    pub(super) belief: Model,
    /// The config that it is part of.
    tables: Tables,
    /// The log.
    pub(super) log: LoadedLog,
}

/// What a diagnosis found, what it means for the loop, and what to fly next.
pub(super) struct Answer {
    /// The diagnosis.
    pub(super) found: Diagnosis,
    /// The closed loop before and after.
    pub(super) looped: ClosedLoop,
    /// What to fly next.
    pub(super) advice: Advice,
}

impl Asked {
    /// Reads both.
    ///
    /// # Errors
    /// A config that is not sound, a log that cannot be read.
    pub(super) fn read(command: &'static str, log: &Path, config: &Path, patches: &[PathBuf]) -> Result<Self> {
        let config = Config::read(config, patches)?;
        let belief = config.need(command, "plant", |tables| tables.plant.as_ref())?.clone();
        let log = reader::read(log, config.tables.import.as_ref())?;
        Ok(Self { belief, tables: config.tables, log })
    }

    /// Diagnoses the log.
    pub(super) fn diagnose(&self, options: &Options) -> Answer {
        let found = diagnose::diagnose(&self.belief, &self.log.recording, options);
        let mended = (found.verdict != Verdict::InsufficientData).then_some(&found.mended.model);
        let looped = ClosedLoop::measure(&self.log, &self.tables, &self.belief, mended);
        let advice = advise(&found, &self.log, &self.tables, &self.belief);
        Answer { found, looped, advice }
    }

    /// The document that `diagnose --json` writes.
    pub(super) fn document(&self, answer: &Answer) -> Result<String> {
        Ok(serde_json::to_string(&DiagnosisDocument::of(&answer.found, &self.belief, &answer.looped, &answer.advice))?)
    }
}
