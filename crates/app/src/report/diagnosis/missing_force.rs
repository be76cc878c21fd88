//! The missing force as a table for other programs: CSV, one row per reading.

use anyhow::Result;
use diagnose::MissingForce;

/// The force, mm/s², with its standard deviation, the position of the ball and the duty, as CSV.
///
/// # Errors
/// A row that the CSV library refuses.
pub fn table(missing: &[MissingForce]) -> Result<String> {
    let mut table = csv::Writer::from_writer(Vec::new());
    for moment in missing {
        table.serialize(moment)?;
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}
