//! `airball simulate`: the same cycle in virtual time.

use super::flying::{Flown, Plan, landing_signal, log_of, plan, report};
use crate::cli::{FlightArgs, SimulateArgs};
use crate::flight::Flight;
use crate::log::header::SIMULATED_START;
use crate::log::recorder::Inline;
use crate::log::writer::LogWriter;
use crate::rig::simulated_in_virtual_time;
use anyhow::Result;

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
    let model = plan.config.need(command, "plant", |tables| tables.plant.as_ref())?;
    let table = plan.config.need(command, "rig", |tables| tables.rig.as_ref())?;
    let (path, header) = log_of(plan, args, Some(args.seed), SIMULATED_START);
    let mut recorder = Inline::new(LogWriter::create(&path, &header)?);
    let mut rig = simulated_in_virtual_time(model, table, args.seed)?;
    let endless = plan.experiment.duration_s().is_infinite();
    let duration_s = duration_s.unwrap_or(if endless { DEFAULT_DURATION_S } else { f64::INFINITY });
    let stop = landing_signal()?;
    let flight = Flight::new(&mut rig, plan.pilot.clone(), &plan.table, &mut recorder, None);
    let outcome = flight.fly(duration_s, &stop);
    Ok(Flown { outcome, log: recorder.finish(), files: vec![path], counts: None })
}
