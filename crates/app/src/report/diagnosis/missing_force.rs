//! The missing force as a table for other programs: CSV, one row per reading.

use anyhow::{Result, anyhow};
use diagnose::MissingForce;
use std::path::Path;

/// Writes the force, mm/s², with its standard deviation, the position of the ball and the duty.
///
/// # Errors
/// A file that is there already, or cannot be written.
pub fn write(path: &Path, missing: &[MissingForce]) -> Result<()> {
    let failed =
        |cause: String| anyhow!("cannot write the missing force {}: {cause}; check the folder", path.display());
    let mut table = csv::Writer::from_path(path).map_err(|error| failed(error.to_string()))?;
    for moment in missing {
        table.serialize(moment).map_err(|error| failed(error.to_string()))?;
    }
    table.flush().map_err(|error| failed(error.to_string()))
}
