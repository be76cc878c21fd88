//! `airball compare`.

use super::ConfigArgs;
use clap::Args;
use std::path::PathBuf;

/// `airball compare`
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The rig before: a log, MCAP, CSV or Parquet, or the JSON of a diagnosis
    #[arg(value_name = "BEFORE")]
    pub before: PathBuf,
    /// The same rig after
    #[arg(value_name = "AFTER")]
    pub after: PathBuf,
    /// Which model, and how to read a foreign CSV; for two diagnoses none is needed.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Write a report as one self-contained page (HTML); for two logs only
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the comparison as JSON to standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}
