//! Runs a model's filter along a recording, reading by reading.

use crate::filter::ekf::{Ekf, PropagationCache, SmootherMemory};
use crate::filter::innovation::{Innovation, Reading};
use crate::filter::refresh::Refresh;
use crate::record::quantisation::{Grid, OFF_GRID};
use crate::record::recording::{Recording, Sample};
use crate::record::second_sensor::Second;
use crate::stats::log_sum::log_sum;
use plant::Model;

/// Runs the filter of `model` over `recording` and calls `show` after each reading with the row, its innovation, and
/// the filter, or no filter where the model takes the reading for a repeat. Each flight starts with a new filter. With
/// `back`, the filter keeps what the smoother needs. With `second`, it also uses the readings of a second sensor and
/// appends their innovations.
pub(crate) fn run_filter<'a>(
    model: &'a Model,
    recording: &'a Recording,
    back: Option<SmootherMemory>,
    second: Option<&mut Vec<Innovation>>,
    mut show: impl FnMut(usize, Innovation, Option<&Ekf<'a>>),
) {
    let mut steps = PropagationCache::of(model);
    let mut beside = second.and_then(|seen| Some(Beside { sensor: recording.second()?, next: 0, seen }));
    let grid = model.effects.reading_step_mm().map(|step_mm| Grid::of(recording, step_mm));
    // New and repeated readings need one unit of density: coarse readings differ by more than the file's resolution.
    let resolution_mm = recording.resolution_mm().min(recording.file_resolution_mm());
    let outliers = model.effects.outliers().map(|o| (o.probability, o.size_mm));
    for flight in recording.flights() {
        let (rows, writes) = (&recording.samples()[flight.clone()], &recording.writes()[flight.clone()]);
        let mut filter: Option<Ekf<'a>> = None;
        let mut refresh: Option<Refresh> = None;
        for &row in recording.readings_of(flight) {
            let at = row - flight.start;
            let (sample, Some(reading)) = (&rows[at], rows[at].position_mm) else { continue };
            let coarse = grid.as_ref().and_then(|grid| grid.cell(reading));
            let seen = Reading { row, position_mm: reading, outliers, coarse };
            let off_grid = if grid.is_some() && coarse.is_none() { OFF_GRID } else { 0.0 };
            let Some(ekf) = &mut filter else {
                let new = Ekf::new(model, writes, at, reading, &mut steps);
                let ekf = filter.insert(new.of_means(recording.mean_of(row)).remembering(back));
                refresh = Refresh::of(model, recording.reading_period_s(flight), sample.time_s, reading);
                show(row, ekf.take(seen), Some(ekf));
                beside.iter_mut().for_each(|beside| beside.next = row);
                continue;
            };
            if let Some(beside) = &mut beside {
                beside.up_to(ekf.time_of(at), flight.start, rows, ekf, &mut steps);
            }
            ekf.advance_to_row(at, &mut steps);
            let (new, log_density) = arrival(refresh.as_ref(), sample.time_s, reading, resolution_mm, || {
                ekf.predict(seen).log_density - off_grid
            });
            if let Some(refresh) = &mut refresh {
                refresh.go_on(sample.time_s, reading, new);
            }
            if new {
                let innovation = ekf.take(seen);
                let log_density = log_density.unwrap_or(innovation.log_density - off_grid);
                show(row, Innovation { log_density, ..innovation }, Some(ekf));
            } else {
                show(row, Innovation::of_repeat(row, log_density.unwrap_or_default()), None);
            }
        }
        if let Some((beside, ekf)) = beside.as_mut().zip(filter.as_mut()) {
            beside.up_to(f64::INFINITY, flight.start, rows, ekf, &mut steps);
        }
    }
}

/// The readings of a second sensor during a run.
struct Beside<'s> {
    sensor: Second,
    /// The row of the next reading.
    next: usize,
    seen: &'s mut Vec<Innovation>,
}

impl Beside<'_> {
    /// Updates the filter by a flight's readings up to `until_s`: a reading of a delayed first sensor belongs to an
    /// earlier time than one of the second in the same row.
    fn up_to(&mut self, until_s: f64, start: usize, rows: &[Sample], ekf: &mut Ekf<'_>, steps: &mut PropagationCache) {
        let start_s = rows.first().map_or(0.0, |first| first.time_s);
        while let Some(sample) = rows.get(self.next - start).filter(|sample| sample.time_s - start_s <= until_s) {
            if let Some(second_mm) = sample.position2_mm {
                let position_mm = second_mm - self.sensor.offset_mm;
                let reading = Reading { row: self.next, position_mm, outliers: None, coarse: None };
                let time_s = sample.time_s - start_s;
                self.seen.push(ekf.update_by_second_sensor(time_s, reading, self.sensor.variance_mm2, steps));
            }
            self.next += 1;
        }
    }
}

/// Whether a reading is new, and ln p of it where the sensor may have repeated its last one.
fn arrival(
    refresh: Option<&Refresh>,
    time_s: f64,
    reading_mm: f64,
    resolution_mm: f64,
    if_new: impl Fn() -> f64,
) -> (bool, Option<f64>) {
    let Some(refresh) = refresh else { return (true, None) };
    let chance = refresh.chance(time_s);
    let new = || chance.ln() + if_new();
    if !refresh.is_same(reading_mm) {
        return (true, Some(new()));
    }
    let repeat = (1.0 - chance).ln() - resolution_mm.ln();
    if refresh.is_overdue(time_s) { (true, Some(log_sum(new(), repeat))) } else { (false, Some(repeat)) }
}
