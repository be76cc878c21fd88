//! Identification, design, replay and the first config of a rig.

use super::diagnosed::asked;
use super::flags::command;
use super::{Belief, Log};
use crate::cli::{Command, IdentifyCommand};
use crate::commands::design::designed;
use crate::commands::diagnosing::no_setpoint;
use crate::commands::identify::grey_box::Found;
use crate::commands::identify::has_one_lag;
use crate::commands::{Usage, each, init};
use crate::export_fmu::{ExportError, export, libraries_in};
use crate::report::each::count;
use crate::report::replay::gap::{ReplayDocument, sentence, table};
use anyhow::Result;
use diagnose::Gap;
use std::path::{Path, PathBuf};

/// The result of a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Made {
    /// The document of its `--json`.
    pub document: String,
    /// What it prints.
    pub words: String,
    /// Its patch of the config; empty where it has none.
    pub patch: String,
    /// What to know about the result.
    pub notes: Vec<String>,
}

/// What a command line of another command would mean.
fn other(name: &str) -> anyhow::Error {
    Usage(format!("these are no flags of {name}")).into()
}

/// Identifies a plant from logs of one rig, as `airball identify grey-box` does with these flags.
///
/// # Errors
/// Flags that do not exist, logs that have too little information.
pub fn identify(belief: &Belief, logs: &[Log], flags: &[String]) -> Result<Made> {
    let names = logs.iter().map(|log| log.name().to_owned());
    let words: Vec<String> = flags.iter().cloned().chain(["--".to_owned()]).chain(names).collect();
    let Command::Identify(IdentifyCommand::GreyBox(args)) = command(&["identify", "grey-box"], &words)? else {
        return Err(other("identify grey-box"));
    };
    let mut asked = asked("identify", belief, logs, &[])?;
    has_one_lag(&asked.belief)?;
    let found = Found::of(&args, &mut asked)?;
    Ok(Made {
        document: serde_json::to_string(&found.document())?,
        words: found.words(&asked).join("\n"),
        patch: found.patch.clone(),
        notes: found.findings.clone(),
    })
}

/// Designs a controller or an observer, as `airball design` does with this method and these flags.
///
/// # Errors
/// Flags that do not exist, a design that does not exist.
pub fn design(belief: &Belief, method: &str, flags: &[String]) -> Result<Made> {
    let Command::Design(asked) = command(&["design", method], flags)? else { return Err(other("design")) };
    let made = designed(&asked, belief.0.clone())?;
    Ok(Made { document: made.document, words: made.words.join("\n"), patch: made.patch, notes: made.notes })
}

/// Compares forecasts of the model with a log, as `airball replay` does.
///
/// # Errors
/// A config without a model, an effect that depends on a setpoint that the log lacks.
pub fn replay(belief: &Belief, log: &Log) -> Result<Made> {
    let model = belief.0.need("replay", "plant", |tables| tables.plant.as_ref())?;
    let mut held = log.held.clone();
    if !held.recording.has_setpoint() {
        belief.0.refuse_setpoint(&no_setpoint(log.name()), |_| false)?;
    }
    let (findings, is_mistaken) = held.check(model);
    let gap = Gap::measure(model, &held.recording);
    let (rig, columns) = (&belief.0.words, belief.0.tables.source_columns());
    let words = [table(&gap, rig), rig.of(&sentence(&gap, &held.recording, is_mistaken))];
    Ok(Made {
        document: serde_json::to_string(&ReplayDocument::of(&gap, None))?,
        words: words.join("\n"),
        patch: String::new(),
        notes: findings.iter().map(|finding| rig.finding(finding, &columns)).collect(),
    })
}

/// Proposes a config for the log of a rig that has none, as `airball init --yes` does with these flags, and writes it.
/// Returns what was found, and what to look at before it is believed.
///
/// # Errors
/// A config that exists, a log that cannot be read, a column that is not found, a record of no plant of ours.
pub fn propose(logs: &[String], out: &Path, flags: &[String]) -> Result<(Vec<String>, Vec<String>)> {
    let words: Vec<String> = flags.iter().cloned().chain(["--".to_owned()]).chain(logs.iter().cloned()).collect();
    let Command::Init(args) = command(&["init"], &words)? else { return Err(other("init")) };
    let proposed = init::propose(&args.logs, out, args.force, &args.columns, false)?;
    Ok((proposed.lines, proposed.warnings))
}

/// Writes the simulated rig as an FMU, as `airball export fmu` does. `folder`: that of the compiled libraries.
///
/// # Errors
/// A config without a model, a library that is none, a file that exists or cannot be written.
pub fn export_fmu(belief: &Belief, folder: &Path, out: &Path) -> Result<(), ExportError> {
    export(&belief.0, &libraries_in(folder), out).map(drop)
}

/// The logs that are named or lie in named folders, each with the name that tells it from the others, as
/// `airball diagnose --each` finds them.
///
/// # Errors
/// No log, two logs of one name, a folder that cannot be read.
pub fn tell_apart(paths: &[PathBuf]) -> Result<Vec<(String, PathBuf)>> {
    Ok(each::logs(paths)?.into_iter().map(|log| (log.name, log.path)).collect())
}

/// Whether a file of this name in a folder is a log, by its end.
#[must_use]
pub fn is_log(name: &str) -> bool {
    each::is_log(name)
}

/// Writes `summary.csv` and `index.html` of the reports in `out` on logs of these names, as `airball diagnose --each`
/// does. Returns how many logs are diagnosed, cannot answer, and have an error.
///
/// # Errors
/// Files that cannot be written.
pub fn summarise(names: &[String], out: &Path) -> Result<[usize; 3]> {
    Ok(count(&each::tables(names, out)?))
}
