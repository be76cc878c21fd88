//! The command line of `airball measure`.

use super::FlightArgs;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `airball measure`
#[derive(Debug, Args)]
pub struct MeasureArgs {
    /// What to measure
    #[arg(value_enum, value_name = "WHAT")]
    pub what: Measurement,
    /// What every flight may be told.
    #[command(flatten)]
    pub flight: FlightArgs,
    /// Fly the simulated rig in real time
    #[arg(long)]
    pub sim: bool,
    /// Fly the simulated rig in virtual time: reproducible by its seed, as fast as the machine allows
    #[arg(long = "virtual", conflicts_with = "sim")]
    pub in_virtual_time: bool,
    /// Fly nothing; read this log of such an experiment: MCAP, CSV or Parquet
    #[arg(long, value_name = "LOG", conflicts_with_all = ["sim", "in_virtual_time", "experiment", "log"])]
    pub from: Option<PathBuf>,
    /// For calibration: travel of the ball from its rest at the bottom to its rest at the top, mm, by a ruler [default:
    /// pipe_length_mm of the config's table plant]
    #[arg(long, value_name = "MM", value_parser = travel)]
    pub travel_mm: Option<f64>,
    /// Write the result as a config patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Measurement {
    /// Duties between which the fan's force does not change, by jumps near hover (3 min)
    DeadZone,
    /// Force at 86 duties by timed jumps, and the fan lag (8 min)
    ForceCurve,
    /// Proportional gain at which the loop is marginally stable, by steps under rising gains (at most 8 min)
    CriticalGain,
    /// Integral time at which the loop is marginally stable, by steps under falling ones (at most 6 min)
    CriticalTime,
    /// Overshoot, peak time and settling over steps of several sizes (1 min)
    Steps,
    /// The same over a square wave (1 min)
    Square,
    /// Noise of the sensor, with the ball at rest (30 s)
    NoiseFloor,
    /// Offset and scale of the sensor, with the ball at rest at the bottom and at the top (40 s)
    Calibration,
}

fn travel(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(mm) if (10.0..=2000.0).contains(&mm) => Ok(mm),
        _ => Err("give 10 to 2000 mm".into()),
    }
}
