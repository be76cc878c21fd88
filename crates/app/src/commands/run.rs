//! `airball run`: the rig, or the simulated rig, in real time.

use super::flying::{Plan, landing_signal, log_of, plan, report};
use super::{note, say};
use crate::cli::RunArgs;
use crate::config;
use crate::flight::Flight;
use crate::log::queue::Queue;
use crate::log::writer::LogWriter;
use crate::mqtt::{Counts, Link};
use crate::rig::{Chips, bench, claim, simulated_in_real_time};
use anyhow::Result;
use embedded_hal::i2c::I2c;
use hal::Clock;
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
    let plan = plan("run", &args.flight)?;
    let table = plan.config.need("run", "rig", |tables| tables.rig.as_ref())?;
    let stop = landing_signal()?;
    if args.sim {
        let model = plan.config.need("run --sim", "plant", |tables| tables.plant.as_ref())?;
        fly(args, &plan, table, simulated_in_real_time(model, table, args.flight.seed)?, &stop)
    } else {
        let bus = plan.config.need("run", "bus", |tables| tables.bus.as_ref())?;
        let _claim = claim(bus)?;
        fly(args, &plan, table, bench(bus, table)?, &stop)
    }
}

/// Starts log and MQTT around a rig whose fan is off, and flies it.
fn fly<S: I2c, P: I2c, C: Clock + Clone>(
    args: &RunArgs,
    plan: &Plan,
    table: &config::Rig,
    mut rig: Chips<S, P, C>,
    stop: &AtomicBool,
) -> Result<()> {
    let (asked_hz, given_hz) = (table.fan_pwm_hz, rig.fan_pwm_hz());
    if (given_hz / asked_hz - 1.0).abs() > PWM_OFF {
        note(format_args!("[rig] fan_pwm_hz asks for {asked_hz} Hz; the fan driver can give {given_hz:.0} Hz"));
    }
    let seed = args.sim.then_some(args.flight.seed);
    let (path, header) = log_of(plan, &args.flight, seed, SystemTime::now());
    let mut link = plan.config.tables.mqtt.as_ref().map(|mqtt| Link::start(mqtt, &table.name)).transpose()?;
    let mut queue = Queue::start(LogWriter::create(&path, &header)?)?;
    note(format_args!("flying \"{}\", Ctrl-C lands; log {}", plan.experiment.title, path.display()));

    let mailbox = link.as_mut().map(|(_, mailbox)| mailbox);
    let flight = Flight::new(&mut rig, plan.pilot.clone(), &plan.table, &mut queue, mailbox);
    let outcome = flight.fly(args.duration.unwrap_or(f64::INFINITY), stop);
    let counts = link.map(|(link, _)| link.stop());
    report(&args.flight, &plan.experiment.title, &outcome, queue.finish(), &path)?;
    match counts.filter(|counts| counts.commands_received > 0 && !args.flight.json) {
        Some(Counts { commands_received, commands_refused, commands_busy, .. }) => say(format_args!(
            "commands  {commands_received}: {commands_refused} refused as unreadable, {commands_busy} while busy"
        )),
        None => Ok(()),
    }
}
