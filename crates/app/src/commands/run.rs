//! `airball run`: the rig, or the simulated rig, in real time.

use super::flying::{Plan, log_of, plan, report};
use crate::cli::RunArgs;
use crate::config;
use crate::flight::{Flight, Outcome};
use crate::log::queue::Queue;
use crate::log::writer::LogWriter;
use crate::mqtt::{Link, Mailbox};
use crate::rig::{Rig, bench, simulated_in_real_time};
use anyhow::{Context, Result};
use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

/// A PWM frequency that is off by more than this share of what was asked for is worth a word.
const PWM_OFF: f64 = 0.02;

/// Flies in real time until the duration, the experiment or a signal ends it.
///
/// # Errors
/// A config that is not sound, a bus that cannot be opened, a log that cannot be written, a flight that a
/// fault ended.
pub fn run(args: &RunArgs) -> Result<()> {
    let mut plan = plan("run", &args.flight)?;
    let table = plan.config.need("run", "rig", |tables| tables.rig.as_ref())?.clone();
    if args.sim {
        let model = plan.config.need("run --sim", "plant", |tables| tables.plant.as_ref())?.clone();
        fly(args, &mut plan, &table, |table| {
            let rig = simulated_in_real_time(&model, table, args.flight.seed)?;
            let pwm_hz = rig.fan_pwm_hz();
            Ok((rig, pwm_hz))
        })
    } else {
        let bus = plan.config.need("run", "bus", |tables| tables.bus.as_ref())?.clone();
        fly(args, &mut plan, &table, |table| {
            let rig = bench(&bus, table)?;
            let pwm_hz = rig.fan_pwm_hz();
            Ok((rig, pwm_hz))
        })
    }
}

/// Starts everything around the rig, in the order in which a failure costs least, and flies.
fn fly<R: Rig>(
    args: &RunArgs,
    plan: &mut Plan,
    table: &config::Rig,
    start: impl FnOnce(&config::Rig) -> Result<(R, f64)>,
) -> Result<()> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("cannot watch for Ctrl-C")?;
    }
    let (mut rig, pwm_hz) = start(table)?;
    if (pwm_hz / table.fan_pwm_hz - 1.0).abs() > PWM_OFF {
        eprintln!("airball: [rig] fan_pwm_hz asks for {} Hz; the fan driver gives {pwm_hz:.0} Hz", table.fan_pwm_hz);
    }
    let seed = args.sim.then_some(args.flight.seed);
    let (path, header) = log_of(plan, &args.flight, seed, SystemTime::now());
    let mut queue = Queue::start(LogWriter::create(&path, &header)?)?;
    let mut link = plan.config.tables.mqtt.as_ref().map(|mqtt| Link::start(mqtt, &table.name)).transpose()?;
    eprintln!("airball: flying \"{}\", Ctrl-C lands; log {}", plan.experiment.title, path.display());

    let mailbox = link.as_mut().map(|(_, mailbox)| mailbox);
    let outcome = in_the_air(args, plan, &mut rig, &mut queue, mailbox, &stop);
    drop(rig);
    if let Some((link, _)) = link {
        link.stop();
    }
    report(&args.flight, &plan.experiment.title, &outcome, queue.finish())
}

fn in_the_air<R: Rig>(
    args: &RunArgs,
    plan: &Plan,
    rig: &mut R,
    queue: &mut Queue,
    mailbox: Option<&mut Mailbox>,
    stop: &AtomicBool,
) -> Outcome {
    let flight = Flight::new(rig, plan.pilot.clone(), &plan.table, queue, mailbox);
    flight.fly(args.duration.unwrap_or(f64::INFINITY), stop)
}
