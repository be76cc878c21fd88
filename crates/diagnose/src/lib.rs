//! The gap between a simulator and a rig: a recording and a model in, findings out.
//!
//! [`Recording`] is what a rig did; [`Track`] is a model's filter along it; [`Gap`] says how well the model
//! forecasts, beside what noise alone would give. Works on the recorded duty and the real time stamps, and
//! does no file or network access.

mod arrival;
mod check;
mod cursor;
mod diagnosis;
mod fit;
mod gap;
mod likelihood;
mod places;
mod recording;
mod track;
mod which;

#[cfg(test)]
mod tests_support;

pub use check::{Finding, check};
pub use diagnosis::{Diagnosis, Named, Options, Verdict, diagnose};
pub use fit::{BASE, Fit, Free, Problem};
pub use gap::{FreeRun, Gap, free_runs};
pub use likelihood::{Surprise, in_free_flight, surprises};
pub use places::{Place, colour, places};
pub use recording::{Recording, RecordingError, Sample};
pub use track::{Forecast, Track};
pub use which::Candidate;
