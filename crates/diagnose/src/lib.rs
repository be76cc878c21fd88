//! The gap between a simulator and a rig: a recording and a model in, findings out.
//!
//! [`Recording`] is what a rig did; [`Track`] is a model's filter along it; [`Gap`] says how well the model
//! forecasts, beside what noise alone would give. Works on the recorded duty and the real time stamps, and
//! does no file or network access.

mod answer;
mod filter;
mod fit;
mod gap;
pub mod identify;
pub mod measure;
mod options;
mod record;
mod residual;
pub mod scoring;
mod select;
mod stats;
pub mod thresholds;

#[cfg(test)]
mod tests_support;

pub use answer::closed_loop::{ClosedLoop, Compared, NextExperiment, Simulated};
pub use answer::diagnosis::{Diagnosis, Verdict, diagnose};
pub use answer::document::{Context, Document, Interval, ParameterEntry};
pub use answer::sentences::{decimals, with_rivals};
pub use answer::series::Series;
pub use answer::stages::StageShare;
pub use filter::innovation::Innovation;
pub use filter::missing_force::{MissingForce, missing_force};
pub use filter::track::{Forecast, Track, innovations};
pub use fit::estimate::{Fit, LogLikByFold, Problem};
pub use fit::parameter::{BASE, Parameter, Prior, prior};
pub use gap::divergence::kl_divergence;
pub use gap::forecast_error::{FreeRun, Gap, free_runs};
pub use gap::share_closed::Closed;
pub use identify::grey_box::{Estimate, GreyBox, Poles, TooLittle};
pub use identify::open_loop::OpenLoop;
pub use identify::relay as oscillation;
pub use identify::residual_tests::{ResidualTests, Test};
pub use identify::transient::steps::{Pulse, Rejected, pulses};
pub use identify::transient::sweep::{NoSweep, OfGain, Sweep};
pub use identify::transient::{fan_pole, second_order as transient};
pub use identify::validation::{HeldOut, Percent};
pub use measure::timed_jump as force_curve;
pub use options::{Options, Progress, ProgressStep};
pub use record::check::{Finding, check, without_codes};
pub use record::folds::Folds;
pub use record::free_flight::in_free_flight;
pub use record::prepare::{FlightFinding, prepared};
pub use record::recording::{Recording, RecordingError, Sample};
pub use residual::location::Place;
pub use residual::misfit::Misfit;
pub use residual::plots::ResidualPlots;
pub use residual::score_test::Omitted;
pub use residual::spectrum::Band;
pub use select::candidates::Candidate;
pub use select::posterior::Scored;
pub use select::stepwise::{Change, NamedEffect};
