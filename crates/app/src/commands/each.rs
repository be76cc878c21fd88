//! `airball diagnose --each`: many logs, each by itself, and one table of them all.
//!
//! ```text
//! out/NAME.json   the diagnosis         out/NAME.html   its page        out/NAME.error   why there is none
//! out/summary.csv, out/index.html       a row for each log that has one of these
//! ```
//!
//! A log with a JSON is done, so that a run that was stopped goes on, and any mixture of shares and restarts leaves the
//! same files: nothing of clock, host or path is in them.

use super::diagnose::with_report;
use super::diagnosing::Asked;
use super::init::propose;
use super::{Usage, note, say, write};
use crate::cli::DiagnoseArgs;
use crate::report::diagnosis::page::page as html;
use crate::report::each::{Row, count, csv, page as summary};
use crate::report::kit::page::{self, made::Made};
use ::diagnose::{Progress, Series};
use anyhow::{Context, Result, anyhow};
use rayon::prelude::*;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Ends of the names of files that are logs, where a folder is named.
const LOGS: [&str; 8] = [".mcap", ".csv", ".csv.gz", ".csv.zst", ".tsv", ".txt", ".dat", ".parquet"];
/// The same of logs of other programs, whose rows say how to convert them.
const FOREIGN: [&str; 10] = [".ulg", ".bag", ".db3", ".mat", ".xlsx", ".h5", ".hdf5", ".npz", ".feather", ".csv.bz2"];

/// A log, and its name in the reports.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
}

impl Named {
    /// One of its files of the reports.
    fn file(&self, out: &Path, end: &str) -> PathBuf {
        file(out, &self.name, end)
    }
}

/// One of the files of the reports of a log.
fn file(out: &Path, name: &str, end: &str) -> PathBuf {
    out.join(format!("{name}.{end}"))
}

/// Diagnoses each log by itself; `config`: `None` where one is proposed for each.
///
/// # Errors
/// Two logs of one name, a folder that cannot be read, reports that cannot be written. A log that cannot be diagnosed
/// is a row of the table.
pub(super) fn each(args: &DiagnoseArgs, config: Option<&Path>) -> Result<()> {
    let out = args.each.out.as_deref().ok_or_else(|| Usage("--each needs --out DIR".into()))?;
    let logs = logs(&args.logs)?;
    fs::create_dir_all(out)
        .with_context(|| format!("cannot make the folder {}; check the permissions", out.display()))?;
    let is_mine = |number: usize| args.each.shard.is_none_or(|shard| number % shard.count == shard.index);
    let mine = logs.iter().enumerate().filter(|(number, _)| is_mine(*number)).map(|(_, log)| log);
    let todo: Vec<&Named> = mine.filter(|log| !log.file(out, "json").exists()).collect();
    let done = AtomicUsize::new(0);
    let finished = todo.par_iter().map(|log| {
        let said = one(args, config, log, out)?;
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        // An error begins with the name of its log.
        let said = said.strip_prefix(&format!("{}: ", log.name)).unwrap_or(&said);
        note(format_args!("{count} of {}: {}: {said}", todo.len(), log.name));
        Ok(())
    });
    finished.collect::<Result<Vec<()>>>()?;
    tell(&logs, out)
}

/// The logs that are named or lie in a named folder, by name.
pub(crate) fn logs(named: &[PathBuf]) -> Result<Vec<Named>> {
    let mut logs = Vec::new();
    for path in named {
        if path.is_dir() {
            gather(path, path, &mut logs)?;
        } else {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
            logs.push(Named { name: name.unwrap_or_default(), path: path.clone() });
        }
    }
    logs.sort();
    logs.dedup();
    if let Some(pair) = logs.windows(2).find(|pair| pair[0].name == pair[1].name) {
        let [a, b] = [&pair[0].path, &pair[1].path].map(|path| path.display());
        return Err(Usage(format!("{a} and {b} have one name; name the folder that holds both")).into());
    }
    match logs.is_empty() {
        true => Err(Usage(format!("no log is in there; logs end in {}", LOGS.join(", "))).into()),
        false => Ok(logs),
    }
}

/// The logs in a folder and its folders.
fn gather(root: &Path, folder: &Path, logs: &mut Vec<Named>) -> Result<()> {
    let unreadable = || format!("cannot read the folder {}; check the permissions", folder.display());
    for entry in fs::read_dir(folder).with_context(unreadable)? {
        let path = entry.with_context(unreadable)?.path();
        let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().into_owned();
        if path.is_dir() {
            gather(root, &path, logs)?;
        } else if is_log(&name) {
            logs.push(Named { name, path });
        }
    }
    Ok(())
}

