//! `airball export`: the simulated rig for other tools.

use super::say;
use crate::cli::{ExportCommand, FmuArgs};
use crate::config::Config;
use crate::fmu;
use anyhow::Result;
use std::path::PathBuf;

/// Exports.
///
/// # Errors
/// A config that is not sound, a library that is not there, a file that cannot be written.
pub fn export(command: &ExportCommand) -> Result<()> {
    match command {
        ExportCommand::Fmu(args) => of_fmi(args),
    }
}

fn of_fmi(args: &FmuArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.over())?;
    let library = args.library.clone().unwrap_or_else(beside);
    fmu::export(&config, &library, &args.out)?;
    say(format_args!("wrote {}: FMI 2.0, co-simulation, 64-bit Linux", args.out.display()))
}

/// The library beside the running program.
fn beside() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    program.parent().map_or_else(|| fmu::LIBRARY.into(), |folder| folder.join(fmu::LIBRARY))
}
