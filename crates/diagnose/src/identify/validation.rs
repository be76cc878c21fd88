//! Validation of an identified model on held-out data: the last third of each flight.
//!
//! ```text
//! fit = 1 − ‖y − ŷ‖/‖y − mean y‖        in percent; ŷ: forecasts, or free runs of 10 s, from the filter's state
//! ```
//!
//! The model is fitted again without that third. The noise floor is given too: no model is better except by chance.
//! Source: the measure of `compare` in MATLAB's System Identification Toolbox.

use crate::filter::track::innovations;
use crate::fit::estimate::{Fit, Problem};
use crate::gap::forecast_error::{FreeRun, Gap, free_runs};
use crate::record::folds::Folds;
use crate::record::recording::{Recording, Sample};
use crate::stats::spread::spread;
use plant::Model;
use serde::Serialize;

/// The share of each flight that is used for the fit.
const FITTED: f64 = 2.0 / 3.0;

/// Fits in percent on the last third of each flight; `None` if it is too short.
#[derive(Clone, Debug)]
pub struct HeldOut {
    /// The model, fitted without that third.
    pub model: Model,
    /// Fit of the model.
    pub percent: Percent,
    /// Fit that its noise allows.
    pub allowed: Percent,
    /// The same errors in mm.
    pub gap: Gap,
    /// ln p of the readings of that third, nats, for the comparison of two models.
    pub log_likelihood: f64,
    /// Free runs of 10 s within that third.
    pub runs: Vec<FreeRun>,
}

/// Fits in percent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Percent {
    /// Forecasts 0.1, 0.5 and 1 s ahead.
    pub ahead: [Option<f64>; 3],
    /// Free runs of 10 s.
    pub simulated_10s: Option<f64>,
}

impl HeldOut {
    /// Repeats the fit without the last third of each flight and evaluates the result there.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Self {
        let recording = problem.recording;
        let is_late = late(recording);
        let early = problem.folds.only(|row| !is_late[row]);
        let model = Problem { folds: &early, ..*problem }.fit(&fit.model, &fit.parameters).model;
        let counts = |row: usize| problem.folds.counts(row) && is_late[row];
        let gap = Gap::measure_where(&model, recording, &counts);
        let readings = recording.samples().iter().enumerate().filter(|(row, _)| counts(*row));
        let spread_mm = spread(readings.filter_map(|(_, s)| s.position_mm));
        let percent = |error: Option<f64>| Some(100.0 * (1.0 - error? / spread_mm?));
        let of = |ahead: [Option<f64>; 3], free_run: Option<f64>| Percent {
            ahead: ahead.map(percent),
            simulated_10s: percent(free_run),
        };
        Self {
            percent: of(gap.error_mm, gap.free_run_10s_mm),
            allowed: of(gap.floor_mm, gap.floor_free_run_10s_mm),
            log_likelihood: innovations(&model, recording)
                .iter()
                .filter(|s| counts(s.row))
                .map(|s| s.log_density)
                .sum(),
            runs: free_runs(&model, recording).into_iter().filter(|run| counts(run.row)).collect(),
            gap,
            model,
        }
    }

    /// The errors of a model on the last third of each flight, for comparison with a fit.
    #[must_use]
    pub fn gap_of(model: &Model, recording: &Recording) -> Gap {
        let (folds, is_late) = (Folds::new(model, recording), late(recording));
        Gap::measure_where(model, recording, &|row| folds.counts(row) && is_late[row])
    }
}

/// Whether each row is in the last third of its flight.
fn late(recording: &Recording) -> Vec<bool> {
    let of_flight = |rows: &[Sample]| {
        let (first_s, last_s) = (rows.first().map_or(0.0, |s| s.time_s), rows.last().map_or(0.0, |s| s.time_s));
        rows.iter().map(|s| s.time_s > first_s + FITTED * (last_s - first_s)).collect::<Vec<_>>()
    };
    recording.flights().iter().flat_map(|flight| of_flight(&recording.samples()[flight.clone()])).collect()
}
