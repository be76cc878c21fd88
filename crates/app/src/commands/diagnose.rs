//! `airball diagnose`: what separates the logs of a rig from a model.

use super::diagnosing::Asked;
use super::{note, say};
use crate::cli::DiagnoseArgs;
use crate::desk::Desk;
use crate::next::Advice;
use crate::report::diagnosis::{patch, words};
use crate::report::logs::findings;
use crate::report::{closed_loop, next};
use anyhow::{Result, anyhow};
use std::path::Path;

/// Diagnoses logs and says what was found.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a patch or an experiment that cannot be written.
pub fn diagnose(args: &DiagnoseArgs) -> Result<()> {
    let asked = Asked::read("diagnose", &args.logs, &args.config.config, &args.config.patch)?;
    for (log, name) in asked.logs.iter().zip(&asked.names) {
        if let Some(lost) = &log.truncated {
            note(format_args!("{name}: {lost}"));
        }
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
    for (name, finding) in findings(&answer.found, &asked.about()) {
        note(format_args!("{name}: {finding}"));
    }
    if let Some(line) = asked.about().words() {
        say(line)?;
    }
    let desk = asked.desk();
    say(words(&answer.found, desk.as_ref().map(Desk::compensation)))?;
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
