//! Stretches of a recording with constant duty and without controller.

use crate::record::recording::{Recording, Sample};

/// Readings during one constant duty.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hold {
    /// The duty, percent.
    pub(super) duty_percent: f64,
    /// When it was written, seconds.
    pub(super) start_s: f64,
    /// When it was replaced, or the record ended, seconds.
    pub(super) end_s: f64,
    /// Time in s and position in mm, the first at the start, the last at the end.
    pub(super) readings: Vec<(f64, f64)>,
}

/// All holds in order of time. The reading at which the next duty is written belongs to the previous hold as well.
pub(super) fn holds(recording: &Recording) -> Vec<Hold> {
    recording.flights().iter().flat_map(|flight| of_flight(&recording.samples()[flight.clone()])).collect()
}

fn of_flight(rows: &[Sample]) -> Vec<Hold> {
    let mut holds: Vec<Hold> = Vec::new();
    let mut open: Option<Hold> = None;
    for row in rows {
        let reading = row.position_mm.map(|mm| (row.time_s, mm));
        let goes_on = |hold: &Hold| row.setpoint_mm.is_none() && hold.duty_percent == row.duty_percent;
        if let Some(hold) = &mut open {
            hold.readings.extend(reading);
            hold.end_s = row.time_s;
        }
        if !open.as_ref().is_some_and(goes_on) {
            holds.extend(open.take());
            if row.setpoint_mm.is_none() {
                let (start_s, end_s) = (row.time_s, row.time_s);
                let readings = reading.into_iter().collect();
                open = Some(Hold { duty_percent: row.duty_percent, start_s, end_s, readings });
            }
        }
    }
    holds.extend(open);
    holds
}

impl Hold {
    /// Duration, seconds.
    pub(super) fn duration_s(&self) -> f64 {
        self.end_s - self.start_s
    }

    /// The readings after the first `seconds`.
    pub(super) fn after(&self, seconds: f64) -> &[(f64, f64)] {
        let first = self.readings.partition_point(|(time_s, _)| *time_s < self.start_s + seconds);
        &self.readings[first..]
    }
}
