//! `airball identify`: a plant model from recorded flights.

pub(crate) mod grey_box;
mod per_control;
mod third_pole;
mod transient;

use super::diagnosing::Asked;
use super::{announce, may_write, say, warn, write};
use crate::cli::{IdentifyArgs, IdentifyCommand};
use ::diagnose::FlightFinding;
use anyhow::{Result, bail};
use plant::effects::FanLag;
use plant::{Effect, Effects, Entry, Model};
use serde::Serialize;
use std::path::PathBuf;

/// The command's name for configs and errors.
const NAME: &str = "identify";

/// Identifies and prints the result.
///
/// # Errors
/// A config that is not sound, a log that cannot be read or has too little information, a file that cannot be written.
pub fn identify(command: &IdentifyCommand) -> Result<()> {
    match command {
        IdentifyCommand::GreyBox(args) => grey_box::grey_box(args),
        IdentifyCommand::Transient(args) => transient::transient(args),
        IdentifyCommand::ThirdPole(args) => third_pole::third_pole(args),
    }
}

/// Reads the logs and the initial model.
fn read(logs: &[PathBuf], args: &IdentifyArgs) -> Result<Asked> {
    may_write(args.plot.as_deref(), args.html.as_deref(), &[("patch", args.patch_out.as_ref())])?;
    let asked = Asked::read(NAME, logs, &args.config.config, &args.config.over(), &[])?;
    has_one_lag(&asked.belief)?;
    for (log, name) in asked.logs.iter().zip(&asked.names) {
        if let Some(lost) = &log.truncated {
            warn(format_args!("{name}: {lost}"));
        }
    }
    Ok(asked)
}

/// The patch of an identification adds or changes tables and removes none.
pub(crate) fn has_one_lag(model: &Model) -> Result<()> {
    let excluded = |entry: &Entry| Effects::exclude_each_other(entry.name, FanLag::ENTRY.name);
    match model.effects.present().iter().find(|entry| excluded(entry)) {
        Some(entry) => bail!(
            "the config has [plant.effects.{}], and a lag of the fan excludes it; identify with a config without that table",
            entry.name
        ),
        None => Ok(()),
    }
}

/// The findings of the check of the logs, each with its log.
fn said(asked: &Asked, findings: &[FlightFinding]) -> Vec<String> {
    let finding = |noted: &FlightFinding| asked.words.finding(&noted.finding, &asked.columns);
    findings.iter().map(|noted| format!("{}: {}", asked.names[noted.flight], finding(noted))).collect()
}

/// Writes the requested patch.
fn write_patch(args: &IdentifyArgs, patch: &str) -> Result<()> {
    args.patch_out.as_ref().map_or(Ok(()), |path| write("patch", path, patch))
}

/// The name of the initial config.
fn config(args: &IdentifyArgs) -> String {
    args.config.config.display().to_string()
}

/// Prints the document where JSON is requested, and otherwise the words; then the files.
fn conclude(args: &IdentifyArgs, document: &impl Serialize, words: Vec<String>) -> Result<()> {
    if args.json {
        say(serde_json::to_string(document)?)?;
    } else {
        words.into_iter().try_for_each(say)?;
    }
    let (patch, picture, page) = (args.patch_out.as_deref(), args.plot.as_deref(), args.html.as_deref());
    announce(args.json, &[("patch", patch), ("picture", picture), ("page", page)])
}
