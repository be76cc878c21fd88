//! `airball run`: the rig, or the simulated rig, in real time.

use super::flying::{Flown, Plan, landing_signal, log_of, plan, report, still_on};
use super::live;
use super::owner::{FlightOwner, keep};
use super::{note, say, warn};
use crate::bench::{EnableLine, Guard, GuardError, Monotonic, bench, claim};
use crate::cli::{FlightArgs, RunArgs};
use crate::flight::last_fault::LastFault;
use crate::flight::outside::Commander;
use crate::flight::real_time;
use crate::flight::watchdog::{SLACK_S, Watch};
use crate::flight::{Flight, Outcome};
use crate::log::LogError;
use crate::log::header::Header;
use crate::log::queue::Queue;
use crate::log::rotation::{Limits, Rotation};
use crate::log::writer::LogWriter;
use crate::mqtt::link::Endpoint;
use crate::mqtt::local::LocalServer;
use crate::mqtt::{About, Counts, Link};
use anyhow::{Result, bail};
use embedded_hal::i2c::I2c;
use hal::Clock;
use rig::{Chips, simulated_in_real_time};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32};
use std::time::SystemTime;

/// A PWM frequency that deviates by more than this share from the requested one is reported.
const PWM_OFF: f64 = 0.02;

/// Flies in real time until the duration, the experiment or a signal ends it.
///
/// # Errors
/// A config that is not sound, a bus that cannot be opened, a log that cannot be written, a flight that a
/// fault ended.
pub fn run(args: &RunArgs) -> Result<()> {
    let plan = plan("run", &args.flight, None)?;
    let port = args.live.then_some(args.live_port);
    let (flown, watched) = in_real_time("run", &plan, &args.flight, args.sim, (args.duration, port))?;
    let counts = flown.counts;
    report(&args.flight, &plan.experiment.title, flown)?;
    watched?;
    counts.filter(|_| !args.flight.json).map_or(Ok(()), say_commands)
}

/// A flight in real time, as a command defines it.
struct Order<'a> {
    plan: &'a Plan,
    args: &'a FlightArgs,
    sim: bool,
    duration_s: f64,
    /// Port of the live page; `None`: it is not served.
    live_port: Option<u16>,
}

/// Flies a plan in real time: the rig, or the simulated one, for so long and with the live page on that port. Returns
/// the result of the watch too.
pub(super) fn in_real_time(
    command: &'static str,
    plan: &Plan,
    args: &FlightArgs,
    sim: bool,
    (duration_s, live_port): (Option<f64>, Option<u16>),
) -> Result<(Flown, Result<()>)> {
    let table = plan.config.need(command, "rig", |tables| tables.rig.as_ref())?;
    let stop = landing_signal()?;
    let order = Order { plan, args, sim, duration_s: duration_s.unwrap_or(f64::INFINITY), live_port };
    let kept = plan.config.tables.log.as_ref().and_then(|log| log.last_fault.as_deref());
    if sim {
        let model = plan.config.need(command, "plant", |tables| tables.plant.as_ref())?;
        let rig = simulated_in_real_time(model, table, args.seed, Monotonic::start())?;
        return fly(&order, table, rig, None, &stop);
    }
    let bus = plan.config.need(command, "bus", |tables| tables.bus.as_ref())?;
    let claim = claim(bus)?;
    let enable = EnableLine::of(table);
    let stall_s = plan.table.period_s + plan.pilot.stall_s() + SLACK_S;
    let guard = Guard::start(bus, enable.as_ref(), stall_s, kept, &claim)?;
    let rig = bench(bus, table).inspect_err(|error| keep(kept, &LastFault::now(error.to_string(), None)))?;
    fly(&order, table, rig, Some(guard), &stop)
}

