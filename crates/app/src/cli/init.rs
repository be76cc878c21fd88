//! The command line of `airball init`.

use clap::Args;
use std::path::PathBuf;

/// `airball init`
#[derive(Debug, Args)]
pub struct InitArgs {
    /// The log; several of one rig are used together
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// The config to write; one that exists is kept
    #[arg(long, value_name = "FILE", default_value = "rig.toml")]
    pub out: PathBuf,
    /// Replace a config that exists
    #[arg(long)]
    pub force: bool,
    /// Ask nothing; without a terminal nothing is asked either
    #[arg(long)]
    pub yes: bool,
    /// Which column is what.
    #[command(flatten)]
    pub columns: ColumnArgs,
}

/// Which column is what, where it is not guessed.
#[derive(Clone, Debug, Default, Args)]
pub struct ColumnArgs {
    /// Column of the time
    #[arg(long, value_name = "COLUMN")]
    pub time: Option<String>,
    /// Seconds between two rows, where no column holds the time
    #[arg(long, value_name = "SECONDS", conflicts_with = "time", allow_negative_numbers = true, value_parser = period)]
    pub period: Option<f64>,
    /// Column of what drives the rig: a voltage, a torque, a duty
    #[arg(long, value_name = "COLUMN")]
    pub input: Option<String>,
    /// Column of where it is: a position, an angle
    #[arg(long, value_name = "COLUMN", conflicts_with = "speed")]
    pub position: Option<String>,
    /// Column of its speed, which is integrated to a position
    #[arg(long, value_name = "COLUMN")]
    pub speed: Option<String>,
    /// Column of where it shall be; without an input, the rig is a servo, and setpoint minus position its input
    #[arg(long, value_name = "COLUMN")]
    pub setpoint: Option<String>,
    /// Seconds per unit of the time, for instance 0.001 where it is in milliseconds
    #[arg(long, value_name = "SECONDS", conflicts_with = "period", value_parser = period)]
    pub time_scale: Option<f64>,
    /// Percent per unit of the input; below 0 turns its sign
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = scale)]
    pub input_scale: Option<f64>,
    /// Millimetres per unit of the position
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = scale)]
    pub position_scale: Option<f64>,
    /// Length of the way between two ends where the rig stops, from 0 to here [default: no ends]
    #[arg(long, value_name = "MM", value_parser = scale)]
    pub length: Option<f64>,
}

/// A number above 0.
fn period(text: &str) -> Result<f64, String> {
    scale(text).and_then(|value| if value > 0.0 { Ok(value) } else { Err("give a number above 0".into()) })
}

/// A number other than 0.
fn scale(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| String::from("give a number, for instance 1000"))?;
    if value.is_normal() { Ok(value) } else { Err("give a finite number other than 0".into()) }
}
