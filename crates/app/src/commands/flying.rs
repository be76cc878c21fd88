//! What `run` and `simulate` share: orders from the config, the log's header and name, and the end of a flight.

use super::say;
use crate::cli::FlightArgs;
use crate::config::{Config, Loop};
use crate::experiment::Experiment;
use crate::flight::Outcome;
use crate::log::header::{Header, rfc3339};
use crate::log::recorder::LogSummary;
use crate::log::{self, LogError};
use crate::pilot::{Orders, Pilot};
use crate::report::{plot, summary::Summary};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use std::time::SystemTime;

/// A flight as its flags and config want it.
pub(super) struct Plan {
    pub(super) config: Config,
    pub(super) table: Loop,
    pub(super) pilot: Pilot,
    pub(super) experiment: Experiment,
}

/// Reads the tables that every flight needs.
pub(super) fn plan(command: &'static str, args: &FlightArgs) -> Result<Plan> {
    let config = Config::read(&args.config.config, &args.config.patch)?;
    let table = *config.need(command, "loop", |tables| tables.r#loop.as_ref())?;
    let safety = *config.need(command, "safety", |tables| tables.safety.as_ref())?;
    let experiment = match &args.experiment {
        Some(path) => Experiment::read(path, &safety)?,
        None => Experiment::of_reference(config.need(command, "reference", |tables| tables.reference.as_ref())?),
    };
    let orders = Orders {
        pid: config.need(command, "controller", |tables| tables.controller.as_ref())?.pid,
        compensation: *config.need(command, "compensation", |tables| tables.compensation.as_ref())?,
        safety,
        experiment: experiment.clone(),
        period_s: table.period_s,
    };
    Ok(Plan { table, pilot: Pilot::new(orders), experiment, config })
}

/// The log's path and header.
pub(super) fn log_of(plan: &Plan, args: &FlightArgs, seed: Option<u64>, started: SystemTime) -> (PathBuf, Header) {
    let named = || {
        let directory = plan.config.tables.log.as_ref().map_or("flights", |log| log.directory.as_str());
        // A colon is no part of a file name on every system.
        let name = rfc3339(SystemTime::now()).replace(':', "-");
        PathBuf::from(directory).join(format!("{name}.mcap"))
    };
    let header = Header {
        version: env!("CARGO_PKG_VERSION").into(),
        command: std::env::args().collect::<Vec<_>>().join(" "),
        seed,
        started,
        config_toml: plan.config.to_toml(),
    };
    (args.log.clone().unwrap_or_else(named), header)
}

/// Says what the flight was like, from its log, draws it, and turns a bad end into an error.
pub(super) fn report(
    args: &FlightArgs,
    title: &str,
    outcome: &Outcome,
    log: Result<LogSummary, LogError>,
) -> Result<()> {
    let log = log.map_err(anyhow::Error::from).and_then(|log| {
        let cycles = log::flight::read(&log.path)?.cycles;
        let summary = Summary::of(&cycles, Some(outcome.punctuality));
        if args.json {
            say(serde_json::to_string(&summary)?)?;
        } else {
            say(summary.to_string().trim_end())?;
            let dropped = if log.dropped == 0 { String::new() } else { format!(" ({} messages dropped)", log.dropped) };
            say(format_args!("log       {}{dropped}", log.path.display()))?;
        }
        if let Some(path) = &args.plot {
            plot::flight(path, title, &cycles)?;
            if !args.json {
                say(format_args!("picture   {}", path.display()))?;
            }
        }
        Ok(())
    });
    // The rig's state matters more than the log's.
    if let Some(kind) = outcome.fan_still_on {
        bail!("the fan could not be turned off (I2C error {kind:?}); switch off its supply now");
    }
    if let Some(fault) = outcome.fault {
        log?;
        bail!("the flight was ended, with the fan off: {fault}");
    }
    log.context("the flight ended well, but its log did not")
}
