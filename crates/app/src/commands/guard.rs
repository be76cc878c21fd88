//! `airball guard`: turns the fan off when the loop on the other end of standard input is gone. `airball run` starts
//! it.

use super::{fail, warn};
use crate::bench::{Heard, Ward, turn_off};
use crate::cli::GuardArgs;
use crate::flight::last_fault::LastFault;
use crate::flight::real_time;
use anyhow::{Result, anyhow};
use config::Bus;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How long the guard tries to turn the fan off after a flight, seconds: longer than the bus is without power in a
/// brown-out.
const ALLOWED_S: f64 = 60.0;
/// The same where no cycle has run: the fan was never turned on.
const ALLOWED_ON_THE_GROUND_S: f64 = 1.0;

/// Watches until the loop has landed or is gone.
///
/// # Errors
/// Standard input is no line to a loop; the fan could not be turned off.
pub fn guard(args: &GuardArgs) -> Result<()> {
    ignore_signals()?;
    real_time::of_the_guard();
    let mut ward = Ward::on_standard_input(Duration::from_secs_f64(args.stall))
        .map_err(|error| anyhow!("standard input is no line to a loop ({error}); `airball run` starts the guard"))?;
    let (mut flown, mut stopped) = (false, false);
    loop {
        match ward.hear() {
            Heard::Beat => (flown, stopped) = (true, false),
            Heard::Landed => return Ok(()),
            Heard::Silence if flown && !stopped => {
                stopped = act(args, &format!("no control cycle for {} s", args.stall)).is_ok();
            }
            Heard::Silence => {}
            Heard::Failed => {
                turn_off(&bus(args), args.output_enable.as_ref(), ALLOWED_S)?;
                warn("the guard turned the fan off after all");
                return Ok(());
            }
            Heard::Gone if flown => return act(args, "the program died in flight, killed or crashed"),
            Heard::Gone => {
                return Ok(turn_off(&bus(args), args.output_enable.as_ref(), ALLOWED_ON_THE_GROUND_S)?);
            }
        }
    }
}

/// Turns the fan off first, and then reports and records the reason.
fn act(args: &GuardArgs, why: &str) -> Result<()> {
    let stopped = turn_off(&bus(args), args.output_enable.as_ref(), ALLOWED_S);
    let result = if stopped.is_ok() { "the guard turned the fan off" } else { "the fan may still run" };
    let fault = format!("{why}; {result}. See the journal for what killed it, and the log for what came before");
    fail(&fault);
    if let Some(path) = &args.last_fault
        && let Err(error) = LastFault::now(fault, None).keep(path)
    {
        warn(format_args!("the fault cannot be kept in {}: {error}; check [log] last_fault", path.display()));
    }
    Ok(stopped?)
}

fn bus(args: &GuardArgs) -> Bus {
    Bus { device: args.device.clone() }
}

/// Signals are for the loop. A guard that ended before its loop would leave the fan unguarded.
fn ignore_signals() -> Result<()> {
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGQUIT] {
        signal_hook::flag::register(signal, Arc::new(AtomicBool::new(false)))?;
    }
    Ok(())
}
