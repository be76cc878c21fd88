//! The gap between a simulator and a rig: a belief and recordings in, a diagnosis out.
//!
//! ```text
//! record → filter → fit → gap → residual → select → answer
//! ```
//!
//! Three functions are the face of this crate: [`check`] says what a recording cannot answer, [`diagnose`] compares a
//! belief with recordings, [`log_likelihood`] weighs a model by a recording. The answer is a [`Document`], which
//! serialises, and knows its sentences and its config patch. Beside them, [`identify`] finds plants of two and three
//! poles, and [`measure`] what an experiment says of a rig without a model. Does no file and no network access, reads
//! no clock, and runs in a browser.
//!
//! # Glossary
//!
//! | word | meaning |
//! |---|---|
//! | belief | the model that the owner of a rig has of it: base parameters, noise, effects |
//! | base parameters | gain, drag and hover |
//! | effect | an entry of the catalogue of `plant`: something that a rig does beyond the linear model |
//! | innovation ν | a reading minus its forecast by the filter from all readings before it; its variance is S |
//! | standardised innovation e | ν/√S: white with variance 1 under a right model |
//! | log-likelihood | Σ ln p(ν), in nats |
//! | fold | a quarter of the record's stretches, kept out of a fit that it then judges |
//! | held-out gain | by how much an effect raises the log-likelihood of folds that it was not fitted to, log-prior included |
//! | penalised gain | the held-out gain, but no more than the gain in sample less a nat a parameter; what a name takes |
//! | screening | a few steps of a fit by which the candidates for a full fit are chosen |
//! | residual | what the innovations of a fitted model still show: colour, a spectral line, uneven mean or variance, omitted terms |
//! | misfit | the statistics of the residual and their significance |
//! | score test | the test whether an omitted term would raise the likelihood, without fitting it |
//! | noise floor | the forecast error that the model's own noise makes |
//! | free run | a forecast over 10 s from one state, by the recorded duty alone |
//! | free flight | rows where the ball touches no end of the pipe and has not for a while |
//! | indistinguishable | effects whose held-out gains differ by less than chance may make |

mod answer;
mod filter;
mod fit;
mod gap;
pub mod identify;
pub mod linear;
pub mod measure;
mod mistakes;
mod options;
mod record;
mod residual;
pub mod scoring;
mod select;
mod spurious_duty;
mod stats;
pub mod thresholds;

// The flights for tests name this crate as the tests of `score` do, which share them.
#[cfg(test)]
extern crate self as diagnose;
#[cfg(test)]
mod random_for_tests;
#[cfg(test)]
mod tests_support;

// The face: three functions, and what goes in.
pub use answer::diagnosis::diagnose;
pub use fit::log_likelihood::log_likelihood;
pub use mistakes::mistakes;
pub use options::{Options, Progress, ProgressStep};
pub use record::check::{Finding, check};
pub use record::checks::Check;
pub use record::recording::{Recording, RecordingError, Sample};

// The answer, and what it is made of.
pub use answer::change::{Changes, NumberChange, Side};
pub use answer::closed_loop::{ClosedLoop, Compared, NextExperiment, Simulated};
pub use answer::diagnosis::Diagnosis;
pub use answer::document::{Context, Document, Interval, ParameterEntry};
pub use answer::effect_curves::{Abscissa, Binned, EffectCurve};
pub use answer::formula::FormulaTerm;
pub use answer::formula_curves::{FormulaCurve, Over};
pub use answer::headline::with_rivals;
pub use answer::ladder::{Dropped, Rest, Rung, Step};
pub use answer::sentences::{chance_in_words, decimals};
pub use answer::stages::StageShare;
pub use answer::verdict::Verdict;
pub use fit::bounds::Bounds;
pub use fit::estimate::Fit;
pub use fit::parameter::Parameter;
pub use gap::forecast_error::Gap;
pub use gap::share_closed::Closed;
pub use record::prepare::FlightFinding;
pub use record::stretches::MOST_ROWS;
pub use residual::constancy::Variation;
pub use residual::location::Place;
pub use residual::misfit::Misfit;
pub use residual::score_test::Omitted;
pub use residual::spectrum::Band;
pub use select::candidates::Candidate;
pub use select::odds::Evidence;
pub use select::posterior::Scored;
pub use select::stepwise::{Change, NamedEffect};

// What a report draws.
pub use answer::series::Series;
pub use filter::innovation::Innovation;
pub use filter::missing_force::MissingForce;
pub use filter::track::Forecast;
pub use gap::divergence::kl_divergence;
pub use gap::forecast_error::{FreeRun, free_runs};
pub use record::free_flight::{SETTLING_S, in_free_flight};
pub use record::implausible::{DutyScale, plausible};
pub use record::prepare::prepared;
pub use record::source_columns::{SourceColumn, SourceColumns};
pub use residual::plots::ResidualPlots;