/// Starts log, MQTT and watch around a rig whose fan is off, and flies it.
fn fly<S: I2c, P: I2c, C: Clock + Clone>(
    order: &Order<'_>,
    table: &config::Rig,
    mut rig: Chips<S, P, C>,
    guard: Option<Guard>,
    stop: &Arc<AtomicBool>,
) -> Result<(Flown, Result<()>)> {
    let Order { plan, args, sim, duration_s, live_port } = *order;
    say_pwm(table.fan_pwm_hz, rig.fan_pwm_hz());
    let kept = plan.config.tables.log.as_ref().and_then(|log| log.last_fault.as_deref()).filter(|_| !sim);
    let last = kept.and_then(LastFault::read);
    if let Some(LastFault { at, fault, acknowledged: None, .. }) = &last {
        warn(format_args!("the last fault, at {at}: {fault}"));
    }
    let seed = sim.then_some(args.seed);
    let (path, header) = log_of(plan, args, seed, SystemTime::now());
    let rig_name = &table.name;
    let serve = |port| LocalServer::start(rig_name, port, |address| live::local(rig_name, address));
    let page = live_port.map(serve).transpose()?;
    let mqtt = plan.config.tables.mqtt.as_ref();
    let endpoint = page.as_ref().map(Endpoint::Page).or(mqtt.map(Endpoint::Broker));
    let about = About::of(&plan.config.tables, plan.pilot.offers(), sim);
    let owner = FlightOwner::new(&plan.config.tables, &plan.pilot, kept);
    let start = |(endpoint, about)| Link::start(&endpoint, &about, last.as_ref(), stop, Box::new(owner.clone()));
    let mut link = endpoint.zip(about).map(start).transpose()?;
    if let Some((link, _)) = &link {
        link.wait_for_others();
        alone(link, &table.name)?;
    }
    let mut queue = open_log(plan, &path, &header, args.log.is_none())?;
    owner.logs_to(queue.files());
    let pulse = Arc::new(AtomicU32::new(0));
    let watch = Watch::start(guard, Arc::clone(&pulse), Arc::clone(stop))?;
    real_time::of_the_loop().into_iter().for_each(warn);
    // From here on nothing can fail before the flight.
    if let Some(page) = &page {
        note(format_args!("live page {}", page.url()));
    }
    note(format_args!("flying \"{}\", Ctrl-C lands; log {}", plan.experiment.title, path.display()));

    let commander = link.as_mut().map(|(_, mailbox)| mailbox as &mut dyn Commander);
    let flight = Flight::new(&mut rig, plan.pilot.clone(), &plan.table, &mut queue, commander).with_pulse(&pulse);
    let flight = if plan.is_programme { flight.waiting_after_faults() } else { flight };
    let outcome = flight.fly(duration_s, stop);
    let watched = watch.finish(outcome.fan_still_on.is_none());
    let files = queue.files();
    let flown = outcome.punctuality.cycles > 0;
    let fault = match worst(&outcome, &watched) {
        Some(why) => Some(LastFault::now(why, Some(&files.current()))),
        None => kept.filter(|_| flown).and_then(|path| acknowledged(path, owner.waited_after().or(last).as_ref())),
    };
    if let Some(fault) = &fault {
        keep(kept, fault);
    }
    let other = link.as_ref().map_or(Ok(()), |(link, _)| alone(link, &table.name));
    let counts = link.map(|(link, _)| link.stop(fault.as_ref()));
    let log = queue.finish();
    let watched = watched.map_err(Into::into).and(other);
    Ok((Flown { outcome, log, files: files.all(), counts }, watched))
}

/// Refuses to fly beside another program that flies a rig of this name on the same broker: each would obey the other's
/// commands.
fn alone(link: &Link, rig: &str) -> Result<()> {
    let Some(other) = link.other() else { return Ok(()) };
    let (process, _) = other.split_once('-').unwrap_or((&other, ""));
    bail!(
        "another program flies a rig named {rig} on this broker (its process is {process}, perhaps of another \
         computer), and each would obey the other's commands; end that one, or give one of them another [rig] name"
    )
}

/// Why the flight ended, if not by its programme or a signal; worst first.
fn worst(outcome: &Outcome, watched: &Result<(), GuardError>) -> Option<String> {
    let before = |worse: String| match outcome.fault {
        Some(fault) => format!("{worse}. Before that: {fault}"),
        None => worse,
    };
    let lost = watched.as_ref().err().map(ToString::to_string);
    still_on(outcome).or(lost).map(before).or_else(|| outcome.fault.map(|fault| fault.to_string()))
}

