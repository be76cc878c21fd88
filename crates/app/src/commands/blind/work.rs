//! The work on a folder of cases: many at a time, one after another written down, with a bar that a person can watch.

use super::folder::Folder;
use super::sealed::Sealed;
use crate::cli::BlindArgs;
use crate::commands::diagnosing::Asked;
use crate::commands::{note, with_causes};
use anyhow::{Context, Result};
use diagnose::Options;
use diagnose::blind::{Answer, closed_of_truth, shown};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Where the diagnoses go from whose search the true effect was left out, below those of all cases.
const LEFT_OUT: &str = "left-out";

/// What is to be done.
pub(super) struct Work<'a> {
    folder: &'a Folder,
    sealed: Option<&'a Sealed>,
    /// Where answers come from, if they are not made.
    verdicts: Option<&'a Path>,
    /// Where answers go, if anywhere.
    out: Option<&'a Path>,
    without: &'a [String],
    /// Cases to be diagnosed again, with the effect that is left out.
    again: BTreeMap<String, String>,
}

/// A case that was worked on.
pub(super) struct Done {
    /// Its name.
    pub(super) case: String,
    /// The answer, or why there is none.
    pub(super) answer: Result<Answer>,
    /// The answer of a search without the true effect, if that was asked.
    pub(super) left_out: Option<Answer>,
    /// The share of the gap that the true effects close.
    pub(super) closed_of_truth: Option<f64>,
    /// Nats by which the true model beats its best rival.
    pub(super) shown: Option<f64>,
    /// Length of the pipe that the owner believes in, mm.
    pub(super) pipe_length_mm: f64,
}

impl<'a> Work<'a> {
    /// Makes the folders and chooses the cases.
    pub(super) fn new(args: &'a BlindArgs, folder: &'a Folder, sealed: Option<&'a Sealed>) -> Result<Self> {
        let known = |case: &str| folder.records.contains_key(case);
        let again = sealed.map_or_else(BTreeMap::new, |sealed| sealed.to_leave_out(args.leave_out, known));
        if let Some(out) = &args.out {
            let made = if again.is_empty() { out.clone() } else { out.join(LEFT_OUT) };
            let context = || format!("cannot make the folder {}; check the permissions", made.display());
            std::fs::create_dir_all(&made).with_context(context)?;
        }
        let (verdicts, out) = (args.verdicts.as_deref(), args.out.as_deref());
        Ok(Self { folder, sealed, verdicts, out, without: &args.without, again })
    }

    /// Works on all cases. One that cannot be read is said, and the others go on.
    pub(super) fn all(&self, jobs: Option<NonZeroUsize>) -> Result<Vec<Done>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs.map_or(0, NonZeroUsize::get)).build()?;
        let bar = ProgressBar::new(self.folder.records.len() as u64);
        bar.set_style(ProgressStyle::with_template("{pos}/{len} cases {wide_bar} {elapsed} of {duration}")?);
        let cases: Vec<(&String, &PathBuf)> = self.folder.records.iter().collect();
        let work = |&(case, record): &(&String, &PathBuf)| {
            let done = self.one(case, record);
            if let Err(error) = &done.answer {
                bar.suspend(|| note(format_args!("{case}: {}", with_causes(error))));
            }
            bar.inc(1);
            done
        };
        let done = pool.install(|| cases.par_iter().map(work).collect());
        bar.finish_and_clear();
        Ok(done)
    }

    fn one(&self, case: &str, record: &Path) -> Done {
        let nothing = |error| Done {
            case: case.to_owned(),
            answer: Err(error),
            left_out: None,
            closed_of_truth: None,
            shown: None,
            pipe_length_mm: f64::INFINITY,
        };
        match Asked::read("blind", &[record.to_path_buf()], &self.folder.belief(case), &[]) {
            Ok(asked) => self.asked(case, &asked).unwrap_or_else(nothing),
            Err(error) => nothing(error),
        }
    }

    fn asked(&self, case: &str, asked: &Asked) -> Result<Done> {
        let truth = self.sealed.and_then(|sealed| sealed.truth(case)).zip(asked.recordings.first());
        Ok(Done {
            case: case.to_owned(),
            answer: Ok(self.answer(case, asked)?),
            left_out: self.left_out(case, asked)?,
            closed_of_truth: truth.and_then(|(truth, recording)| closed_of_truth(&asked.belief, truth, recording)),
            shown: truth.and_then(|(truth, recording)| shown(&asked.belief, truth, recording)),
            pipe_length_mm: asked.belief.pipe_length_mm,
        })
    }

    fn answer(&self, case: &str, asked: &Asked) -> Result<Answer> {
        match self.verdicts {
            Some(verdicts) => read(&file(verdicts, case)),
            None => diagnosed(asked, self.without, self.out.map(|out| file(out, case))),
        }
    }

    fn left_out(&self, case: &str, asked: &Asked) -> Result<Option<Answer>> {
        let place = |folder: &Path| file(&folder.join(LEFT_OUT), case);
        match (self.verdicts.map(place), self.again.get(case)) {
            (Some(verdict), _) => verdict.exists().then(|| read(&verdict)).transpose(),
            (None, Some(effect)) => {
                let without = [self.without, std::slice::from_ref(effect)].concat();
                diagnosed(asked, &without, self.out.map(place)).map(Some)
            }
            (None, None) => Ok(None),
        }
    }
}

/// The file of a case's answer.
fn file(folder: &Path, case: &str) -> PathBuf {
    folder.join(format!("{case}.json"))
}

/// Diagnoses a case, and writes the answer down where that is wanted.
fn diagnosed(asked: &Asked, without: &[String], out: Option<PathBuf>) -> Result<Answer> {
    let found = asked.diagnose(&Options { without: without.to_vec(), ..Options::default() }, &|_| {});
    let document = asked.document(&found)?;
    if let Some(file) = out {
        let context = || format!("cannot write {}; check the folder of --out", file.display());
        std::fs::write(&file, format!("{document}\n")).with_context(context)?;
    }
    parse(&document).context("the diagnosis does not have the form that it is read in; report this")
}

fn read(verdict: &Path) -> Result<Answer> {
    let context = || format!("cannot read {}; check the folder of --verdicts", verdict.display());
    let text = std::fs::read_to_string(verdict).with_context(context)?;
    parse(&text).with_context(|| format!("{} is no diagnosis; make it again with --out", verdict.display()))
}

fn parse(document: &str) -> Result<Answer> {
    Ok(serde_json::from_str(document)?)
}
