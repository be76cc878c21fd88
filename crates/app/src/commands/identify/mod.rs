//! `airball identify`: a plant from what a rig did.

mod grey_box;
mod third_pole;
mod transient;

use super::diagnosing::Asked;
use super::{may_write, note, say, write};
use crate::cli::{IdentifyArgs, IdentifyCommand};
use ::diagnose::FlightFinding;
use anyhow::{Result, bail};
use plant::effects::FanLag;
use plant::{Effect, Effects, Entry, Model};
use serde::Serialize;
use std::path::PathBuf;

/// The command that configs and errors are told.
const NAME: &str = "identify";

/// Identifies, and says it.
///
/// # Errors
/// A config that is not sound, a log that cannot be read or says too little, a file that cannot be written.
pub fn identify(command: &IdentifyCommand) -> Result<()> {
    match command {
        IdentifyCommand::GreyBox(args) => grey_box::grey_box(args),
        IdentifyCommand::Transient(args) => transient::transient(args),
        IdentifyCommand::ThirdPole(args) => third_pole::third_pole(args),
    }
}

/// Reads logs and the model to begin with.
fn read(logs: &[PathBuf], args: &IdentifyArgs) -> Result<Asked> {
    may_write(args.plot.as_deref(), args.html.as_deref())?;
    let asked = Asked::read(NAME, logs, &args.config.config, &args.config.patch)?;
    has_one_lag(&asked.belief)?;
    for (log, name) in asked.logs.iter().zip(&asked.names) {
        if let Some(lost) = &log.truncated {
            note(format_args!("{name}: {lost}"));
        }
    }
    Ok(asked)
}

/// A patch can add a table and change it, and not take one away.
fn has_one_lag(model: &Model) -> Result<()> {
    let excluded = |entry: &Entry| Effects::exclude_each_other(entry.name, FanLag::ENTRY.name);
    match model.effects.present().iter().find(|entry| excluded(entry)) {
        Some(entry) => bail!(
            "the config has [plant.effects.{}], and a lag of the fan excludes it; identify with a config without that table",
            entry.name
        ),
        None => Ok(()),
    }
}

/// What the check of the logs found, each with the log that it is of.
fn said(asked: &Asked, findings: &[FlightFinding]) -> Vec<String> {
    findings.iter().map(|noted| format!("{}: {}", asked.names[noted.flight], noted.finding)).collect()
}

/// Writes the patch that was asked for.
fn write_patch(args: &IdentifyArgs, patch: &str) -> Result<()> {
    args.patch_out.as_ref().map_or(Ok(()), |path| write("patch", path, patch))
}

/// The config that was begun with, by its name.
fn config(args: &IdentifyArgs) -> String {
    args.config.config.display().to_string()
}

/// Says the document where JSON is asked for, and else the words.
fn conclude(args: &IdentifyArgs, document: &impl Serialize, words: Vec<String>) -> Result<()> {
    if args.json {
        return say(serde_json::to_string(document)?);
    }
    words.into_iter().try_for_each(say)
}
