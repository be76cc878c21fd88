//! `airball fan-off`: turns the fan off in every situation.

use super::{say, warn};
use crate::bench::{BenchError, EnableLine, claim, turn_off};
use crate::cli::FanOffArgs;
use anyhow::Result;
use config::{Bus, Config};

/// How long the command tries, seconds.
const ALLOWED_S: f64 = 5.0;

/// Turns the fan off and reads back that it is.
///
/// # Errors
/// A config without a bus, a bus that cannot be opened, a chip that does not obey.
pub fn fan_off(args: &FanOffArgs) -> Result<()> {
    let (bus, enable) = match &args.device {
        Some(device) => (Bus { device: device.clone() }, None),
        None => {
            let config = Config::read(&args.config.config, &args.config.over())?;
            let bus = config.need("fan-off", "bus", |tables| tables.bus.as_ref())?.clone();
            (bus, config.tables.rig.as_ref().and_then(EnableLine::of))
        }
    };
    // The fan is turned off before anything else is checked.
    turn_off(&bus, enable.as_ref(), ALLOWED_S)?;
    say(format_args!("the fan on {} is off", bus.device))?;
    if matches!(claim(&bus), Err(BenchError::Taken { .. })) {
        warn("a flight holds this bus and turns the fan on again within a cycle; end it with Ctrl-C or SIGTERM");
    }
    Ok(())
}
