//! How well an identified model foretells what it has not seen: the last third of each flight.
//!
//! ```text
//! fit = 1 − ‖y − ŷ‖/‖y − mean y‖        in percent; ŷ: forecasts some time ahead, or simulations over 10 s, from the filter's state
//! ```
//!
//! The model is fitted anew without that third. What noise alone allows is beside it: no model can be better than that but by chance.
//! Source: the measure of `compare` in MATLAB's System Identification Toolbox.

use crate::filter::track::innovations;
use crate::fit::estimate::{Fit, Problem};
use crate::gap::forecast_error::{FreeRun, Gap, free_runs};
use crate::record::folds::Folds;
use crate::record::recording::{Recording, Sample};
use crate::stats::spread::spread;
use plant::Model;
use serde::Serialize;

/// The share of each flight that is fitted to.
const FITTED: f64 = 2.0 / 3.0;

/// Fits in percent on the last third of each flight. `None` where it is too short to say.
#[derive(Clone, Debug)]
pub struct HeldOut {
    /// The model, fitted without that third.
    pub model: Model,
    /// Of the model.
    pub percent: Percent,
    /// Of what its noise alone would leave.
    pub allowed: Percent,
    /// The same errors in mm.
    pub gap: Gap,
    /// ln p of the readings of that third, nats: what two models may be compared by.
    pub log_likelihood: f64,
    /// Simulations over 10 s within that third.
    pub runs: Vec<FreeRun>,
}

/// Fits in percent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Percent {
    /// Forecasts 0.1, 0.5 and 1 s ahead.
    pub ahead: [Option<f64>; 3],
    /// Simulations over 10 s.
    pub simulated_10s: Option<f64>,
}

impl HeldOut {
    /// Fits again what `fit` has fitted, without the last third of each flight, and tries the result there.
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
        let of = |ahead: [Option<f64>; 3], parameters: Option<f64>| Percent {
            ahead: ahead.map(percent),
            simulated_10s: percent(parameters),
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

    /// The errors of a model on the last third of each flight: what a fit is to be compared with.
    #[must_use]
    pub fn gap_of(model: &Model, recording: &Recording) -> Gap {
        let (folds, is_late) = (Folds::new(model, recording), late(recording));
        Gap::measure_where(model, recording, &|row| folds.counts(row) && is_late[row])
    }
}

/// Which rows are in the last third of their flight.
fn late(recording: &Recording) -> Vec<bool> {
    let of_flight = |rows: &[Sample]| {
        let (first_s, last_s) = (rows.first().map_or(0.0, |s| s.time_s), rows.last().map_or(0.0, |s| s.time_s));
        rows.iter().map(|s| s.time_s > first_s + FITTED * (last_s - first_s)).collect::<Vec<_>>()
    };
    recording.flights().iter().flat_map(|flight| of_flight(&recording.samples()[flight.clone()])).collect()
}
