//! `airball measure`: an experiment is flown, its log is analysed, and the result is printed, drawn and written as a
//! patch.

mod patch;

use super::flying::{Own, Plan, plan};
use super::run::in_real_time;
use super::simulate::in_virtual_time;
use super::{Usage, announce, fail, may_write, say, typed, warn, write};
use crate::analysis::measurement::Found;
use crate::cli::{MeasureArgs, Measurement};
use crate::log::reader::{self, LoadedLog};
use crate::report::kit::page;
use crate::report::measure::page::{Patch, Report, page as html};
use crate::report::measure::plot;
use crate::report::measure::words::{document, words};
use anyhow::{Result, anyhow, bail};
use clap::ValueEnum;
use clap::builder::PossibleValue;
use config::Config;
use std::path::{Path, PathBuf};

/// The command's name for configs and errors.
const NAME: &str = "measure";

/// Measures and prints the result.
///
/// # Errors
/// A config that is not sound, a flight that a fault ended, a log with too little information, a file that cannot be
/// written.
pub fn measure(args: &MeasureArgs) -> Result<()> {
    check(args)?;
    may_write(args.flight.plot.as_deref(), args.html.as_deref(), &[("patch", args.patch_out.as_ref())])?;
    let (config, path) = match &args.from {
        Some(log) => (Config::read(&args.flight.config.config, &args.flight.config.over())?, log.clone()),
        None => fly(args)?,
    };
    let log = reader::read(&path, config.tables.import.as_ref())?;
    if let Some(truncated) = &log.truncated {
        warn(truncated);
    }
    let found = Found::of(args.what, &log, &config.tables, args.travel_mm)
        .map_err(|error| anyhow!("{}: {error}", path.display()))?;
    let made = patch::patch(&found, &config.tables);
    if let Some(file) = &args.html {
        page::write(file, &page(args, &config, &path, &log, &found, &made))?;
    }
    let text = match made {
        Err(error) if args.patch_out.is_none() => {
            warn(format_args!("no patch can be made of this: {error}"));
            None
        }
        text => text?,
    };
    if let (Some(file), Some(text)) = (&args.patch_out, &text) {
        let origin = format!("# Measured: {}\n", path.display());
        write("patch", file, &(origin + text))?;
    }
    if let Some(picture) = &args.flight.plot {
        plot::draw(picture, &log.recording, &found)?;
    }
    if args.flight.json {
        say(serde_json::to_string(&document(args.what, &found, &path, text.as_deref())?)?)?;
    } else {
        words(&found, &config.tables).into_iter().try_for_each(say)?;
        say(format_args!("log       {}", path.display()))?;
    }
    let (patch, picture) = (args.patch_out.as_deref().filter(|_| text.is_some()), args.flight.plot.as_deref());
    announce(args.flight.json, &[("patch", patch), ("picture", picture), ("page", args.html.as_deref())])
}

/// Refuses flags that have no meaning for the measurement.
fn check(args: &MeasureArgs) -> Result<(), Usage> {
    if args.patch_out.is_some()
        && matches!(args.what, Measurement::Steps | Measurement::Square | Measurement::CriticalTime)
    {
        let why = "this measurement is no number of a config, so that there is no patch; leave --patch-out out";
        return Err(Usage(why.into()));
    }
    match args.travel_mm {
        Some(mm) if args.what != Measurement::Calibration => {
            let why =
                "is the ball's way in a calibration, and nothing else needs it; leave it out, or measure calibration";
            Err(Usage(format!("--travel-mm {mm} {why}")))
        }
        _ => Ok(()),
    }
}

/// The measurement as a page.
fn page(
    args: &MeasureArgs,
    config: &Config,
    path: &Path,
    log: &LoadedLog,
    found: &Found,
    made: &Result<Option<String>>,
) -> String {
    let why = made.as_ref().err().map(ToString::to_string);
    let patch = match made {
        Ok(Some(text)) => Patch::Made(text),
        Ok(None) => Patch::None,
        Err(_) => Patch::Refused(why.as_deref().unwrap_or_default()),
    };
    let what = args.what.to_possible_value();
    html(&Report {
        made: &typed().in_config(config.files()).with_log(None, &log.about),
        what: what.as_ref().map_or("", PossibleValue::get_name),
        log: &path.display().to_string(),
        config: &args.flight.config.config.display().to_string(),
        tables: &config.tables,
        recording: &log.recording,
        found,
        patch,
    })
}

/// Flies the experiment, with the fan off at its end, and returns the config and the log.
fn fly(args: &MeasureArgs) -> Result<(Config, PathBuf)> {
    let mut plan: Plan = plan(NAME, &args.flight, Some(own(args.what)))?;
    // The log that is analysed must be one file.
    if let Some(log) = &mut plan.config.tables.log {
        log.part_s = None;
    }
    let (flown, watched) = if args.in_virtual_time {
        (in_virtual_time(NAME, &plan, &args.flight, None)?, Ok(()))
    } else {
        in_real_time(NAME, &plan, &args.flight, args.sim, (None, None))?
    };
    let path = flown.files.first().cloned().unwrap_or_default();
    if let Err(error) = flown.landed() {
        if let Err(lesser) = flown.log {
            fail(lesser);
        }
        bail!("{error}; what was recorded is in {}, for --from", path.display());
    }
    flown.log?;
    watched?;
    Ok((plan.config, path))
}

/// The experiment of a measurement.
const fn own(what: Measurement) -> Own {
    macro_rules! file {
        ($name:literal) => {
            Own { name: $name, text: include_str!(concat!("../../../../../", $name)) }
        };
    }
    match what {
        Measurement::DeadZone => file!("experiments/dead-zone.toml"),
        Measurement::ForceCurve => file!("experiments/force-curve.toml"),
        Measurement::CriticalGain => file!("experiments/critical-gain.toml"),
        Measurement::CriticalTime => file!("experiments/critical-time.toml"),
        Measurement::Steps => file!("experiments/steps.toml"),
        Measurement::Square => file!("experiments/square.toml"),
        Measurement::NoiseFloor => file!("experiments/noise-floor.toml"),
        Measurement::Calibration => file!("experiments/calibration.toml"),
    }
}

#[cfg(test)]
mod tests;
