//! `airball simulate`: the same cycle in virtual time.

use super::flying::{Flown, Plan, landing_signal, log_of, plan, report};
use crate::cli::{FlightArgs, SimulateArgs};
use crate::flight::outside::Recorder;
use crate::flight::{Flight, Outcome};
use crate::log::header::SIMULATED_START;
use crate::log::recorder::Inline;
use crate::log::writer::LogWriter;
use anyhow::Result;
use config::Rig;
use plant::Model;
use rig::simulated_in_virtual_time;
use std::sync::atomic::AtomicBool;

/// How long a simulated flight without an end lasts, seconds.
const DEFAULT_DURATION_S: f64 = 60.0;

/// Flies the simulated rig in virtual time.
///
/// # Errors
/// A config that is not sound, a log that cannot be written, a flight that a fault ended.
pub fn simulate(args: &SimulateArgs) -> Result<()> {
    let plan = plan("simulate", &args.flight, None)?;
    let flown = in_virtual_time("simulate", &plan, &args.flight, args.duration)?;
    report(&args.flight, &plan.experiment.title, flown)
}

/// Flies a plan in virtual time.
pub(super) fn in_virtual_time(
    command: &'static str,
    plan: &Plan,
    args: &FlightArgs,
    duration_s: Option<f64>,
) -> Result<Flown> {
    needed(command, plan)?;
    let (path, header) = log_of(plan, args, Some(args.seed), SIMULATED_START);
    let mut recorder = Inline::new(LogWriter::create(&path, &header)?);
    let outcome = fly(command, plan, args.seed, duration_s, &mut recorder, &*landing_signal()?)?;
    Ok(Flown { outcome, log: recorder.finish(), files: vec![path], counts: None })
}

/// The tables that a simulated flight needs.
fn needed<'a>(command: &'static str, plan: &'a Plan) -> Result<(&'a Model, &'a Rig)> {
    let model = plan.config.need(command, "plant", |tables| tables.plant.as_ref())?;
    let table = plan.config.need(command, "rig", |tables| tables.rig.as_ref())?;
    Ok((model, table))
}

/// Flies a plan in virtual time into a recorder, until it is over or `stop` is set.
pub(crate) fn fly(
    command: &'static str,
    plan: &Plan,
    seed: u64,
    duration_s: Option<f64>,
    recorder: &mut dyn Recorder,
    stop: &AtomicBool,
) -> Result<Outcome> {
    let (model, table) = needed(command, plan)?;
    let mut rig = simulated_in_virtual_time(model, table, seed)?;
    let endless = plan.experiment.duration_s().is_infinite();
    let duration_s = duration_s.unwrap_or(if endless { DEFAULT_DURATION_S } else { f64::INFINITY });
    let flight = Flight::new(&mut rig, plan.pilot.clone(), &plan.table, recorder, None);
    Ok(flight.fly(duration_s, stop))
}
