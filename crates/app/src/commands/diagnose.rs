//! `airball diagnose`: the differences between the logs of a rig and a model.

use super::diagnosing::{Answer, Asked};
use super::each;
use super::init::propose;
use super::{announce, may_write, note, say, warn, write};
use crate::analysis::next_experiment::Advice;
use crate::analysis::virtual_flight::Desk;
use crate::cli::DiagnoseArgs;
use crate::locked::locked;
use crate::report::diagnosis::logs::findings;
use crate::report::diagnosis::page::{Report, page as html};
use crate::report::diagnosis::plot;
use crate::report::diagnosis::timeline::timeline;
use crate::report::diagnosis::words::words_of;
use crate::report::diagnosis::{closed_loop, missing_force, next};
use crate::report::kit::page::{self, made::Made};
use crate::report::kit::patch::rounded;
use ::diagnose::{Finding, Progress, ProgressStep, Series, Verdict};
use anyhow::Result;
use config::USUAL;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The config that is proposed where a folder has none.
const PROPOSED: &str = "rig.toml";

/// Time between two frames of the progress bar's spinner.
const TICK: Duration = Duration::from_millis(120);

/// Time between two lines where there is no bar.
const LINE: Duration = Duration::from_secs(10);

/// Exit status of a diagnosis whose record cannot answer.
const NO_ANSWER: u8 = 3;

/// Diagnoses logs and prints the result. Returns the exit status: 3 where the record cannot answer, else 0.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a patch or an experiment, a table or a picture that cannot be
/// written.
pub fn diagnose(args: &DiagnoseArgs) -> Result<u8> {
    if args.each.each {
        let named = &args.config.config;
        each::each(args, (!is_missing(named)).then_some(named.as_path()))?;
        return Ok(0);
    }
    let tables = [
        ("patch", args.patch_out.as_ref()),
        ("experiment", args.next_out.as_ref()),
        ("table of the residual force", args.missing_force.as_ref()),
    ];
    may_write(args.plot.as_deref(), args.html.as_deref(), &tables)?;
    let config = belief(args)?;
    let asked = Asked::read("diagnose", &args.logs, &config, &args.config.over(), &args.without)?;
    for (log, name) in asked.logs.iter().zip(&asked.names) {
        if let Some(lost) = &log.truncated {
            warn(format_args!("{name}: {lost}"));
        }
    }
    let bar = bar()?;
    let (shown, lines) = (bar.clone(), Lines::of(!args.json && !stderr().is_terminal()));
    let progress = Progress::new(move |step| {
        match step {
            ProgressStep::Planned(fits) => shown.inc_length(fits as u64),
            ProgressStep::Made => shown.inc(1),
        }
        if let Some(after) = lines.due() {
            let (made, all) = (shown.position(), shown.length().unwrap_or_default());
            note(format_args!("still searching after {:.0} s: {made} of {all} fits so far", after.as_secs_f64()));
        }
    });
    let options = args.options(progress);
    let answer = asked.diagnose(&options, &|step| bar.set_message(step));
    bar.finish_and_clear();
    // The answer first: a full disk takes files only. They are written also where the reader has closed the output.
    let told = tell(args, &asked, &answer);
    let next = write_files(args, &asked, &answer)?;
    told?;
    let files = [
        ("patch", args.patch_out.as_deref()),
        ("experiment", next),
        ("force", args.missing_force.as_deref()),
        ("picture", args.plot.as_deref()),
        ("page", args.html.as_deref()),
    ];
    announce(args.json, &files)?;
    let answers = answer.found.verdict != Verdict::InsufficientData;
    Ok(if answers { 0 } else { NO_ANSWER })
}

/// Writes the requested files. Returns the one of the next experiment, if one is needed.
fn write_files<'a>(args: &'a DiagnoseArgs, asked: &Asked, answer: &Answer) -> Result<Option<&'a Path>> {
    if let Some(path) = &args.patch_out {
        write("patch", path, &rounded(&answer.found.patch_toml()))?;
    }
    let next = match &args.next_out {
        Some(path) => write_next(path, &answer.advice)?,
        None => None,
    };
    draw(args, asked, answer)?;
    Ok(next)
}

/// Whether this is the usual config of a folder, and the folder has none.
fn is_missing(config: &Path) -> bool {
    config == Path::new(USUAL) && !config.exists()
}

/// The config with the belief: the named one, or where there is none, one that is proposed from the logs.
fn belief(args: &DiagnoseArgs) -> Result<PathBuf> {
    let named = &args.config.config;
    if !args.init && !is_missing(named) {
        return Ok(named.clone());
    }
    let proposed = PathBuf::from(PROPOSED);
    if !args.init && proposed.exists() {
        note(format_args!("there is no {USUAL} here; {PROPOSED} is used"));
        return Ok(proposed);
    }
    let found = propose(&args.logs, &proposed, false, &args.columns, false)?;
    let why = if args.init { "as said" } else { "there is no belief: no config.toml, and no --config" };
    note(format_args!("{why}; so {PROPOSED} is proposed and written:"));
    found.lines.into_iter().chain(found.warnings).for_each(note);
    Ok(proposed)
}

