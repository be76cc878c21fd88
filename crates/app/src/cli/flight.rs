//! The command lines of what flies, and of `airball replay`.

use super::ConfigArgs;
use clap::Args;
use std::path::PathBuf;

/// What every flight may be told.
#[derive(Debug, Args)]
pub struct FlightArgs {
    /// Which config.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Fly this experiment [default: the reference of the config, or the experiment of the measurement]
    #[arg(long, value_name = "FILE")]
    pub experiment: Option<PathBuf>,
    /// Log of the flight (MCAP) [default: named by the time, in the directory of the config's table log]
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Seed of the noise of the simulated rig
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Draw the flight: setpoint, position and duty over time (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write the summary as JSON to standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// `airball run`
#[derive(Debug, Args)]
pub struct RunArgs {
    /// What every flight may be told.
    #[command(flatten)]
    pub flight: FlightArgs,
    /// Fly the simulated rig: the plant of the config, behind emulated chips
    #[arg(long)]
    pub sim: bool,
    /// End the flight after this time, seconds [default: the end of the experiment, or Ctrl-C]
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Serve the live page to browsers of this computer, and print its address; without the broker of the config
    #[arg(long)]
    pub live: bool,
    /// Port of the live page; 0: any that is free
    #[arg(long, value_name = "PORT", default_value_t = 8421, requires = "live")]
    pub live_port: u16,
}

/// `airball simulate`
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// What every flight may be told.
    #[command(flatten)]
    pub flight: FlightArgs,
    /// End the flight after this virtual time, seconds [default: the end of the experiment, or 60]
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub duration: Option<f64>,
}

/// `airball replay`
#[derive(Debug, Args)]
pub struct ReplayArgs {
    /// Log, MCAP, CSV or Parquet
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// Which model, and how to read a foreign CSV.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Compare a second model with it: the same config with this patch over it
    #[arg(long, value_name = "PATCH")]
    pub against: Option<PathBuf>,
    /// Draw the recorded position beside the model's free runs (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the gap as JSON to standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err("give a number of seconds above 0, for instance 60".into()),
    }
}
