//! From logs of one rig and a config to a diagnosis: what `diagnose` does with the named logs.

use super::{Usage, typed};
use crate::analysis::closed_loop;
use crate::analysis::log_errors::{LogErrors, log_errors};
use crate::analysis::loop_deviations::{Upstream, upstream};
use crate::analysis::next_experiment::{Advice, advise};
use crate::analysis::virtual_flight::Desk;
use crate::log::reader::{self, LoadedLog};
use crate::report::diagnosis::logs::Logs;
use crate::report::first_belief;
use crate::report::kit::page::made::Made;
use anyhow::{Result, bail};
use config::words::Words;
use config::{Config, OWN_EFFECT_ADVICE, Tables};
use control::compensation::Compensation;
use diagnose::{ClosedLoop, Context, Diagnosis, Document, MOST_ROWS, Options, Recording, SourceColumns, Verdict};
use plant::Model;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// The steps of a diagnosis, in words.
pub(crate) const STEPS: [&str; 3] =
    ["searching for what is missing", "flying the loop again", "choosing the next experiment"];

/// Logs and the belief about the rig that wrote them.
pub(crate) struct Asked {
    /// The belief.
    pub(crate) belief: Model,
    /// The file of the config that it is part of, and those that are merged over it.
    pub(crate) files: Vec<PathBuf>,
    /// Its tables.
    tables: Tables,
    /// The columns that the logs were read from.
    pub(crate) columns: SourceColumns,
    /// What the rig calls its position and its input.
    pub(crate) words: Words,
    /// What a diagnosis with it means, if `airball init` fitted it to a record, and it was not changed since.
    meaning: Option<&'static str>,
    /// Each log, without the codes of a sensor that saw no target, of a very long one its middle; and its name.
    pub(crate) logs: Vec<LoadedLog>,
    pub(crate) names: Vec<String>,
    /// Their rows as they were read, log by log.
    pub(crate) recordings: Vec<Recording>,
}

/// The diagnosis, its meaning for the loop, and the next flight.
pub(crate) struct Answer {
    /// The diagnosis.
    pub(crate) found: Diagnosis,
    /// The closed loop before and after.
    pub(crate) looped: ClosedLoop,
    /// The next flight.
    pub(crate) advice: Advice,
    /// Deviations of the loop from its config, before the duty reaches the fan, and the number of the log.
    pub(crate) upstream: Vec<(usize, Upstream)>,
    /// The forecast errors of each of several logs.
    pub(crate) errors: Vec<LogErrors>,
}

/// Checks that the effects which are left out exist: a name that is misspelt leaves out nothing.
fn check_names(without: &[String], belief: &Model) -> Result<(), Usage> {
    match without.iter().find(|name| belief.effects.entry(name).is_none()) {
        Some(unknown) => {
            let known: Vec<&str> = belief.effects.catalogue().map(|entry| entry.name).collect();
            let known = known.join(", ");
            Err(Usage(format!("--without {unknown}: there is no such effect; known are {known}; {OWN_EFFECT_ADVICE}")))
        }
        None => Ok(()),
    }
}

impl Asked {
    /// Reads all; `without`: the effects that are left out of the search.
    ///
    /// # Errors
    /// A config that is not sound, an effect that it does not know, a log that cannot be read, a flight that is named twice, logs of different rigs.
    pub(crate) fn read(
        command: &'static str,
        paths: &[PathBuf],
        config: &Path,
        patches: &[PathBuf],
        without: &[String],
    ) -> Result<Self> {
        let config = Config::read(config, patches)?;
        let names = paths.iter().map(|path| path.display().to_string()).collect();
        let import = config.tables.import.clone();
        let read = || paths.iter().map(|path| Ok(reader::read(path, import.as_ref())?)).collect();
        Self::of(command, config, names, read, without)
    }

