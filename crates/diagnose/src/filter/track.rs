//! A model's filter along a whole recording, and forecasts from any reading.

use crate::filter::ekf::{Ekf, FilteredStep, PropagationCache, Segment, Smoothed, SmootherMemory, smoothed};
use crate::filter::innovation::Innovation;
use crate::filter::run::run_filter;
use crate::filter::tachometer;
use crate::record::recording::Recording;
use plant::Model;
use std::ops::Range;

/// A model's filter along a recording, with its state after each reading.
#[derive(Debug)]
pub(crate) struct Track<'a> {
    model: &'a Model,
    recording: &'a Recording,
    /// Rows that hold a reading, and the filter after each.
    estimates: Vec<(usize, Ekf<'a>)>,
    /// The innovation of every reading but the first.
    innovations: Vec<Innovation>,
    /// Whether each row holds a reading that is no repeat.
    new: Vec<bool>,
    variances: Variances,
}

/// Whether forecasts have variances, which take most of their time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variances {
    /// They have.
    Computed,
    /// They have none.
    Omitted,
}

/// A model's forecast of a later reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// The row of the reading.
    pub row: usize,
    /// Expected reading, mm.
    pub position_mm: f64,
    /// Its variance by the model's noise, including the reading's own, mm²; `None`: it was not asked for.
    pub variance_mm2: Option<f64>,
}

/// The innovation of every reading but the first, which has no prediction; then of every reading of a second sensor,
/// and of every fan speed, in rpm instead of mm.
#[must_use]
pub(crate) fn innovations(model: &Model, recording: &Recording) -> Vec<Innovation> {
    let mut all = Vec::with_capacity(recording.readings());
    let mut second = Vec::new();
    run_filter(model, recording, None, Some(&mut second), |_, innovation, _| all.push(innovation));
    if !all.is_empty() {
        all.remove(0);
    }
    all.extend(second);
    all.extend(tachometer::innovations(model, recording));
    all
}

/// The expected reading of each row, mm; `None` where there is no reading, or the model takes it for a repeat.
pub(crate) fn expected_mm(model: &Model, recording: &Recording) -> Vec<Option<f64>> {
    let mut all = vec![None; recording.samples().len()];
    run_filter(model, recording, None, None, |row, innovation, ekf| all[row] = ekf.map(|_| innovation.expected_mm));
    all
}

/// The innovation of each reading, and the segment of the filter up to it.
pub(crate) fn segments(model: &Model, recording: &Recording) -> Vec<(Innovation, Segment)> {
    let mut all = Vec::with_capacity(recording.readings());
    run_filter(model, recording, Some(SmootherMemory::default()), None, |_, innovation, ekf| {
        all.extend(ekf.and_then(Ekf::leg).map(|leg| (innovation, leg)));
    });
    all
}

/// The row of each reading, and the smoothed state there, from the whole flight.
pub(crate) fn smoothed_states(model: &Model, recording: &Recording) -> Vec<(usize, Smoothed)> {
    let (mut rows, mut traces) = (Vec::new(), Vec::<FilteredStep>::new());
    run_filter(model, recording, Some(SmootherMemory::default()), None, |row, _, ekf| {
        if let Some(trace) = ekf.and_then(Ekf::trace) {
            rows.push(row);
            traces.push(trace);
        }
    });
    let flights = recording.flights().iter();
    let of = |flight: &Range<usize>| {
        rows.partition_point(|row| *row < flight.start)..rows.partition_point(|row| *row < flight.end)
    };
    let known = flights.flat_map(|flight| {
        let own = of(flight);
        rows[own.clone()].iter().copied().zip(smoothed(model, &traces[own])).collect::<Vec<_>>()
    });
    known.collect()
}

impl<'a> Track<'a> {
    /// Runs the filter of `model` over `recording`.
    #[must_use]
    pub(crate) fn new(model: &'a Model, recording: &'a Recording) -> Self {
        let (mut estimates, mut innovations) = (Vec::new(), Vec::new());
        let mut new = vec![false; recording.samples().len()];
        run_filter(model, recording, None, None, |row, innovation, ekf| {
            let Some(ekf) = ekf else { return };
            new[row] = true;
            if !estimates.is_empty() {
                innovations.push(innovation);
            }
            estimates.push((row, ekf.clone()));
        });
        Self { model, recording, estimates, innovations, new, variances: Variances::Computed }
    }

    /// The same, with or without variances of its forecasts.
    #[must_use]
    pub(crate) fn with(variances: Variances, model: &'a Model, recording: &'a Recording) -> Self {
        Self { variances, ..Self::new(model, recording) }
    }

    /// The recording.
    pub(crate) const fn recording(&self) -> &'a Recording {
        self.recording
    }

    /// The innovation of every reading but the first.
    #[must_use]
    pub(crate) fn into_innovations(self) -> Vec<Innovation> {
        self.innovations
    }

    /// The filtered state after each reading but the last: its row, position and velocity.
    pub(crate) fn states(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let known = self.estimates.iter().take(self.estimates.len().saturating_sub(1));
        known.map(|(row, ekf)| {
            let (position_mm, velocity) = ekf.position_and_velocity();
            (*row, position_mm, velocity)
        })
    }

    /// Number of readings of the recording that are no repeats.
    #[must_use]
    pub(crate) fn readings(&self) -> usize {
        self.estimates.len()
    }

    /// The row, time and position of reading number `reading`.
    #[must_use]
    pub(crate) fn reading(&self, reading: usize) -> Option<(usize, f64, f64)> {
        let &(row, _) = self.estimates.get(reading)?;
        let sample = self.recording.samples().get(row)?;
        Some((row, sample.time_s, sample.position_mm?))
    }

    /// Forecasts every later reading of the same flight from the state after reading number `from`, with the recorded
    /// duty.
    pub(crate) fn forecasts(&self, from: usize) -> impl Iterator<Item = Forecast> {
        let start = self.estimates.get(from);
        let mut row = start.map_or(self.new.len(), |(row, _)| *row);
        let flight = self.recording.flight_of(row);
        let has_variances = self.variances == Variances::Computed;
        let filter = |ekf: Ekf<'a>| if has_variances { ekf } else { ekf.of_mean_alone() };
        let mut ekf = start.map(|(_, ekf)| filter(ekf.clone()));
        let mut steps = PropagationCache::of(self.model);
        std::iter::from_fn(move || {
            let ekf = ekf.as_mut()?;
            loop {
                row += 1;
                if *self.new[..flight.end].get(row)? {
                    ekf.advance_to_row(row - flight.start, &mut steps);
                    let variance_mm2 = has_variances.then(|| ekf.rounded_reading_mm2());
                    return Some(Forecast { row, position_mm: ekf.expected_reading_mm(), variance_mm2 });
                }
            }
        })
    }
}

#[cfg(test)]
mod tests;
