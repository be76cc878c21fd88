//! What `run` and `simulate` share: orders from the config, the log's header and name, and the end of a flight.

use super::{fail, note, say, with_causes};
use crate::cli::FlightArgs;
use crate::flight::Outcome;
use crate::flight::experiment::Experiment;
use crate::flight::experiment::offers::offers;
use crate::flight::pilot::{NoOrders, Orders, Pilot};
use crate::flight::vocabulary::Cycle;
use crate::flight::wall_clock::rfc3339;
use crate::log::header::Header;
use crate::log::writer::LogSummary;
use crate::log::{LogError, flight};
use crate::mqtt::Counts;
use crate::report::flight::plot::flight as draw;
use crate::report::flight::summary::Summary;
use crate::report::kit::plot;
use crate::started;
use anyhow::{Result, anyhow, bail};
use config::{Config, ConfigError, Loop, Safety};
use control::controller::Kind;
use serde::Serialize;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

/// Largest number of cycles that are read again for the summary and the picture: an hour at 50 Hz, because a rig has
/// little memory.
const RETOLD: usize = 180_000;

/// A flight as its flags and config define it.
pub(crate) struct Plan {
    pub(super) config: Config,
    pub(super) table: Loop,
    pub(super) pilot: Pilot,
    pub(super) experiment: Experiment,
    /// Whether it is the config's programme and no experiment.
    pub(super) is_programme: bool,
}

/// Reads the tables that every flight needs.
pub(super) fn plan(command: &'static str, args: &FlightArgs, own: Option<Own>) -> Result<Plan> {
    if let Some(picture) = &args.plot {
        plot::may_write(picture)?;
    }
    let config = Config::read(&args.config.config, &args.config.over())?;
    plan_of(command, config, |safety| match (&args.experiment, own) {
        (Some(path), _) => Experiment::read(path, safety).map(Some),
        (None, Some(own)) => Experiment::own(own.name, own.text, safety).map(Some),
        (None, None) => Ok(None),
    })
}

/// The same of a config that is read, and of an experiment; without one, of the config's reference.
pub(crate) fn plan_of(
    command: &'static str,
    config: Config,
    experiment: impl FnOnce(&Safety) -> Result<Option<Experiment>, ConfigError>,
) -> Result<Plan> {
    let table = *config.need(command, "loop", |tables| tables.r#loop.as_ref())?;
    let safety = *config.need(command, "safety", |tables| tables.safety.as_ref())?;
    let experiment = experiment(&safety)?;
    let is_programme = experiment.is_none();
    let experiment = match experiment {
        Some(experiment) => experiment,
        None => Experiment::of_reference(config.need(command, "reference", |tables| tables.reference.as_ref())?),
    };
    let orders = Orders::of(&config.tables, experiment.clone()).map_err(|error| match error {
        NoOrders::Missing(table) => anyhow::Error::from(config.missing(command, table)),
        NoOrders::Unready(error) => error.into(),
    })?;
    may_change_gains(&experiment, &orders)?;
    let files = config.tables.mqtt.as_ref().map_or(&[][..], |mqtt| &mqtt.experiments);
    let pilot = Pilot::new(orders).offering(offers(files, &safety)?);
    Ok(Plan { table, pilot, experiment, config, is_programme })
}

/// Refuses an experiment that changes gains where they are not those of the PID, or of another unit.
fn may_change_gains(experiment: &Experiment, orders: &Orders) -> Result<()> {
    if !experiment.changes_gains() {
        return Ok(());
    }
    if orders.regulator.kind() != Kind::Pid {
        let flies = orders.regulator.kind().name();
        bail!("the experiment changes the gains of the PID, and {flies} flies; set [controller] active = \"pid\"");
    }
    if orders.compensation.predistortion.is_some() {
        bail!(
            "the experiment's gains are in percent per mm, and behind [compensation] predistortion they would be in mm/s² per mm; fly it without"
        );
    }
    Ok(())
}

/// The experiment of a command that has its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Own {
    /// Its file in the project.
    pub(super) name: &'static str,
    /// The file's text.
    pub(super) text: &'static str,
}

