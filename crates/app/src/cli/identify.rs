//! The command line of `airball identify`.

use super::{AboutArgs, ConfigArgs};
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `airball identify`
#[derive(Debug, Subcommand)]
pub enum IdentifyCommand {
    /// Find gain, drag, hover and fan lag from any flight, with 90 % intervals and residual tests
    GreyBox(GreyBoxArgs),
    /// Find gain and drag from the overshoots of a sweep of proportional gains, as the thesis did
    Transient(TransientArgs),
    /// Find the fan lag for which the model has the measured critical gain
    ThirdPole(ThirdPoleArgs),
}

/// What every identification may be told.
#[derive(Debug, Args)]
pub struct IdentifyArgs {
    /// Which model to begin with, and how to read a foreign CSV.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write the identified model as a config patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Draw the identified model beside the record (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the result as JSON to standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// `airball identify grey-box`
#[derive(Debug, Args)]
pub struct GreyBoxArgs {
    /// Log, MCAP, CSV or Parquet; several logs of one rig are used together
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// What every identification may be told.
    #[command(flatten)]
    pub identify: IdentifyArgs,
    /// Poles of the model: 2 for the ball, 3 for ball and fan [default: both; the better model is kept]
    #[arg(long, value_enum, value_name = "N")]
    pub poles: Option<PolesArg>,
    /// About which height and duty the identified plant is linearised as well.
    #[command(flatten)]
    pub about: AboutArgs,
    /// Use only the stretches without control, each with its linear trend removed
    #[arg(long)]
    pub open_loop: bool,
    /// Identify the plant from the control value instead of the duty, as the config's compensation converts one to the
    /// other: behind a predistortion in mm/s², otherwise in percent about hover
    #[arg(long, conflicts_with_all = ["about_duty", "about_height"])]
    pub per_control: bool,
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
    /// Logs of pulses under proportional controllers, MCAP, CSV or Parquet
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// What every identification may be told.
    #[command(flatten)]
    pub identify: IdentifyArgs,
    /// Dead time of the loop, seconds [default: half the period of the log, for the zero-order hold of the duty]
    #[arg(long, value_name = "S")]
    pub dead_time: Option<f64>,
}

/// `airball identify third-pole`
#[derive(Debug, Args)]
pub struct ThirdPoleArgs {
    /// What every identification may be told.
    #[command(flatten)]
    pub identify: IdentifyArgs,
    /// Measured critical proportional gain, percent per mm
    #[arg(long, value_name = "K")]
    pub critical_gain: f64,
    /// Integral time of that measurement, seconds
    #[arg(long, value_name = "S", default_value_t = 15.0)]
    pub integral_time: f64,
    /// Model the loop as sampled at the period of the config [default: continuous]
    #[arg(long)]
    pub sampled: bool,
}
