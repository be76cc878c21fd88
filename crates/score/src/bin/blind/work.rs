//! The processing of a folder of cases: in parallel, each result written when it is ready, with a progress bar.

use crate::airball::Airball;
use crate::case::Case;
use crate::cli::BlindArgs;
use crate::folder::Folder;
use crate::output::{note, with_causes};
use crate::sealed::Sealed;
use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use score::{Answer, TrueShares, shown, true_shares};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Subfolder of the diagnoses whose search left out the true effect.
pub(crate) const LEFT_OUT: &str = "left-out";

/// The source of the answers.
enum Source<'a> {
    /// A folder of an earlier run.
    Verdicts(&'a Path),
    /// The program that is scored.
    Program(Airball),
}

/// The work to do.
pub(crate) struct Work<'a> {
    folder: &'a Folder,
    sealed: Option<&'a Sealed>,
    /// The source of the answers.
    source: Source<'a>,
    /// The folder for the answers, if any.
    out: Option<&'a Path>,
    without: &'a [String],
    /// Cases to be diagnosed again, with the effect that is left out.
    again: BTreeMap<String, String>,
    /// Threads.
    jobs: usize,
}

/// A processed case.
pub(crate) struct Done {
    /// Its name.
    pub(crate) case: String,
    /// The answer, or the reason why there is none.
    pub(crate) answer: Result<Answer>,
    /// The answer of a search without the true effect, if requested.
    pub(crate) left_out: Option<Answer>,
    /// The shares of the gap that the true effects close.
    pub(crate) true_shares: Option<TrueShares>,
    /// Log-likelihood of the true model minus that of its best rival, nats.
    pub(crate) shown: Option<f64>,
    /// Believed length of the pipe, mm.
    pub(crate) pipe_length_mm: f64,
}

impl<'a> Work<'a> {
    /// Makes the folders and chooses the cases.
    pub(crate) fn new(args: &'a BlindArgs, folder: &'a Folder, sealed: Option<&'a Sealed>) -> Result<Self> {
        let again = again(args, folder, sealed);
        if let Some(out) = &args.out {
            let made = if again.is_empty() { out.clone() } else { out.join(LEFT_OUT) };
            let context = || format!("cannot make the folder {}; check the permissions", made.display());
            std::fs::create_dir_all(&made).with_context(context)?;
        }
        let jobs = args.jobs.map_or_else(rayon::current_num_threads, NonZeroUsize::get);
        // Cases that are processed at the same time share the threads.
        let each = jobs / folder.records.len().clamp(1, jobs);
        let source = match &args.verdicts {
            Some(verdicts) => Source::Verdicts(verdicts),
            None => Source::Program(Airball::find(args.airball.as_deref(), each)?),
        };
        Ok(Self { folder, sealed, source, out: args.out.as_deref(), without: &args.without, again, jobs })
    }

    /// Processes all cases. An unreadable one is reported, and the others are processed.
    pub(crate) fn all(&self) -> Result<Vec<Done>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.jobs).build()?;
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
        let done = pool.install(|| cases.par_iter().with_max_len(1).map(work).collect());
        bar.finish_and_clear();
        Ok(done)
    }

    fn one(&self, case: &str, record: &Path) -> Done {
        self.answered(case, record).unwrap_or_else(|error| Done {
            case: case.to_owned(),
            answer: Err(error),
            left_out: None,
            true_shares: None,
            shown: None,
            pipe_length_mm: f64::INFINITY,
        })
    }

    fn answered(&self, case: &str, record: &Path) -> Result<Done> {
        let answer = self.answer(case, record)?;
        // A failure without the effect leaves the answer with it.
        let left_out = self.left_out(case, record).unwrap_or_else(|error| {
            eprintln!("warning: {case} is not scored with its effect left out: {error:#}");
            None
        });
        let Case { belief, recording } = Case::read(record, &self.folder.belief(case))?;
        let truth = self.sealed.and_then(|sealed| sealed.truth(case));
        Ok(Done {
            case: case.to_owned(),
            answer: Ok(answer),
            left_out,
            true_shares: truth.and_then(|truth| true_shares(&belief, truth, &recording)),
            shown: truth.and_then(|truth| shown(&belief, truth, &recording)),
            pipe_length_mm: belief.pipe_length_mm,
        })
    }

    fn answer(&self, case: &str, record: &Path) -> Result<Answer> {
        match &self.source {
            Source::Verdicts(verdicts) => read(&file(verdicts, case)),
            Source::Program(airball) => {
                let document = airball.diagnose(record, &self.folder.belief(case), self.without)?;
                noted(&document, self.out.map(|out| file(out, case)))
            }
        }
    }

    fn left_out(&self, case: &str, record: &Path) -> Result<Option<Answer>> {
        let place = |folder: &Path| file(&folder.join(LEFT_OUT), case);
        match (&self.source, self.again.get(case)) {
            (Source::Verdicts(verdicts), _) => {
                let verdict = place(verdicts);
                verdict.exists().then(|| read(&verdict)).transpose()
            }
            (Source::Program(airball), Some(effect)) => {
                let without = [self.without, std::slice::from_ref(effect)].concat();
                let document = airball.diagnose(record, &self.folder.belief(case), &without)?;
                noted(&document, self.out.map(place)).map(Some)
            }
            (Source::Program(_), None) => Ok(None),
        }
    }
}

/// Cases to be diagnosed again, each with the effect that is left out.
pub(crate) fn again(args: &BlindArgs, folder: &Folder, sealed: Option<&Sealed>) -> BTreeMap<String, String> {
    let known = |case: &str| folder.records.contains_key(case);
    sealed.map_or_else(BTreeMap::new, |sealed| sealed.to_leave_out(args.leave_out, known))
}

/// The file of a case's answer.
pub(crate) fn file(folder: &Path, case: &str) -> PathBuf {
    folder.join(format!("{case}.json"))
}

/// Reads an answer, and writes it where requested.
fn noted(document: &[u8], out: Option<PathBuf>) -> Result<Answer> {
    if let Some(file) = out {
        let context = || format!("cannot write {}; check the folder of --out", file.display());
        std::fs::write(&file, document).with_context(context)?;
    }
    parse(document).context("the diagnosis does not have the form that it is read in; report this")
}

fn read(verdict: &Path) -> Result<Answer> {
    let context = || format!("cannot read {}; check the folder of --verdicts", verdict.display());
    let text = std::fs::read(verdict).with_context(context)?;
    parse(&text).with_context(|| format!("{} is no diagnosis; make it again with --out", verdict.display()))
}

fn parse(document: &[u8]) -> Result<Answer> {
    Ok(serde_json::from_slice(document)?)
}