/// Whether a file of this name in a folder is a log, ours or one of a format that is refused by its name.
pub(crate) fn is_log(name: &str) -> bool {
    let name = name.to_lowercase();
    LOGS.iter().chain(&FOREIGN).any(|end| name.ends_with(end))
}

/// Diagnoses one log and writes its reports; the verdict or the reason why there is none.
fn one(args: &DiagnoseArgs, config: Option<&Path>, log: &Named, out: &Path) -> Result<String> {
    if let Some(folder) = log.file(out, "json").parent() {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    }
    // A fault of the program in one log must not take the others with it.
    let reports = catch_unwind(AssertUnwindSafe(|| reports(args, config, log, out)))
        .unwrap_or_else(|_| Err(anyhow!("the program failed on this log; please report it with the log")));
    match reports {
        Ok(Reports { verdict, json, html }) => {
            page::write(&log.file(out, "html"), &html)?;
            // Last: a log with this file is done.
            write("diagnosis", &log.file(out, "json"), &json)?;
            let _ = fs::remove_file(log.file(out, "error"));
            Ok(verdict)
        }
        Err(error) => {
            let said = super::with_causes(&error).replace(&log.path.display().to_string(), &log.name);
            write("error", &log.file(out, "error"), &format!("{said}\n"))?;
            Ok(said)
        }
    }
}

/// What is written about a log.
struct Reports {
    verdict: String,
    json: String,
    html: String,
}

fn reports(args: &DiagnoseArgs, config: Option<&Path>, log: &Named, out: &Path) -> Result<Reports> {
    let paths = [log.path.clone()];
    let proposed = log.file(out, "toml");
    let config = match config {
        Some(config) => config.to_owned(),
        None => {
            propose(&paths, &proposed, true, &args.columns, false)?;
            proposed
        }
    };
    let mut asked = Asked::read("diagnose", &paths, &config, &args.config.over(), &args.without)?;
    asked.names = vec![log.name.clone()];
    asked.files[0] = config.strip_prefix(out).unwrap_or(&config).to_owned();
    let options = args.options(Progress::default());
    let answer = asked.diagnose(&options, &|_| {});
    let picture = Series::of(&answer.found, &asked.belief, &asked.recordings);
    Ok(Reports {
        verdict: answer.found.verdict_in_words(),
        json: asked.document(&answer)?,
        html: with_report(&asked, &answer, &picture, &asked.made_by(made()), html),
    })
}

/// How the pages are made: by no more than this, since any shares and restarts make the same pages.
fn made() -> Made {
    Made::by(["diagnose", "--each"].map(String::from).into_iter())
}

/// Writes the table of all logs of these names that have reports, whoever made them. Returns its rows.
pub(crate) fn tables(names: &[String], out: &Path) -> Result<Vec<Row>> {
    let mut before = None;
    loop {
        let rows: Vec<Row> = names.iter().filter_map(|name| row(name, out)).collect();
        if before.as_ref() == Some(&rows) {
            break;
        }
        write("table", &out.join("summary.csv"), &csv(&rows)?)?;
        page::write(&out.join("index.html"), &summary(&rows, names.len(), &made()))?;
        // Another process may have finished a log meanwhile, and have written its table before this one.
        before = Some(rows);
    }
    Ok(before.unwrap_or_default())
}

/// Writes the table and says where it is.
fn tell(logs: &[Named], out: &Path) -> Result<()> {
    let names: Vec<String> = logs.iter().map(|log| log.name.clone()).collect();
    let rows = tables(&names, out)?;
    let [diagnosed, mute, bad] = count(&rows);
    say(format!(
        "{diagnosed} of {} logs are diagnosed, {mute} cannot answer, {bad} cannot be read or diagnosed",
        logs.len()
    ))?;
    say(format!("table {} and page {}", out.join("summary.csv").display(), out.join("index.html").display()))
}

/// The row of a log; `None` where nothing is known of it yet.
fn row(name: &str, out: &Path) -> Option<Row> {
    if let Ok(json) = fs::read_to_string(file(out, name, "json")) {
        return Some(Row::of(name, &json));
    }
    let error = fs::read_to_string(file(out, name, "error")).ok()?;
    Some(Row::without(name, error.trim_end()))
}
