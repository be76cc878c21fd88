//! `airball blind`: diagnoses a folder of withheld cases, and scores the answers once the truth is known.

mod folder;
mod sealed;
mod work;

use super::say;
use crate::cli::BlindArgs;
use crate::report::blind::{BlindDocument, page};
use anyhow::{Context, Result, ensure};
use diagnose::blind::score;
use folder::Folder;
use sealed::Sealed;
use std::collections::BTreeMap;
use work::{Done, Work};

/// Diagnoses every case, one that cannot be read apart, and says how it went.
///
/// # Errors
/// A folder without cases, a truth that cannot be read, a folder that cannot be written, no case that could be diagnosed.
pub fn blind(args: &BlindArgs) -> Result<()> {
    let folder = Folder::open(&args.folder)?;
    let sealed = args.truth.as_ref().map(|truth| Sealed::open(truth, args.bounds.as_deref())).transpose()?;
    let work = Work::new(args, &folder, sealed.as_ref())?;
    let done = work.all(args.jobs)?;
    let unreadable = done.iter().filter(|done| done.answer.is_err()).count();
    ensure!(unreadable < done.len(), "none of the {unreadable} cases could be diagnosed; see the reasons above");
    let document = BlindDocument {
        schema: "airball.blind/1",
        answers: count(&done),
        unreadable,
        score: sealed.map(|sealed| score(&sealed.joined(done))),
    };
    if args.json {
        return say(serde_json::to_string(&document).context("the score could not be written as JSON")?);
    }
    say(page(&document))
}

/// How often each verdict was given.
fn count(done: &[Done]) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for answer in done.iter().filter_map(|done| done.answer.as_ref().ok()) {
        *counts.entry(answer.word()).or_default() += 1;
    }
    counts
}
