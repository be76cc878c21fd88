//! `airball export`: the simulated rig for other tools.

use super::say;
use crate::cli::{ExportCommand, FmuArgs};
use crate::export_fmu::{export as export_fmu, libraries_in};
use anyhow::Result;
use config::Config;
use fmu::Platform;
use std::path::{Path, PathBuf};

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
    let libraries = if args.library.is_empty() { beside() } else { args.library.clone() };
    let platforms = export_fmu(&config, &libraries, &args.out)?;
    let names: Vec<String> = platforms.iter().map(Platform::to_string).collect();
    say(format_args!("wrote {}: FMI 2.0, co-simulation, for {}", args.out.display(), names.join(" and ")))
}

/// The libraries beside the running program.
fn beside() -> Vec<PathBuf> {
    let program = std::env::current_exe().unwrap_or_default();
    libraries_in(program.parent().unwrap_or(Path::new("")))
}
