//! `blind`: runs `airball` on a folder of withheld cases, and scores the answers when the truth is known.

mod airball;
mod case;
mod cli;
mod folder;
mod output;
mod plan;
mod sealed;
mod work;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use cli::BlindArgs;
use folder::Folder;
use output::{note, reader_is_gone, say, with_causes};
use score::{BlindDocument, page, score};
use sealed::Sealed;
use serde::Serialize;
use std::collections::BTreeMap;
use std::process::ExitCode;
use work::{Done, Work};

fn main() -> ExitCode {
    match blind(&BlindArgs::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if reader_is_gone(&error) => ExitCode::SUCCESS,
        Err(error) => {
            note(with_causes(&error));
            ExitCode::FAILURE
        }
    }
}

/// Diagnoses every case, except unreadable ones, and prints the result.
///
/// # Errors
/// A folder without cases, a truth that cannot be read, no program to be scored, a folder that cannot be written, no
/// case that could be diagnosed.
fn blind(args: &BlindArgs) -> Result<()> {
    let folder = Folder::open(&args.folder)?;
    let sealed = args.truth.as_ref().map(|truth| Sealed::open(truth, args.bounds.as_deref())).transpose()?;
    if args.plan {
        return plan::of(args, &folder, sealed.as_ref()).iter().try_for_each(say_as_json);
    }
    let work = Work::new(args, &folder, sealed.as_ref())?;
    let done = work.all()?;
    let unreadable = done.iter().filter(|done| done.answer.is_err()).count();
    ensure!(unreadable < done.len(), "none of the {unreadable} cases could be diagnosed; see the reasons above");
    let document = BlindDocument {
        schema: "airball.blind/1",
        answers: count(&done),
        unreadable,
        score: sealed.map(|sealed| score(&sealed.joined(done))),
    };
    if args.json {
        return say_as_json(&document);
    }
    say(page(&document))
}

fn say_as_json(value: &impl Serialize) -> Result<()> {
    say(serde_json::to_string(value).context("the result could not be written as JSON")?)
}

/// Number of answers with each verdict.
fn count(done: &[Done]) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for answer in done.iter().filter_map(|done| done.answer.as_ref().ok()) {
        *counts.entry(answer.word()).or_default() += 1;
    }
    counts
}
