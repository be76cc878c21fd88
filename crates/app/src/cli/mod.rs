//! The command line. Flags mean the same everywhere.

mod compare;
mod design;
mod each;
mod export;
mod flight;
mod identify;
mod init;
mod measure;

pub use compare::CompareArgs;
pub use design::{
    AboutArgs, CriticalGainArgs, DesignArgs, DesignCommand, LqrArgs, ObserverArgs, PidArgs, PolesArgs, RelayArgs,
    RelayRule,
};
pub use each::{EachArgs, Shard};
pub use export::{ExportCommand, FmuArgs};
pub use flight::{FlightArgs, ReplayArgs, RunArgs, SimulateArgs};
pub use identify::{GreyBoxArgs, IdentifyArgs, IdentifyCommand, PolesArg, ThirdPoleArgs, TransientArgs};
pub use init::{ColumnArgs, InitArgs};
pub use measure::{MeasureArgs, Measurement};

use crate::bench::EnableLine;
use clap::{Args, Parser, Subcommand};
use config::USUAL;
use diagnose::{Options, Progress};
use flight::seconds;
use std::path::PathBuf;

/// Fly, simulate and identify a ball-in-pipe rig, and find out why simulator and rig disagree; reads logs of other rigs
/// too.
#[derive(Debug, Parser)]
#[command(name = "airball", version, max_term_width = 100, args_override_self = true)]
#[command(
    after_help = "Exit status: 0 done, 1 failed, 2 wrong usage or config. `diagnose`: 3 if the record cannot answer. \
         `log recover`: 0 complete, 3 incomplete, 1 nothing recovered."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Fly the rig in real time, or with --sim the simulated rig
    Run(RunArgs),
    /// Fly the simulated rig in virtual time: reproducible by its seed, as fast as the machine allows
    Simulate(SimulateArgs),
    /// Fly an experiment and measure dead zone, force curve, critical gain, steps, noise or calibration
    Measure(MeasureArgs),
    /// Propose a config for a CSV of a rig that has none: columns, units and a linear plant, fitted to the record
    Init(InitArgs),
    /// Compare a model's forecasts with a log, and their errors with those that noise alone gives
    Replay(ReplayArgs),
    /// Find the effect that a model lacks, from logs of the rig, and how much of the gap it closes
    Diagnose(Box<DiagnoseArgs>),
    /// Compare two logs or diagnoses of one rig, before and after: what changed beyond chance
    Compare(CompareArgs),
    /// Design a controller, or report the stability margins of the current loop
    #[command(subcommand)]
    Design(DesignCommand),
    /// Identify a model of the plant from logs
    #[command(subcommand)]
    Identify(IdentifyCommand),
    /// Export the simulated rig for other tools
    #[command(subcommand)]
    Export(ExportCommand),
    /// Watch and control a rig from a terminal, through its MQTT broker
    Monitor(MonitorArgs),
    /// Write a web page that flies a rig: live charts, setpoint, gains, experiments, stop
    Live(LiveArgs),
    /// Turn the fan off, in any state of the rig
    FanOff(FanOffArgs),
    /// Emulate the rig's I2C bus on a socket, to rehearse faults; prints each change of the fan
    Emulate(EmulateArgs),
    /// Turn the fan off when the control loop is gone; `run` starts it
    #[command(hide = true)]
    Guard(GuardArgs),
    /// Check a config, or print it with its patches
    #[command(subcommand)]
    Config(ConfigCommand),
    /// Show, export or recover a log
    #[command(subcommand)]
    Log(LogCommand),
}

/// Which config.
#[derive(Debug, Args)]
pub struct ConfigArgs {
    /// Config file
    #[arg(long, value_name = "FILE", default_value = USUAL)]
    pub config: PathBuf,
    /// Config patch, merged over the config; may be repeated, the last one wins
    #[arg(long, value_name = "FILE")]
    pub patch: Vec<PathBuf>,
    /// File with effects of your own, tables [effect.NAME]; merged over the config before the patches
    #[arg(long, value_name = "FILE")]
    pub effects: Vec<PathBuf>,
}

impl ConfigArgs {
    /// The files that are merged over the config, in their order.
    #[must_use]
    pub fn over(&self) -> Vec<PathBuf> {
        self.effects.iter().chain(&self.patch).cloned().collect()
    }

    /// All files, the config first.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        std::iter::once(self.config.clone()).chain(self.over()).collect()
    }
}

