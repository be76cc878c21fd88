//! `airball diagnose`: what separates a log from a model.

use super::{note, say};
use crate::cli::DiagnoseArgs;
use crate::closed_loop::ClosedLoop;
use crate::config::Config;
use crate::log::reader;
use crate::next::{Advice, advise};
use crate::report::diagnosis::{DiagnosisDocument, patch, words};
use crate::report::{closed_loop, next};
use anyhow::{Result, anyhow};
use diagnose::Verdict;
use std::path::Path;

/// Diagnoses a log and says what was found.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a patch or an experiment that cannot be written.
pub fn diagnose(args: &DiagnoseArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.patch)?;
    let model = config.need("diagnose", "plant", |tables| tables.plant.as_ref())?;
    let log = reader::read(&args.log, config.tables.import.as_ref())?;
    if let Some(lost) = &log.truncated {
        note(format_args!("{}: {lost}", args.log.display()));
    }
    let found = diagnose::diagnose(model, &log.recording, &diagnose::Options::default());
    let mended = (found.verdict != Verdict::InsufficientData).then_some(&found.mended.model);
    let looped = ClosedLoop::measure(&log, &config.tables, model, mended);
    let advice = advise(&found, &log, &config.tables, model);
    if let Some(path) = &args.patch_out {
        write("patch", path, &patch(&found))?;
    }
    if let Some(path) = &args.next_out {
        write_next(path, &advice)?;
    }
    if args.json {
        return say(serde_json::to_string(&DiagnosisDocument::of(&found, model, &looped, &advice))?);
    }
    for finding in &found.findings {
        note(format_args!("{}: {finding}", args.log.display()));
    }
    say(words(&found))?;
    closed_loop::words(&looped).into_iter().chain(next::words(&advice)).try_for_each(say)
}

/// Writes the next experiment; where none is called for, a file that could not be flown is not written.
fn write_next(path: &Path, advice: &Advice) -> Result<()> {
    match &advice.experiment {
        Some(next) => write("experiment", path, &next.file),
        None => {
            note(format_args!("no further experiment is called for; {} was not written", path.display()));
            Ok(())
        }
    }
}

fn write(what: &str, path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text)
        .map_err(|error| anyhow!("cannot write the {what} {}: {error}; check the folder", path.display()))
}
