//! `airball simulate`: the same cycle in virtual time.

use super::flying::{landing_signal, log_of, plan, report};
use crate::cli::SimulateArgs;
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
    let plan = plan("simulate", &args.flight)?;
    let model = plan.config.need("simulate", "plant", |tables| tables.plant.as_ref())?;
    let table = plan.config.need("simulate", "rig", |tables| tables.rig.as_ref())?;

    let (path, header) = log_of(&plan, &args.flight, Some(args.flight.seed), SIMULATED_START);
    let mut recorder = Inline::new(LogWriter::create(&path, &header)?);
    let mut rig = simulated_in_virtual_time(model, table, args.flight.seed)?;
    let endless = plan.experiment.duration_s().is_infinite();
    let duration_s = args.duration.unwrap_or(if endless { DEFAULT_DURATION_S } else { f64::INFINITY });
    let stop = landing_signal()?;
    let outcome = Flight::new(&mut rig, plan.pilot, &plan.table, &mut recorder, None).fly(duration_s, &stop);
    report(&args.flight, &plan.experiment.title, &outcome, recorder.finish(), &path)
}