/// `airball diagnose`
#[derive(Debug, Args)]
pub struct DiagnoseArgs {
    /// Log, MCAP, CSV or Parquet; several logs of one rig are used together. With --each, a folder stands for
    /// the logs in it
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// Which model, and how to read a foreign CSV.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Propose a config from the logs and diagnose with it, as `airball init` does; without a config in the folder this
    /// is done anyway
    #[arg(long, conflicts_with = "config")]
    pub init: bool,
    /// Write the mended model, with the found effects that make its forecasts better, as a config patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Write the experiment to fly next, for --experiment, if one is needed
    #[arg(long, value_name = "FILE")]
    pub next_out: Option<PathBuf>,
    /// Draw free runs of the model before and after, and the residual force over time, duty, height and speed (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the residual force and its standard deviation for every sample (CSV)
    #[arg(long = "residual-force", alias = "missing-force", value_name = "FILE")]
    pub missing_force: Option<PathBuf>,
    /// Leave this effect out of the search; may be repeated
    #[arg(long, value_name = "EFFECT")]
    pub without: Vec<String>,
    /// Search for no formula of what no effect explains; that search may take longer than all else
    #[arg(long)]
    pub without_formula: bool,
    /// Write the diagnosis as JSON to standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
    /// Many logs, each by itself.
    #[command(flatten)]
    pub each: EachArgs,
    /// Which column is what, where a config is proposed.
    #[command(flatten, next_help_heading = "Columns, where a config is proposed")]
    pub columns: ColumnArgs,
}

impl DiagnoseArgs {
    /// The options of the search, which reports to `progress`.
    #[must_use]
    pub fn options(&self, progress: Progress) -> Options {
        let (without, without_formula) = (self.without.clone(), self.without_formula);
        Options { progress, without, without_formula, ..Options::default() }
    }
}

/// `airball monitor`
#[derive(Debug, Args)]
pub struct MonitorArgs {
    /// Which config; its tables rig and mqtt say which rig, and where its broker is.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write one line of the rig's state and end [default without a terminal: one line per second]
    #[arg(long)]
    pub once: bool,
}

/// `airball live`
#[derive(Debug, Args)]
pub struct LiveArgs {
    /// Which config; its tables rig and mqtt say which rig the page flies.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write the page here (HTML)
    #[arg(long, value_name = "FILE", default_value = "live.html")]
    pub out: PathBuf,
    /// WebSockets address of the broker [default: the host that serves the page; if it is opened as a file, port 9001
    /// of the config's broker]
    #[arg(long, value_name = "URL")]
    pub broker: Option<String>,
    /// Write a page with a tile for each rig of the broker here (HTML), in the folder of --out
    #[arg(long, value_name = "FILE")]
    pub wall: Option<PathBuf>,
}

/// `airball fan-off`
#[derive(Debug, Args)]
pub struct FanOffArgs {
    /// Which config; its table bus says where the fan is.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// I2C bus of the fan; then no config is read [default: from the config]
    #[arg(long, value_name = "FILE")]
    pub device: Option<String>,
}

/// `airball emulate`
#[derive(Debug, Args)]
pub struct EmulateArgs {
    /// Which config; its tables plant and rig are emulated.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Socket of the emulated bus; fly it with device = "unix:FILE" in the config's table bus
    #[arg(long, value_name = "FILE")]
    pub socket: PathBuf,
    /// Seed of the simulated rig's noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// `airball guard`
#[derive(Debug, Args)]
pub struct GuardArgs {
    /// I2C bus of the fan
    #[arg(long, value_name = "FILE")]
    pub device: String,
    /// Line of the fan driver's output-enable, which turns the fan off even where the bus does not
    #[arg(long, value_name = "CHIP:LINE")]
    pub output_enable: Option<EnableLine>,
    /// Turn the fan off after so many seconds without a control cycle
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub stall: f64,
    /// Write the fault to this file
    #[arg(long, value_name = "FILE")]
    pub last_fault: Option<PathBuf>,
}

/// `airball config`
#[derive(Debug, Subcommand)]
pub enum ConfigCommand {
    /// Check a config, and name its first mistake
    Check(ConfigArgs),
    /// Print the config with its patches applied
    Print(ConfigArgs),
    /// Print effects that the catalogue does not have, as a file for --effects
    Effects,
}

/// `airball log`
#[derive(Debug, Subcommand)]
pub enum LogCommand {
    /// Show what a log holds: flight, events, summary
    Info {
        /// Log, MCAP of this program
        log: PathBuf,
    },
    /// Write the cycles of a log as CSV to standard output
    Export {
        /// Log, MCAP of this program
        log: PathBuf,
    },
    /// Write a readable log from a damaged one. Exit status: 0 complete, 3 incomplete, 1 nothing recovered
    Recover {
        /// Damaged log
        log: PathBuf,
        /// Write the new log here [default: the name of the damaged one with .recovered.mcap]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}

#[cfg(test)]
mod tests {
    use super::{Cli, Command};
    use clap::{CommandFactory, Parser};

    #[test]
    fn a_diagnosis_of_each_log_has_the_same_options_as_one() {
        let flags =
            ["airball", "diagnose", "--each", "--out", "o", "--without-formula", "--without", "dead_zone", "a.csv"];
        let Command::Diagnose(args) = Cli::try_parse_from(flags).unwrap().command else { panic!() };
        let options = args.options(diagnose::Progress::default());
        assert_eq!((options.without_formula, options.without), (true, vec!["dead_zone".to_owned()]));
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
