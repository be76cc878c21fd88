//! The command line of `airball identify`.

use super::{AboutArgs, ConfigArgs};
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `airball identify`
#[derive(Debug, Subcommand)]
pub enum IdentifyCommand {
    /// Gain, drag, hover and the fan's lag from any flight, with 90 % intervals, residual tests and the fit on what was
    /// held out
    GreyBox(GreyBoxArgs),
    /// Gain and drag from the overshoots of a sweep of proportional gains: the transient method of the thesis
    Transient(TransientArgs),
    /// The fan's lag that gives the model the critical gain that was measured on the rig
    ThirdPole(ThirdPoleArgs),
}

/// What every identification may be told.
#[derive(Debug, Args)]
pub struct IdentifyArgs {
    /// Which model to begin with, and how to read a foreign CSV.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write what was identified as a config patch for --patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Draw what was identified beside the record (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a report to look at and to print: one page that needs no network (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the result as JSON, and nothing else, to standard output
    #[arg(long)]
    pub json: bool,
}

/// `airball identify grey-box`
#[derive(Debug, Args)]
pub struct GreyBoxArgs {
    /// The log, MCAP of this program or CSV; several of one rig are used together
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// What every identification may be told.
    #[command(flatten)]
    pub identify: IdentifyArgs,
    /// Poles of the plant: 2 is the ball, 3 ball and fan [default: both, and the better of the two is kept]
    #[arg(long, value_enum, value_name = "N")]
    pub poles: Option<PolesArg>,
    /// About which height and duty the identified plant is linearised as well.
    #[command(flatten)]
    pub about: AboutArgs,
    /// Use the stretches without control alone, each detrended by a line
    #[arg(long)]
    pub open_loop: bool,
}

/// How many poles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PolesArg {
    /// The ball
    #[value(name = "2")]
    Two,
    /// Ball and fan
    #[value(name = "3")]
    Three,
}

/// `airball identify transient`
#[derive(Debug, Args)]
pub struct TransientArgs {
    /// The log, MCAP of this program or CSV, of pulses under proportional controllers; several of one rig are used
    /// together
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// What every identification may be told.
    #[command(flatten)]
    pub identify: IdentifyArgs,
    /// Dead time of the loop, seconds [default: half of the log's period, for the duty that is held]
    #[arg(long, value_name = "S")]
    pub dead_time: Option<f64>,
}

/// `airball identify third-pole`
#[derive(Debug, Args)]
pub struct ThirdPoleArgs {
    /// What every identification may be told.
    #[command(flatten)]
    pub identify: IdentifyArgs,
    /// Critical proportional gain that was measured on the rig, percent per mm
    #[arg(long, value_name = "K")]
    pub critical_gain: f64,
    /// Integral time at which it was measured, seconds
    #[arg(long, value_name = "S", default_value_t = 15.0)]
    pub integral_time: f64,
    /// Take the loop as sampled at the period of the config, and not as continuous
    #[arg(long)]
    pub sampled: bool,
}
