//! `airball diagnose`: what separates a log from a model.

use super::diagnosing::Asked;
use super::{note, say};
use crate::cli::DiagnoseArgs;
use crate::next::Advice;
use crate::report::diagnosis::{patch, words};
use crate::report::{closed_loop, next};
use anyhow::{Result, anyhow};
use std::path::Path;

/// Diagnoses a log and says what was found.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a patch or an experiment that cannot be written.
pub fn diagnose(args: &DiagnoseArgs) -> Result<()> {
    let asked = Asked::read("diagnose", &args.log, &args.config.config, &args.config.patch)?;
    if let Some(lost) = &asked.log.truncated {
        note(format_args!("{}: {lost}", args.log.display()));
    }
    let answer = asked.diagnose(&diagnose::Options::default());
    if let Some(path) = &args.patch_out {
        write("patch", path, &patch(&answer.found))?;
    }
    if let Some(path) = &args.next_out {
        write_next(path, &answer.advice)?;
    }
    if args.json {
        return say(asked.document(&answer)?);
    }
    for finding in &answer.found.findings {
        note(format_args!("{}: {finding}", args.log.display()));
    }
    say(words(&answer.found))?;
    closed_loop::words(&answer.looped).into_iter().chain(next::words(&answer.advice)).try_for_each(say)
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
