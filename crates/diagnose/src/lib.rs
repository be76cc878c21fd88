//! The gap between a simulator and a rig: a recording and a model in, findings out.
//!
//! [`Recording`] is what a rig did; [`Track`] is a model's filter along it; [`Gap`] says how well the model
//! forecasts, beside what noise alone would give. Works on the recorded duty and the real time stamps, and
//! does no file or network access.

mod aloft;
mod along;
mod apart;
mod arrival;
mod changed;
mod check;
mod chi_square;
mod closed;
mod coarse;
mod comb;
mod cursor;
mod diagnosis;
mod explain;
pub mod fan_pole;
mod fit;
mod folds;
pub mod force_curve;
mod free;
mod gap;
mod grey_box;
mod grid;
mod held_out;
mod hold;
mod intervals;
mod lag;
mod leftover;
mod likelihood;
mod look;
pub mod measure;
mod missing_force;
mod omitted;
mod open_loop;
mod order;
pub mod oscillation;
mod peak;
mod picture;
mod places;
mod plausible;
mod prepare;
mod profile;
mod pulses;
mod recording;
mod residual_tests;
mod residue;
mod rotor;
pub mod scoring;
mod second;
mod spectrum;
mod stages;
mod starts;
mod sweep;
mod thin;
mod track;
pub mod transient;
mod tried;
mod watch;
mod which;

#[cfg(test)]
mod tests_support;

pub use apart::nats_apart;
pub use check::{Finding, check, without_codes};
pub use closed::Closed;
pub use diagnosis::{Diagnosis, Options, Verdict, diagnose};
pub use explain::{Change, Named};
pub use fit::{Fit, Problem, Worth};
pub use folds::Folds;
pub use free::{BASE, Free, Prior, prior};
pub use gap::{FreeRun, Gap, free_runs};
pub use grey_box::{Estimate, GreyBox, Poles, TooLittle};
pub use held_out::{HeldOut, Percent};
pub use leftover::Leftover;
pub use likelihood::{Surprise, in_free_flight, surprises};
pub use missing_force::{MissingForce, missing_force};
pub use omitted::Omitted;
pub use open_loop::OpenLoop;
pub use picture::Picture;
pub use places::{Place, places};
pub use prepare::{Noted, prepared};
pub use pulses::{Pulse, Rejected, pulses};
pub use recording::{Recording, RecordingError, Sample};
pub use residual_tests::{ResidualTests, Test};
pub use residue::Residue;
pub use spectrum::Band;
pub use sweep::{NoSweep, OfGain, Sweep};
pub use track::{Forecast, Track};
pub use tried::Tried;
pub use watch::{Step, Watch};
pub use which::Candidate;