/// A flight that is over.
pub(super) struct Flown {
    pub(super) outcome: Outcome,
    pub(super) log: Result<LogSummary, LogError>,
    /// Its log, the oldest file first; more than one with `[log] part_s`.
    pub(super) files: Vec<PathBuf>,
    /// Counts of the commands, where there was a link.
    pub(super) counts: Option<Counts>,
}

/// The document of `--json`.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    #[serde(flatten)]
    counts: Option<Counts>,
}

impl Flown {
    /// The errors of the flight, worst first: a fan that is still on, then a fault.
    pub(super) fn landed(&self) -> Result<()> {
        match (still_on(&self.outcome), self.outcome.fault) {
            (Some(worse), _) => Err(anyhow!(worse)),
            (None, Some(fault)) => Err(anyhow!("the flight was ended, with the fan off: {fault}")),
            (None, None) => Ok(()),
        }
    }
}

/// That the fan could not be turned off, if so.
pub(super) fn still_on(outcome: &Outcome) -> Option<String> {
    let kind = outcome.fan_still_on?;
    Some(format!("the fan could not be turned off (I2C error {kind:?}); switch off its supply now"))
}

/// The log's path and header.
pub(super) fn log_of(plan: &Plan, args: &FlightArgs, seed: Option<u64>, started: SystemTime) -> (PathBuf, Header) {
    let named = || {
        let directory = plan.config.tables.log.as_ref().map_or("flights", |log| log.directory.as_str());
        // A colon is not allowed in file names on every system.
        let name = rfc3339(SystemTime::now()).replace(':', "-");
        PathBuf::from(directory).join(format!("{name}.mcap"))
    };
    (args.log.clone().unwrap_or_else(named), header(plan, seed, started))
}

/// The log's header.
pub(crate) fn header(plan: &Plan, seed: Option<u64>, started: SystemTime) -> Header {
    Header {
        version: env!("CARGO_PKG_VERSION").into(),
        command: started::words().join(" "),
        seed,
        started,
        config_toml: plan.config.to_toml(),
    }
}

/// A flag that SIGINT, SIGTERM, SIGHUP (a lost terminal) and SIGQUIT set, so that the flight lands.
pub(super) fn landing_signal() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGQUIT] {
        signal_hook::flag::register(signal, Arc::clone(&stop))
            .map_err(|error| anyhow!("cannot watch for signal {signal}: {error}; the ball would not be landed"))?;
    }
    Ok(stop)
}

/// Prints the flight's summary, from its log, and draws it. The worst problem is the error: a fan that is still on, a
/// fault, the log, then the picture; the others are printed as well.
pub(super) fn report(args: &FlightArgs, title: &str, flown: Flown) -> Result<()> {
    let told = tell(args, title, &flown);
    let worst = flown.landed();
    let Flown { log, .. } = flown;
    if worst.is_ok() {
        return log.map(drop).map_err(Into::into).and(told);
    }
    for lesser in [log.err().map(anyhow::Error::from), told.err()].into_iter().flatten() {
        fail(with_causes(&lesser));
    }
    worst
}

/// Summary and picture of the cycles in the log, however few.
fn tell(args: &FlightArgs, title: &str, flown: &Flown) -> Result<()> {
    let Flown { outcome, log, files, counts } = flown;
    let flew = outcome.punctuality.cycles;
    if flew == 0 {
        return say(format_args!("flight    none: it was ended before its first cycle"));
    }
    let (cycles, read) = last_cycles(files, RETOLD)?;
    if log.is_err() {
        let held = cycles.len();
        note(format_args!("the log holds {held} of {flew} cycles of the flight; the summary is of these"));
    }
    let summary = Summary::of(&cycles, Some(outcome.punctuality));
    if args.json {
        say(serde_json::to_string(&Document { summary: &summary, counts: *counts })?)?;
    } else {
        say(summary.to_string().trim_end())?;
        let dropped = log.as_ref().map_or(0, |log| log.dropped);
        let dropped = if dropped == 0 { String::new() } else { format!(" ({dropped} messages dropped)") };
        say(format_args!("log       {}{dropped}", named(files, read)))?;
    }
    if let Some(picture) = &args.plot {
        draw(picture, title, &cycles)?;
        if !args.json {
            say(format_args!("picture   {}", picture.display()))?;
        }
    }
    Ok(())
}

