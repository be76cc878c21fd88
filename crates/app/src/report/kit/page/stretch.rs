//! The part of a record that is shown first: where a model errs most.

use diagnose::{Forecast, FreeRun, Recording};

/// Largest number of free runs in it.
const RUNS: usize = 3;

/// The time of the consecutive free runs of one flight with the largest error, seconds. `None`: there is no free run.
pub fn worst(recording: &Recording, all: &[FreeRun]) -> Option<(f64, f64)> {
    let samples = recording.samples();
    let square = |run: &FreeRun| -> f64 {
        let off = |f: &Forecast| Some((samples[f.row].position_mm? - f.position_mm).powi(2));
        run.forecasts.iter().filter_map(off).sum()
    };
    let span = |runs: &[FreeRun]| {
        let last = runs.last()?.forecasts.last()?.row;
        let one_flight = recording.flight_of(runs.first()?.row).contains(&last);
        let (from_s, to_s) = (samples[runs.first()?.row].time_s, samples[last].time_s);
        let together = to_s - from_s < 1.5 * 10.0 * runs.len() as f64;
        (one_flight && together).then(|| (runs.iter().map(square).sum::<f64>(), from_s, to_s))
    };
    let most = (1..=RUNS.min(all.len())).rev();
    let best = |count| all.windows(count).filter_map(span).max_by(|a, b| a.0.total_cmp(&b.0));
    most.filter_map(best).next().map(|(_, from_s, to_s)| (from_s, to_s))
}