/// The log of the flight. A disk that cannot be written does not prevent a flight; an existing log is never
/// overwritten.
fn open_log(plan: &Plan, path: &Path, header: &Header, ours: bool) -> Result<Queue, LogError> {
    let table = plan.config.tables.log.as_ref();
    // Only logs that the program has named are deleted to free space.
    let keep_bytes = table.and_then(|log| log.keep_mb).filter(|_| ours).map(bytes);
    let part_s = table.and_then(|log| log.part_s);
    let opened = if part_s.is_none() && keep_bytes.is_none() {
        LogWriter::create(path, header).and_then(Queue::start)
    } else {
        let limits = Limits { part_s: part_s.unwrap_or(f64::INFINITY), keep_bytes };
        Rotation::create(path, header, limits).and_then(Queue::rotating)
    };
    match opened {
        Err(error @ (LogError::Create { .. } | LogError::Write { .. })) => {
            warn(format_args!("{error}; flying without a log"));
            Ok(Queue::without_file(path, error))
        }
        opened => opened,
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and a million megabytes")]
fn bytes(megabytes: f64) -> u64 {
    (1e6 * megabytes) as u64
}

fn say_pwm(asked_hz: f64, given_hz: f64) {
    if (given_hz / asked_hz - 1.0).abs() > PWM_OFF {
        warn(format_args!("[rig] fan_pwm_hz asks for {asked_hz} Hz; the fan driver can give {given_hz:.0} Hz"));
    }
}

/// The fault before a flight that had none, acknowledged, so that it is not said again. A newer one in the file, as of
/// the guard, is not.
fn acknowledged(kept: &Path, last: Option<&LastFault>) -> Option<LastFault> {
    LastFault::read(kept).filter(|now| Some(now) == last)?.acknowledged()
}

fn say_commands(counts: Counts) -> Result<()> {
    let Counts { commands_received, commands_refused, commands_busy, .. } = counts;
    if commands_received == 0 {
        return Ok(());
    }
    say(format_args!(
        "commands  {commands_received}: {commands_refused} refused as unreadable, {commands_busy} while busy"
    ))
}

#[cfg(test)]
mod tests {
    use super::{GuardError, Outcome, acknowledged, worst};
    use crate::flight::deadline::Deadlines;
    use crate::flight::last_fault::LastFault;
    use crate::flight::vocabulary::{End, Fault};
    use embedded_hal::i2c::ErrorKind;

    #[test]
    fn a_flight_without_a_fault_acknowledges_the_last_one_once_and_none_that_came_meanwhile() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("last-fault.json");
        let (first, newer) = (LastFault::now("stuck".into(), None), LastFault::now("of the guard".into(), None));
        assert_eq!(acknowledged(&path, None), None);
        first.keep(&path).unwrap();
        let known = acknowledged(&path, Some(&first)).unwrap();
        assert!(known.acknowledged.is_some() && known.fault == "stuck", "{known:?}");
        known.keep(&path).unwrap();
        assert_eq!(acknowledged(&path, LastFault::read(&path).as_ref()), None);
        newer.keep(&path).unwrap();
        assert_eq!(acknowledged(&path, Some(&known)), None);
    }

    #[test]
    fn a_fan_that_stays_on_comes_before_a_lost_guard_and_that_before_a_fault_and_none_is_hidden() {
        let punctuality = Deadlines::new(0.0, 0.02, 0.002).punctuality();
        let well = Outcome { end: End::Finished, fault: None, punctuality, fan_still_on: None };
        assert_eq!(worst(&well, &Ok(())), None);
        assert!(worst(&well, &Err(GuardError::Lost)).unwrap().contains("guard"));
        let fault = Fault::SensorSilent { silent_s: 0.4 };
        let faulty = Outcome { end: End::Fault, fault: Some(fault), ..well };
        assert_eq!(worst(&faulty, &Ok(())), Some(fault.to_string()));
        let on = Outcome { fan_still_on: Some(ErrorKind::Bus), ..faulty };
        let said = worst(&on, &Err(GuardError::Lost)).unwrap();
        assert!(said.starts_with("the fan could not be turned off") && said.ends_with(&fault.to_string()), "{said}");
    }
}
