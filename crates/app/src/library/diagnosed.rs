//! A diagnosis as a value: document, words, page, patch, and the data of its pictures.

use super::{Belief, Log};
use crate::analysis::virtual_flight::Desk;
use crate::commands::diagnose::with_report;
use crate::commands::diagnosing::{Answer, Asked};
use crate::report::diagnosis::page::{first_screen, page};
use crate::report::diagnosis::words::words_of;
use crate::report::diagnosis::{closed_loop, next};
use crate::report::kit::page::made::Made;
use anyhow::Result;
use diagnose::{FreeRun, MissingForce, Options, Recording, Series};
use std::path::Path;

/// Logs of one rig, and the diagnosis of them.
pub struct Diagnosed {
    asked: Asked,
    answer: Answer,
    document: String,
}

/// What a picture of a diagnosis shows.
#[derive(Clone, Debug)]
pub struct Pictured {
    /// The rows that the diagnosis used.
    pub recording: Recording,
    /// Free runs of the believed model.
    pub nominal: FreeRunPoints,
    /// The same of the mended model.
    pub mended: FreeRunPoints,
    /// The force that the refitted belief lacks.
    pub missing: Vec<MissingForce>,
}

/// Free runs one after another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeRunPoints {
    /// The row of the recording that each forecast is of.
    pub rows: Vec<usize>,
    /// The forecast position, mm.
    pub position_mm: Vec<f64>,
    /// The number of the run.
    pub runs: Vec<usize>,
}

impl FreeRunPoints {
    fn of(runs: &[FreeRun]) -> Self {
        let mut points = Self::default();
        for (number, run) in runs.iter().enumerate() {
            let forecasts = run.forecasts.iter().map(|forecast| (forecast.row, forecast.position_mm));
            for (row, position_mm) in std::iter::once((run.row, run.start_mm)).chain(forecasts) {
                points.rows.push(row);
                points.position_mm.push(position_mm);
                points.runs.push(number);
            }
        }
        points
    }
}

impl Diagnosed {
    /// Diagnoses logs of one rig; `step` hears which part begins.
    ///
    /// # Errors
    /// A config without a model, an effect that it does not know, a flight that is named twice, logs of different rigs.
    pub fn new(belief: &Belief, logs: &[Log], options: &Options, step: &dyn Fn(&'static str)) -> Result<Self> {
        let asked = asked("diagnose", belief, logs, &options.without)?;
        let answer = asked.diagnose(options, step);
        let document = asked.document(&answer)?;
        Ok(Self { asked, answer, document })
    }

    /// The document of `airball diagnose --json`.
    #[must_use]
    pub fn document(&self) -> &str {
        &self.document
    }

    /// The diagnosis as `airball diagnose` prints it.
    #[must_use]
    pub fn words(&self) -> String {
        let (desk, rig) = (self.asked.desk(), &self.asked.words);
        let words = words_of(&self.answer.found, desk.as_ref().map(Desk::compensation), rig, &self.asked.columns);
        let more = closed_loop::words(&self.answer.looped).into_iter().chain(next::words(&self.answer.advice));
        std::iter::once(words).chain(more).map(|line| rig.of(&line)).collect::<Vec<_>>().join("\n")
    }

    /// The mended model as a patch of the config; empty where nothing changes.
    #[must_use]
    pub fn patch(&self) -> String {
        self.answer.found.patch_toml()
    }

    /// The next experiment as a file, where one is needed.
    #[must_use]
    pub fn next_experiment(&self) -> Option<&str> {
        self.answer.advice.experiment.as_ref().map(|next| next.file.as_str())
    }

    /// The report as one self-contained page; `command` says how it was made.
    #[must_use]
    pub fn page(&self, command: &[String]) -> String {
        with_report(&self.asked, &self.answer, &self.series(), &self.made(command), page)
    }

    /// Writes the report. Only an older page of this program is replaced.
    ///
    /// # Errors
    /// A file of that name that is no page, or a folder that cannot take it.
    pub fn write_page(&self, path: &Path, command: &[String]) -> Result<()> {
        crate::report::kit::page::may_write(path)?;
        Ok(crate::report::kit::page::write(path, &self.page(command))?)
    }

    /// What is seen first of the report, as a page without a script.
    #[must_use]
    pub fn first_screen(&self) -> String {
        with_report(&self.asked, &self.answer, &self.series(), &self.made(&[]), first_screen)
    }

    /// The data of a picture.
    #[must_use]
    pub fn picture(&self) -> Pictured {
        let Series { recording, nominal, mended, missing, .. } = self.series();
        let [nominal, mended] = [nominal, mended].map(|runs| FreeRunPoints::of(&runs));
        Pictured { recording, nominal, mended, missing }
    }

    fn series(&self) -> Series {
        Series::of(&self.answer.found, &self.asked.belief, &self.asked.recordings)
    }

    fn made(&self, command: &[String]) -> Made {
        self.asked.made_by(Made::by(command.iter().cloned()))
    }
}

/// Logs and a belief, checked against each other.
pub(super) fn asked(command: &'static str, belief: &Belief, logs: &[Log], without: &[String]) -> Result<Asked> {
    let names = logs.iter().map(|log| log.name().to_owned()).collect();
    let read = || Ok(logs.iter().map(|log| log.held.clone()).collect());
    Asked::of(command, belief.0.clone(), names, read, without)
}