/// Prints the result.
fn tell(args: &DiagnoseArgs, asked: &Asked, answer: &Answer) -> Result<()> {
    if args.json {
        return say(asked.document(answer)?);
    }
    let (about, rig) = (asked.about(answer), &asked.words);
    // Beside a mistake of units, signs or columns, other findings are its consequences.
    let is_said = |finding: &Finding| !answer.found.has_mistake() || finding.is_mistake();
    for (name, finding) in findings(&answer.found, &about).filter(|(_, finding)| is_said(finding)) {
        note(format_args!("{name}: {}", rig.finding(finding, about.columns)));
    }
    if let Some(line) = about.words() {
        say(line)?;
    }
    if let Some(meaning) = about.belief {
        say(format_args!("{meaning}."))?;
    }
    for (name, stage) in about.upstream() {
        note(format_args!("{name}: {}: {}", stage.name, rig.of(&stage.finding)));
    }
    let desk = asked.desk();
    let compensation = desk.as_ref().map(Desk::compensation);
    say(rig.of(&words_of(&answer.found, compensation, rig, about.columns)))?;
    // Beside a record that cannot say what separates simulator and rig, nothing compares the two.
    let answers = answer.found.verdict != Verdict::InsufficientData;
    let looped = if answers { closed_loop::words(&answer.looped) } else { Vec::new() };
    let more = looped.into_iter().chain(next::words(&answer.advice));
    more.map(|line| rig.of(&line)).try_for_each(say)
}

/// A progress bar of the diagnosis' fits on standard error, if that is a terminal; it grows with every effect that is
/// found.
fn bar() -> Result<ProgressBar> {
    let bar = ProgressBar::new(0);
    bar.set_style(ProgressStyle::with_template("{spinner} {bar:30} {pos}/{len} fits  {wide_msg} {elapsed}")?);
    bar.enable_steady_tick(TICK);
    Ok(bar)
}

/// The lines that tell of the progress where no terminal shows a bar.
struct Lines {
    began: Instant,
    said: Mutex<Option<Instant>>,
}

impl Lines {
    fn of(is_wanted: bool) -> Self {
        let began = Instant::now();
        Self { began, said: Mutex::new(is_wanted.then_some(began)) }
    }

    /// The time since the beginning, where a line is due.
    fn due(&self) -> Option<Duration> {
        let mut said = locked(&self.said);
        if said.is_none_or(|last| last.elapsed() < LINE) {
            return None;
        }
        *said = Some(Instant::now());
        Some(self.began.elapsed())
    }
}

/// Draws the result and writes the missing force, where requested.
fn draw(args: &DiagnoseArgs, asked: &Asked, answer: &Answer) -> Result<()> {
    if args.plot.is_none() && args.missing_force.is_none() && args.html.is_none() {
        return Ok(());
    }
    let picture = Series::of(&answer.found, &asked.belief, &asked.recordings);
    if let Some(path) = &args.missing_force {
        write("table of the residual force", path, &missing_force::table(&picture.missing)?)?;
    }
    if let Some(path) = &args.plot {
        let title = format!("{}: free runs, and the residual force", asked.names.join(", "));
        plot::diagnosis(path, &title, &picture, &answer.found.regions(), &asked.words)?;
    }
    if let Some(path) = &args.html {
        page::write(path, &with_report(asked, answer, &picture, &asked.made(), html))?;
    }
    Ok(())
}

/// The diagnosis as `make` makes a page of it.
pub(crate) fn with_report(
    asked: &Asked,
    answer: &Answer,
    picture: &Series,
    made: &Made,
    make: impl Fn(&Report<'_>) -> String,
) -> String {
    let desk = asked.desk();
    let logs: Vec<_> = asked
        .logs
        .iter()
        .zip(&asked.names)
        .map(|(log, name)| (name.as_str(), &log.recording, &log.events[..]))
        .collect();
    let timeline = timeline(&picture.recording, &logs);
    make(&Report {
        timeline: &timeline,
        made,
        words: &asked.words,
        found: &answer.found,
        belief: &asked.belief,
        closed_loop: &answer.looped,
        advice: &answer.advice,
        logs: &asked.about(answer),
        config: &asked.config().to_string(),
        compensation: desk.as_ref().map(Desk::compensation),
        picture,
    })
}

/// Writes the next experiment, and returns its file; where none is needed, no file is written.
fn write_next<'a>(path: &'a Path, advice: &Advice) -> Result<Option<&'a Path>> {
    match &advice.experiment {
        Some(next) => write("experiment", path, &next.file).map(|()| Some(path)),
        None => {
            note(format_args!("no experiment of the list would tell more; {} was not written", path.display()));
            Ok(None)
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::cli::{Cli, Command};
    use clap::Parser;

    #[test]
    fn a_folder_that_cannot_take_a_file_is_refused_before_a_log_is_read() {
        for flag in ["--plot", "--html", "--patch-out", "--next-out", "--missing-force"] {
            let cli = Cli::try_parse_from(["airball", "diagnose", "nosuch.csv", flag, "nosuch/file"]).unwrap();
            let Command::Diagnose(args) = cli.command else { panic!("{flag}") };
            let said = super::diagnose(&args).unwrap_err().to_string();
            assert!(said.starts_with("cannot write") && said.contains("nosuch/file"), "{flag}: {said}");
        }
    }
}
