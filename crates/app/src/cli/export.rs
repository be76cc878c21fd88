//! The command line of `airball export`.

use super::ConfigArgs;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// `airball export`
#[derive(Debug, Subcommand)]
pub enum ExportCommand {
    /// Write the simulated rig as an FMU (FMI 2.0, co-simulation), for Simulink, OpenModelica and FMPy
    Fmu(FmuArgs),
}

/// `airball export fmu`
#[derive(Debug, Args)]
pub struct FmuArgs {
    /// Which config; its tables plant, rig and loop are simulated.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// The FMU to write; one that exists is kept
    #[arg(long, value_name = "FILE", default_value = "rig.fmu")]
    pub out: PathBuf,
    /// Compiled library of the FMU, once for each platform [default: libairball_fmu.so beside this program, and
    /// airball_fmu.dll where it is there]
    #[arg(long, value_name = "FILE")]
    pub library: Vec<PathBuf>,
}
