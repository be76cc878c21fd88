//! The gap between a simulator and a rig: a recording and a model in, findings out.
//!
//! [`Recording`] is what a rig did; [`Track`] is a model's filter along it; [`Gap`] says how well the model
//! forecasts, beside what noise alone would give. Works on the recorded duty and the real time stamps, and
//! does no file or network access.

mod check;
mod gap;
mod recording;
mod track;

#[cfg(test)]
mod tests_support;

pub use check::{Finding, check};
pub use gap::{FreeRun, Gap, free_runs};
pub use recording::{Recording, RecordingError, Sample};
pub use track::{Forecast, Track};
