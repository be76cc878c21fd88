//! The picture of a replay: free runs of the model beside the record.

use crate::report::kit::palette::{DUTY, MENDED, NOMINAL};
use crate::report::kit::plot::{Diagram, Line, PlotError, SIZE, draw, forecasts, recorded};
use diagnose::{Forecast, FreeRun, Recording};
use std::path::Path;

/// The name of a second model.
const AGAINST: &str = "with the patch";

/// Draws a replay: the recorded position, the model's free runs from every 10 s, and the duty.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn replay(
    path: &Path,
    title: &str,
    recording: &Recording,
    runs: &[FreeRun],
    against: Option<&[FreeRun]>,
) -> Result<(), PlotError> {
    let samples = recording.samples();
    let forecast = forecasts("model, free from every 10 s", NOMINAL, recording, runs);
    let other = against.map(|runs| forecasts(AGAINST, MENDED, recording, runs));
    let position = [recorded(recording), forecast].into_iter().chain(other).collect();
    let duty = samples.iter().map(|s| (s.time_s, s.duty_percent)).collect();
    draw(path, SIZE, title, position, vec![Line { label: "", colour: DUTY, points: duty }])
}

/// Recorded positions, and the free runs of a model.
pub fn free_runs_of(recording: &Recording, runs: &[FreeRun], against: Option<&[FreeRun]>) -> Diagram {
    let other = against.map(|runs| forecasts(AGAINST, MENDED, recording, runs));
    let lines = [recorded(recording), forecasts("simulator", NOMINAL, recording, runs)];
    let lines = lines.into_iter().chain(other).collect();
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}

/// Recorded position minus the free runs.
pub fn errors_of(recording: &Recording, runs: &[FreeRun], against: Option<&[FreeRun]>) -> Diagram {
    let samples = recording.samples();
    let line = |label, colour, runs: &[FreeRun]| {
        let off = |one: &Forecast| Some((samples[one.row].time_s, samples[one.row].position_mm? - one.position_mm));
        let of_run =
            |run: &FreeRun| run.forecasts.iter().filter_map(off).chain([(f64::NAN, f64::NAN)]).collect::<Vec<_>>();
        Line { label, colour, points: runs.iter().flat_map(of_run).collect() }
    };
    let lines =
        std::iter::once(line("simulator", NOMINAL, runs)).chain(against.map(|runs| line(AGAINST, MENDED, runs)));
    let (abscissa, ordinate) = ("time, s", "recorded minus simulated, mm");
    Diagram { abscissa, ordinate, lines: lines.collect(), base: Some(0.0), ..Diagram::default() }
}