    /// The same of logs that `read` gives, once the config is known to be sound for them.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(crate) fn of(
        command: &'static str,
        config: Config,
        names: Vec<String>,
        read: impl FnOnce() -> Result<Vec<LoadedLog>>,
        without: &[String],
    ) -> Result<Self> {
        let belief = config.need(command, "plant", |tables| tables.plant.as_ref())?.clone();
        check_names(without, &belief)?;
        let mut logs = read()?;
        check_one_rig(&names, &logs)?;
        for (_, name) in logs.iter().zip(&names).filter(|(log, _)| !log.recording.has_setpoint()) {
            config.refuse_setpoint(&no_setpoint(name), |effect| !without.iter().any(|left_out| left_out == effect))?;
        }
        let recordings = logs.iter().map(|log| log.recording.clone()).collect();
        let rows: usize = logs.iter().map(|log| log.recording.samples().len()).sum();
        if rows > MOST_ROWS {
            // The diagnosis takes stretches of the recordings itself; the loop is flown again along one of each log.
            let each = MOST_ROWS / logs.len().max(1);
            logs.iter_mut().for_each(|log| log.keep_middle(each));
        }
        logs.iter_mut().for_each(|log| log.discard_implausible_readings(&belief));
        let meaning = first_belief::meaning(config.first_line(), &belief);
        Ok(Self {
            belief,
            files: config.files().map(Path::to_owned).collect(),
            words: config.words,
            columns: config.tables.source_columns(),
            tables: config.tables,
            meaning,
            logs,
            names,
            recordings,
        })
    }

    /// The file of the config.
    pub(crate) fn config(&self) -> std::path::Display<'_> {
        self.files[0].display()
    }

    /// The compensation of the config.
    pub(crate) const fn compensation(&self) -> Option<&Compensation> {
        self.tables.compensation.as_ref()
    }

    /// Their rows without the readings that show no position of a ball in the pipe, log by log.
    pub(crate) fn seen(&self) -> impl Iterator<Item = Recording> {
        self.logs.iter().map(|log| log.recording.clone())
    }

    /// How a page of the logs is made: by the command as it was typed.
    pub(crate) fn made(&self) -> Made {
        self.made_by(typed())
    }

    /// The same by another command.
    pub(crate) fn made_by(&self, command: Made) -> Made {
        let several = self.names.len() > 1;
        let logs = self.logs.iter().zip(&self.names);
        let made = command.in_words(&self.words).of_model(&self.belief).in_config(&self.files);
        logs.fold(made, |made, (log, name)| made.with_log(several.then_some(name.as_str()), &log.about))
    }

    /// The statements about the logs themselves.
    pub(crate) fn about<'a>(&'a self, answer: &'a Answer) -> Logs<'a> {
        let duration_s = self.recordings.iter().map(Recording::duration_s).sum();
        Logs {
            names: &self.names,
            columns: &self.columns,
            duration_s,
            upstream: &answer.upstream,
            belief: self.meaning,
            errors: &answer.errors,
        }
    }

    /// Diagnoses the logs, and reports to `progress` which of its [`STEPS`] begins.
    pub(crate) fn diagnose(&self, options: &Options, progress: &dyn Fn(&'static str)) -> Answer {
        let [search, fly, choose] = STEPS;
        progress(search);
        let options = Options { is_fitted: self.meaning.is_some(), ..options.clone() };
        let found = diagnose::diagnose(&self.belief, &self.recordings, &options);
        let mended = (found.verdict != Verdict::InsufficientData).then_some(&found.mended.model);
        progress(fly);
        // Without a gap nothing was mended that the loop could be flown with.
        let corrected = mended.filter(|_| found.verdict != Verdict::NoGap);
        let looped = closed_loop::measure(&self.logs, &self.tables, &self.belief, corrected);
        progress(choose);
        let together = Recording::together(self.seen());
        // No flight mends a unit.
        let mistaken = found.has_mistake();
        let advice = if mistaken { Advice::default() } else { advise(&found, &together, self.desk(), &self.belief) };
        let of_log = |(number, log)| upstream(log, &found.mended.model).into_iter().map(move |stage| (number, stage));
        let upstream = self.logs.iter().enumerate().flat_map(of_log).collect();
        let seen: Vec<Recording> = self.seen().collect();
        let errors = mended.map_or_else(Vec::new, |mended| log_errors(&self.belief, mended, &seen));
        Answer { found, looped, advice, upstream, errors }
    }

    /// The controller that flew the last log, as far as it is known.
    pub(crate) fn desk(&self) -> Option<Desk> {
        self.logs.last().and_then(|log| Desk::that_flew(log, &self.tables))
    }

    /// The document that `diagnose --json` writes.
    pub(crate) fn document(&self, answer: &Answer) -> Result<String> {
        let Answer { found, looped, advice, .. } = answer;
        let about = self.about(answer);
        let context = Context {
            names: self.names.clone(),
            columns: self.columns.clone(),
            duration_s: about.duration_s,
            deviations: about.deviations(),
            findings: about.findings_of_loop().chain(advice.findings.iter().cloned()).collect(),
            closed_loop: Some(*looped),
            next_experiment: advice.experiment.clone(),
        };
        let document = found.document(&self.belief, &context);
        if self.words.is_ball_pipe() {
            return Ok(serde_json::to_string(&document)?);
        }
        Ok(serde_json::to_string(&InWords { document, rig: &self.words })?)
    }
}

/// A document of a rig with words of its own.
#[derive(Serialize)]
struct InWords<'a> {
    #[serde(flatten)]
    document: Document,
    rig: &'a Words,
}

/// Why the setpoint is not known, and what to do.
pub(crate) fn no_setpoint(log: &str) -> String {
    format!("{log} has none; name its column in [import], or leave the effect out")
}

/// Refuses a flight that is named twice, which would count as twice the evidence, and logs of two rigs, as far as the
/// logs name them.
fn check_one_rig(names: &[String], logs: &[LoadedLog]) -> Result<()> {
    let rig = |log: &LoadedLog| {
        let held = toml::from_str::<Tables>(log.config_toml.as_deref()?).ok()?;
        held.rig.map(|rig| rig.name)
    };
    for (number, log) in logs.iter().enumerate() {
        for (before, name) in logs.iter().zip(names).take(number) {
            let own = &names[number];
            if before.recording == log.recording {
                bail!("{name} and {own} hold the same flight; name it once");
            }
            if let Some((a, b)) = rig(before).zip(rig(log)).filter(|(a, b)| a != b) {
                bail!("{name} is of {a}, {own} of {b}; diagnose the logs of each rig by themselves");
            }
        }
    }
    Ok(())
}
