//! `airball replay`: the gap between a log and a model.

use super::diagnosing::no_setpoint;
use super::{announce, may_write, note, say, warn};
use crate::cli::ReplayArgs;
use crate::config::Config;
use crate::log::reader;
use crate::report::kit::page;
use crate::report::replay::gap;
use crate::report::replay::page::{Report, page as html};
use crate::report::replay::plot;
use anyhow::Result;
use diagnose::{Gap, check, free_runs};

/// Measures the gap and prints it.
///
/// # Errors
/// A config that is not sound, a log that cannot be read, a picture that cannot be written.
pub fn replay(args: &ReplayArgs) -> Result<()> {
    may_write(args.plot.as_deref(), args.html.as_deref(), &[])?;
    let config = Config::read(&args.config.config, &args.config.over())?;
    let model = config.need("replay", "plant", |tables| tables.plant.as_ref())?;
    let mut log = reader::read(&args.log, config.tables.import.as_ref())?;
    if let Some(lost) = &log.truncated {
        warn(format_args!("{}: {lost}", args.log.display()));
    }
    if !log.recording.has_setpoint() {
        config.refuse_setpoint(&no_setpoint(&args.log.display().to_string()), |_| false)?;
    }
    let findings = check(&log.recording, model);
    for finding in &findings {
        note(format_args!("{}: {finding}", args.log.display()));
    }
    log.discard_implausible_readings(model);
    let gap = Gap::measure(model, &log.recording);
    if args.json {
        say(serde_json::to_string(&gap::ReplayDocument::of(&gap))?)?;
    } else {
        let readings = log.recording.samples().iter().filter(|sample| sample.position_mm.is_some()).count();
        let (file, duration_s) = (args.log.display(), log.recording.duration_s());
        say(format_args!("{file}: {duration_s:.1} s, {readings} readings; model of {}", args.config.config.display()))?;
        say(gap::table(&gap))?;
        say(gap::sentence(&gap, &log.recording))?;
    }
    let runs = if args.plot.is_some() || args.html.is_some() { free_runs(model, &log.recording) } else { Vec::new() };
    if let Some(path) = &args.html {
        let (file, config) = (args.log.display().to_string(), args.config.config.display().to_string());
        let (recording, findings, gap, runs) = (&log.recording, findings.as_slice(), &gap, runs.as_slice());
        let report = Report { log: &file, config: &config, recording, findings, gap, runs };
        page::write(path, &html(&report))?;
    }
    if let Some(path) = &args.plot {
        let title = format!("{} and the model's free runs", args.log.display());
        plot::replay(path, &title, &log.recording, &runs)?;
    }
    announce(args.json, &[("picture", args.plot.as_deref()), ("page", args.html.as_deref())])
}
