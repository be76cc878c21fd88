//! The command line. Flags mean the same everywhere.

mod design;
mod each;
mod flight;
mod identify;
mod init;
mod measure;

pub use design::{
    AboutArgs, CriticalGainArgs, DesignArgs, DesignCommand, LqrArgs, ObserverArgs, PidArgs, PolesArgs, RelayArgs,
    RelayRule,
};
pub use each::{EachArgs, Shard};
pub use flight::{FlightArgs, ReplayArgs, RunArgs, SimulateArgs};
pub use identify::{GreyBoxArgs, IdentifyArgs, IdentifyCommand, PolesArg, ThirdPoleArgs, TransientArgs};
pub use init::{ColumnArgs, InitArgs};
pub use measure::{MeasureArgs, Measurement};

use crate::rig::EnableLine;
use clap::{Args, Parser, Subcommand};
use flight::seconds;
use std::path::PathBuf;

/// Firmware and simulator of a rig that keeps a ball at a height in a pipe, and a look at the gap between the two.
#[derive(Debug, Parser)]
#[command(name = "airball", version, max_term_width = 100, args_override_self = true)]
#[command(
    after_help = "Exit status: 0 done, 1 failed, 2 wrong usage or config; `log recover`: 0 all, 3 some is lost, 1 nothing."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Fly the rig, or with --sim the simulated rig, in real time
    Run(RunArgs),
    /// Fly the simulated rig in virtual time: seeded, bit-exact, as fast as the machine
    Simulate(SimulateArgs),
    /// Measure the rig by an experiment: dead zone, force curve, critical gain, steps, noise, calibration
    Measure(MeasureArgs),
    /// Propose a config for a CSV of a rig that has none: columns, units and a linear plant, fitted to the record
    Init(InitArgs),
    /// Run a log through a model: how far its forecasts are off, beside what noise alone gives
    Replay(ReplayArgs),
    /// Say which effect separates logs of a rig from a model, where, and how far it closes the gap
    Diagnose(DiagnoseArgs),
    /// Design a controller for the model of a config, or say what its loop bears
    #[command(subcommand)]
    Design(DesignCommand),
    /// Identify the plant of a rig from its logs
    #[command(subcommand)]
    Identify(IdentifyCommand),
    /// Watch and steer a rig in a terminal, over its broker
    Monitor(MonitorArgs),
    /// Write the page that flies a rig from a browser: live charts, setpoint, gains, experiments, stop
    Live(LiveArgs),
    /// Turn the fan off, whatever else happens on the rig
    FanOff(FanOffArgs),
    /// Emulate the rig's bus on a socket: what is flown on it can be killed, and the fan looked at
    Emulate(EmulateArgs),
    /// Turn the fan off when the loop on the other end of standard input is gone; `run` starts it
    #[command(hide = true)]
    Guard(GuardArgs),
    /// Check or print a config
    #[command(subcommand)]
    Config(ConfigCommand),
    /// Look into a log
    #[command(subcommand)]
    Log(LogCommand),
}

/// Which config.
#[derive(Debug, Args)]
pub struct ConfigArgs {
    /// Config file
    #[arg(long, value_name = "FILE", default_value = "config.toml")]
    pub config: PathBuf,
    /// Config patch, merged over the config; may be given again, later wins
    #[arg(long, value_name = "FILE")]
    pub patch: Vec<PathBuf>,
    /// Library of effects of your own, [effect.NAME] tables, merged over the config before the patches
    #[arg(long, value_name = "FILE")]
    pub effects: Vec<PathBuf>,
}

impl ConfigArgs {
    /// The files that are merged over the config, in their order.
    #[must_use]
    pub fn over(&self) -> Vec<PathBuf> {
        self.effects.iter().chain(&self.patch).cloned().collect()
    }
}

/// `airball diagnose`
#[derive(Debug, Args)]
pub struct DiagnoseArgs {
    /// The log, MCAP of this program or CSV; several of one rig are used together. With --each, a folder stands for the
    /// logs in it
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// Which model, and how to read a foreign CSV.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Propose a config from the logs and diagnose with it, as `airball init` does; without a config in the folder this
    /// is done anyway
    #[arg(long, conflicts_with = "config")]
    pub init: bool,
    /// Write the mended model as a config patch for --patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Write the experiment to fly next, for --experiment; none is written where none is called for
    #[arg(long, value_name = "FILE")]
    pub next_out: Option<PathBuf>,
    /// Draw free runs as believed and mended, and the missing force over time, duty, height and speed (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a report to look at and to print: one page that needs no network (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the force that the believed effects leave unexplained, reading by reading with its standard deviation
    /// (CSV)
    #[arg(long, value_name = "FILE")]
    pub missing_force: Option<PathBuf>,
    /// Never name this effect, as if the catalogue did not hold it: what else explains the record? May be given again
    #[arg(long, value_name = "EFFECT")]
    pub without: Vec<String>,
    /// Write the diagnosis as JSON, and nothing else, to standard output
    #[arg(long)]
    pub json: bool,
    /// Many logs, each by itself.
    #[command(flatten)]
    pub each: EachArgs,
    /// Which column is what, where a config is proposed.
    #[command(flatten, next_help_heading = "Columns, where a config is proposed")]
    pub columns: ColumnArgs,
}

/// `airball monitor`
#[derive(Debug, Args)]
pub struct MonitorArgs {
    /// Which config; its tables rig and mqtt say which rig, and where its broker is.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write one line of the rig's state and end; without a terminal a line a second is written
    #[arg(long)]
    pub once: bool,
}

/// `airball live`
#[derive(Debug, Args)]
pub struct LiveArgs {
    /// Which config; its tables rig and mqtt say which rig the page flies.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// The page (HTML)
    #[arg(long, value_name = "FILE", default_value = "live.html")]
    pub out: PathBuf,
    /// WebSockets of the broker [default: those of the host that serves the page; opened as a file, port 9001 of the
    /// config's broker]
    #[arg(long, value_name = "URL")]
    pub broker: Option<String>,
}

/// `airball fan-off`
#[derive(Debug, Args)]
pub struct FanOffArgs {
    /// Which config; its table bus says where the fan is.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// I2C bus [default: the config's]; with it no config is read
    #[arg(long, value_name = "FILE")]
    pub device: Option<String>,
}

/// `airball emulate`
#[derive(Debug, Args)]
pub struct EmulateArgs {
    /// Which config; its tables plant and rig are emulated.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Socket to serve the bus at; a config flies it whose table bus says device = "unix:FILE"
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
    /// Keep what happened here
    #[arg(long, value_name = "FILE")]
    pub last_fault: Option<PathBuf>,
}

/// `airball config`
#[derive(Debug, Subcommand)]
pub enum ConfigCommand {
    /// Say whether a config is sound, or where it is not
    Check(ConfigArgs),
    /// Print the config in force after its patches
    Print(ConfigArgs),
}

/// `airball log`
#[derive(Debug, Subcommand)]
pub enum LogCommand {
    /// What is in a log: flight, events, summary
    Info {
        /// The log
        log: PathBuf,
    },
    /// Write a log's cycles as CSV to standard output
    Export {
        /// The log
        log: PathBuf,
    },
    /// Write a whole log from what a damaged or cut one holds. Exit status: 0 all of it, 3 some is lost, 1 nothing
    Recover {
        /// The damaged log
        log: PathBuf,
        /// The new log [default: the damaged one's name with .recovered.mcap]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