/// The end of the flight, from as many of its last files as hold `most` cycles, but at least one, and how many those
/// are. Missing or empty files are skipped.
fn last_cycles(files: &[PathBuf], most: usize) -> Result<(Vec<Cycle>, usize), LogError> {
    let (mut parts, mut known, mut unread) = (Vec::new(), 0, None);
    for file in files.iter().rev() {
        match flight::read(file) {
            Ok(part) if known > 0 && known + part.cycles.len() > most => break,
            Ok(part) => {
                known += part.cycles.len();
                parts.push(part.cycles);
            }
            Err(error) => {
                unread.get_or_insert(error);
            }
        }
    }
    let read = parts.len();
    match unread {
        Some(error) if read == 0 => Err(error),
        _ => Ok((parts.into_iter().rev().flatten().collect(), read)),
    }
}

/// The log's name in words: one file, or the first and the last of several.
fn named(files: &[PathBuf], read: usize) -> String {
    let [first, .., last] = files else { return files.iter().map(|file| file.display().to_string()).collect() };
    let count = files.len();
    let part = if read == count { String::new() } else { format!("; above are the last {read}") };
    format!("{} to {}, {count} files{part}", first.display(), last.display())
}

#[cfg(test)]
mod tests {
    use super::{last_cycles, named};
    use crate::flight::outside::Recorder;
    use crate::flight::vocabulary::Cycle;
    use crate::log::recorder::Sink;
    use crate::log::rotation::{Limits, Rotation};
    use crate::log::tests::{cycles, header};
    use std::path::{Path, PathBuf};

    fn fly(folder: &Path, flown: &[Cycle], part_s: f64) -> Vec<PathBuf> {
        let limits = Limits { part_s, keep_bytes: None };
        let mut log = Rotation::create(&folder.join("f.mcap"), &header(), limits).unwrap();
        flown.iter().for_each(|cycle| log.cycle(cycle));
        let files = log.files();
        log.finish().unwrap();
        files.all()
    }

    #[test]
    fn a_flight_in_several_files_is_told_as_one_also_without_those_that_are_gone() {
        let (folder, flown) = (tempfile::tempdir().unwrap(), cycles(600));
        let files = fly(folder.path(), &flown, 3.99);
        assert_eq!(last_cycles(&files, 1000).unwrap(), (flown.clone(), 3));
        std::fs::remove_file(&files[0]).unwrap();
        assert_eq!(last_cycles(&files, 1000).unwrap(), (flown[200..].to_vec(), 2));
        let said = named(&files, 2);
        assert!(said.contains("f.mcap to ") && said.ends_with("f-3.mcap, 3 files; above are the last 2"), "{said}");
        assert_eq!(named(&files[..1], 1), files[0].display().to_string());
        for file in &files[1..] {
            std::fs::remove_file(file).unwrap();
        }
        assert!(last_cycles(&files, 1000).unwrap_err().to_string().contains("f-3.mcap"));
    }

    #[test]
    fn of_a_long_flight_the_end_is_told() {
        let (folder, flown) = (tempfile::tempdir().unwrap(), cycles(600));
        let files = fly(folder.path(), &flown, 3.99);
        assert_eq!(last_cycles(&files, 450).unwrap(), (flown[200..].to_vec(), 2));
        assert_eq!(last_cycles(&files, 10).unwrap(), (flown[400..].to_vec(), 1));
    }
}
