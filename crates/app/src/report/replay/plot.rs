//! The picture of a replay: free runs of the model beside the record.

use crate::report::kit::palette::{DUTY, NOMINAL};
use crate::report::kit::plot::{Diagram, Line, PlotError, SIZE, draw, forecasts, recorded};
use diagnose::{FreeRun, Recording};
use std::path::Path;

/// Draws a replay: the recorded position, the model's free runs from every 10 s, and the duty.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn replay(path: &Path, title: &str, recording: &Recording, runs: &[FreeRun]) -> Result<(), PlotError> {
    let samples = recording.samples();
    let forecast = forecasts("model, free from every 10 s", NOMINAL, recording, runs);
    let position = vec![recorded(recording), forecast];
    let duty = samples.iter().map(|s| (s.time_s, s.duty_percent)).collect();
    draw(path, SIZE, title, position, vec![Line { label: "", colour: DUTY, points: duty }])
}

/// Recorded positions, and the free runs of a model.
pub fn free_runs_of(recording: &Recording, runs: &[FreeRun]) -> Diagram {
    let lines = vec![recorded(recording), forecasts("simulator", NOMINAL, recording, runs)];
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}
