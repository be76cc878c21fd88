//! `airball replay`: the gap between a log and a model.

use super::diagnosing::no_setpoint;
use super::{announce, may_write, note, say, typed, warn};
use crate::cli::ReplayArgs;
use crate::log::reader::{self, LoadedLog};
use crate::report::first_belief;
use crate::report::kit::page;
use crate::report::replay::gap;
use crate::report::replay::page::{Against, Report, page as html};
use crate::report::replay::plot;
use anyhow::Result;
use config::{Config, words::Words};
use diagnose::{Finding, FreeRun, Gap, free_runs};
use plant::Model;
use std::path::{Path, PathBuf};

/// A model on the log: its gap, and its free runs where they are drawn.
struct Replayed {
    gap: Gap,
    runs: Vec<FreeRun>,
}

/// The log, the model of the config, and a second one.
struct Subject<'a> {
    args: &'a ReplayArgs,
    log: LoadedLog,
    model: Model,
    words: Words,
    /// What the log cannot answer.
    findings: Vec<String>,
    /// Whether units, signs or columns are wrong.
    is_mistaken: bool,
    own: Replayed,
    other: Option<Replayed>,
}

/// Measures the gap and prints it.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a picture that cannot be written.
pub fn replay(args: &ReplayArgs) -> Result<()> {
    may_write(args.plot.as_deref(), args.html.as_deref(), &[])?;
    let subject = Subject::read(args)?;
    for finding in &subject.findings {
        note(format_args!("{}: {finding}", args.log.display()));
    }
    subject.tell()?;
    subject.draw()?;
    announce(args.json, &[("picture", args.plot.as_deref()), ("page", args.html.as_deref())])
}

impl<'a> Subject<'a> {
    fn read(args: &'a ReplayArgs) -> Result<Self> {
        let config = Config::read(&args.config.config, &args.config.over())?;
        let model = config.need("replay", "plant", |tables| tables.plant.as_ref())?.clone();
        let other = args.against.as_ref().map(|patch| second(args, patch)).transpose()?;
        let mut log = reader::read(&args.log, config.tables.import.as_ref())?;
        if let Some(lost) = &log.truncated {
            warn(format_args!("{}: {lost}", args.log.display()));
        }
        if !log.recording.has_setpoint() {
            config.refuse_setpoint(&no_setpoint(&args.log.display().to_string()), |_| false)?;
        }
        let columns = config.tables.source_columns();
        let said = |finding: &Finding| config.words.finding(finding, &columns);
        let (findings, is_mistaken) = log.check(&model);
        let fitted = first_belief::meaning(config.first_line(), &model);
        let floor = fitted.map(|_| config.words.of(first_belief::FLOOR));
        let findings = findings.iter().map(said).chain(floor).collect();
        let draws = args.plot.is_some() || args.html.is_some();
        let on_log = |model: &Model| Replayed {
            gap: Gap::measure(model, &log.recording),
            runs: if draws { free_runs(model, &log.recording) } else { Vec::new() },
        };
        let (own, other) = (on_log(&model), other.as_ref().map(on_log));
        Ok(Self { args, log, model, words: config.words, findings, is_mistaken, own, other })
    }

    fn tell(&self) -> Result<()> {
        let (gap, other) = (&self.own.gap, self.other.as_ref().map(|other| &other.gap));
        if self.args.json {
            return say(serde_json::to_string(&gap::ReplayDocument::of(gap, other))?);
        }
        let recording = &self.log.recording;
        let readings = recording.samples().iter().filter(|sample| sample.position_mm.is_some()).count();
        let (file, duration_s, config) =
            (self.args.log.display(), recording.duration_s(), self.args.config.config.display());
        say(format_args!("{file}: {duration_s:.1} s, {readings} readings; model of {config}"))?;
        let said = |text: String| say(self.words.of(&text));
        say(gap::table(gap, &self.words))?;
        said(gap::sentence(gap, recording, self.is_mistaken))?;
        let Some((patch, other)) = self.args.against.as_ref().zip(other) else { return Ok(()) };
        say(format_args!("model of {config} with {}", patch.display()))?;
        say(gap::table(other, &self.words))?;
        said(gap::nearer(gap, other, &patch.display().to_string()))
    }

    fn draw(&self) -> Result<()> {
        let recording = &self.log.recording;
        if let Some(path) = &self.args.html {
            let made = typed().in_words(&self.words).of_model(&self.model).with_log(None, &self.log.about);
            let patch = self.args.against.as_ref().map(|patch| patch.display().to_string());
            let against = patch.as_deref().zip(self.other.as_ref());
            let report = Report {
                made: &made,
                log: &self.args.log.display().to_string(),
                config: &self.args.config.config.display().to_string(),
                recording,
                findings: &self.findings,
                is_mistaken: self.is_mistaken,
                gap: &self.own.gap,
                runs: &self.own.runs,
                against: against.map(|(patch, Replayed { gap, runs })| Against { patch, gap, runs }),
            };
            page::write(path, &html(&report))?;
        }
        if let Some(path) = &self.args.plot {
            let title = format!("{} and the model's free runs", self.args.log.display());
            let other = self.other.as_ref().map(|other| other.runs.as_slice());
            plot::replay(path, &title, recording, &self.own.runs, other)?;
        }
        Ok(())
    }
}

/// The model of the config with one more patch.
fn second(args: &ReplayArgs, patch: &Path) -> Result<Model> {
    let over: Vec<PathBuf> = args.config.over().into_iter().chain([patch.to_owned()]).collect();
    let config = Config::read(&args.config.config, &over)?;
    Ok(config.need("replay", "plant", |tables| tables.plant.as_ref())?.clone())
}
