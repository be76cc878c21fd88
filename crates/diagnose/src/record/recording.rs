//! A recording: time, duty and position of a rig in rows, whoever recorded it.
//!
//! It may hold several flights of one rig. Their rows share one count of rows and of time; what has a state, such as a
//! filter or a drift, is reset at the start of each flight.

pub use crate::record::error::RecordingError;

use crate::record::known::Known;
use crate::record::quantisation::KnownStep;
use crate::record::second_sensor::Second;
use std::ops::Range;

/// One row. The position was read at `time_s`; the duty was written in response and held until the next row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Seconds since any fixed start.
    pub time_s: f64,
    /// Setpoint of the position, millimetres, where the log has it.
    pub setpoint_mm: Option<f64>,
    /// Output of the controller, percent of duty about hover, where the log has it.
    pub control_percent: Option<f64>,
    /// Duty from this row to the next, percent. For another rig any number is allowed.
    pub duty_percent: f64,
    /// Position of the ball, millimetres, upward. `None`: the sensor gave no new reading in this row.
    pub position_mm: Option<f64>,
    /// Speed of the fan, revolutions per minute, where the log has it.
    pub fan_rpm: Option<f64>,
    /// Position of the ball by a second sensor, millimetres, upward, where the log has it.
    pub position2_mm: Option<f64>,
}

/// A duty, when it was written, and the setpoint of that row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Write {
    pub(crate) time_s: f64,
    pub(crate) duty_percent: f64,
    pub(crate) setpoint_mm: Option<f64>,
}

/// Rows in order of time, checked; of one flight, or of several flights of one rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    samples: Vec<Sample>,
    /// The rows of each flight.
    flights: Vec<Range<usize>>,
    /// Number of readings in each mean, by flight.
    means_of: Vec<usize>,
    /// The duty of each row and the rows that hold a reading, stored separately for speed: filters pass over them
    /// thousands of times, and no cache holds all columns of a long record.
    writes: Vec<Write>,
    readings: Vec<usize>,
    has_fan_speed: bool,
    resolution_mm: f64,
    file_resolution_mm: f64,
    /// Smallest and largest duty, percent, and position, mm.
    duty_range: [f64; 2],
    height_range: [f64; 2],
    second: Option<Second>,
    known_step: KnownStep,
    known_speed: Known<f64>,
}

impl Recording {
    /// Longest time between two rows, seconds.
    pub const LONGEST_HOLE_S: f64 = 60.0;
    /// Fewest readings that a recording may have.
    pub const MIN_READINGS: usize = 20;

    /// Checks the rows: finite numbers, time that never goes backwards, enough readings.
    ///
    /// # Errors
    /// [`RecordingError`] names the first row that is wrong.
    pub fn new(samples: Vec<Sample>) -> Result<Self, RecordingError> {
        let mut last_s = f64::NEG_INFINITY;
        for (index, sample) in samples.iter().enumerate() {
            let row = index + 1;
            let numbers = [
                ("time_s", sample.time_s),
                ("duty_percent", sample.duty_percent),
                ("position_mm", sample.position_mm.unwrap_or_default()),
                ("fan_rpm", sample.fan_rpm.unwrap_or_default()),
                ("position2_mm", sample.position2_mm.unwrap_or_default()),
            ];
            for (quantity, value) in numbers {
                if !value.is_finite() {
                    return Err(RecordingError::NotFinite { row, quantity, value });
                }
            }
            if sample.time_s < last_s {
                return Err(RecordingError::TimeBackwards { row, from_s: last_s, to_s: sample.time_s });
            }
            if last_s.is_finite() && sample.time_s - last_s > Self::LONGEST_HOLE_S {
                let [from_s, to_s] = [last_s, sample.time_s].map(|time_s| time_s - samples[0].time_s);
                return Err(RecordingError::Hole { row, from_s, to_s });
            }
            last_s = sample.time_s;
        }
        let readings = samples.iter().filter(|s| s.position_mm.is_some()).count();
        match (samples.is_empty(), readings < Self::MIN_READINGS) {
            (true, _) => Err(RecordingError::Empty),
            (_, true) => Err(RecordingError::TooShort { readings, needed: Self::MIN_READINGS }),
            _ if samples[0].time_s == last_s => Err(RecordingError::NoTime { time_s: last_s }),
            _ => Ok(Self::of_one(samples)),
        }
    }

    fn of_one(samples: Vec<Sample>) -> Self {
        let all = 0..samples.len();
        Self {
            writes: writes(&samples),
            readings: (0..samples.len()).filter(|row| samples[*row].position_mm.is_some()).collect(),
            has_fan_speed: samples.iter().any(|sample| sample.fan_rpm.is_some()),
            resolution_mm: resolution(&samples),
            file_resolution_mm: file_resolution(&samples),
            duty_range: range(samples.iter().map(|sample| sample.duty_percent)),
            height_range: range(samples.iter().filter_map(|sample| sample.position_mm)),
            second: Second::of(&samples),
            flights: std::iter::once(all).collect(),
            means_of: vec![1],
            known_step: KnownStep::default(),
            known_speed: Known::default(),
            samples,
        }
    }

    /// The same flight, where each reading is the mean of `count` readings.
    #[must_use]
    pub(crate) fn of_means(self, count: usize) -> Self {
        Self { means_of: vec![count.max(1); self.flights.len()], ..self }
    }

    /// The number of readings of which the one in `row` is the mean.
    pub(crate) fn mean_of(&self, row: usize) -> usize {
        let number = self.flights.partition_point(|flight| flight.end <= row);
        self.means_of.get(number).copied().unwrap_or(1)
    }

    /// Several flights of one rig as one recording. Each is placed after the previous one by whole seconds, so that its
    /// time steps do not change. An empty list gives a recording without rows.
    #[must_use]
    pub fn together(recordings: impl IntoIterator<Item = Self>) -> Self {
        let mut recordings = recordings.into_iter();
        let first = recordings.next().unwrap_or_else(|| Self::of_one(Vec::new()));
        let Some(second) = recordings.next() else { return first };
        let Self { mut samples, mut flights, mut means_of, mut resolution_mm, .. } = first;
        for next in std::iter::once(second).chain(recordings) {
            let end_s = samples.last().map_or(0.0, |last| last.time_s);
            let start_s = next.samples.first().map_or(0.0, |first| first.time_s);
            let (rows, later_s) = (samples.len(), (end_s - start_s).floor() + 1.0);
            samples.extend(next.samples.iter().map(|row| Sample { time_s: row.time_s + later_s, ..*row }));
            flights.extend(next.flights.iter().map(|flight| flight.start + rows..flight.end + rows));
            means_of.extend(next.means_of);
            resolution_mm = resolution_mm.min(next.resolution_mm);
        }
        Self { flights, means_of, resolution_mm, ..Self::of_one(samples) }
    }

    /// The rows.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The duty of each row.
    pub(crate) fn writes(&self) -> &[Write] {
        &self.writes
    }

    /// The rows of each flight, one after another.
    #[must_use]
    pub fn flights(&self) -> &[Range<usize>] {
        &self.flights
    }

    /// The rows of the flight that `row` belongs to; for a row that does not exist, those of the last flight.
    #[must_use]
    pub fn flight_of(&self, row: usize) -> Range<usize> {
        let number = self.flights.partition_point(|flight| flight.end <= row);
        self.flights.get(number).or(self.flights.last()).cloned().unwrap_or_default()
    }

    /// Whether any row holds the speed of the fan.
    #[must_use]
    pub const fn has_fan_speed(&self) -> bool {
        self.has_fan_speed
    }

    /// Whether any row holds a reading of a second sensor.
    #[must_use]
    pub fn has_second_position(&self) -> bool {
        self.samples.iter().any(|sample| sample.position2_mm.is_some())
    }

    /// Number of rows that hold a reading.
    #[must_use]
    pub const fn readings(&self) -> usize {
        self.readings.len()
    }

    /// The rows of a flight that hold a reading.
    pub(crate) fn readings_of(&self, flight: &Range<usize>) -> &[usize] {
        let before = |end: usize| self.readings.partition_point(|row| *row < end);
        &self.readings[before(flight.start)..before(flight.end)]
    }

    /// Mean time from one reading of a flight to the next, seconds.
    pub(crate) fn reading_period_s(&self, flight: &Range<usize>) -> f64 {
        let readings = self.readings_of(flight);
        let ends = readings.first().zip(readings.last());
        let span_s = ends.map_or(0.0, |(first, last)| self.samples[*last].time_s - self.samples[*first].time_s);
        span_s / readings.len().saturating_sub(1).max(1) as f64
    }

    /// Mean time from one reading of all flights to the next, seconds.
    pub(crate) fn mean_reading_period_s(&self) -> f64 {
        self.duration_s() / self.readings().max(1) as f64
    }

    /// The smallest difference between two successive readings, mm.
    #[must_use]
    pub const fn resolution_mm(&self) -> f64 {
        self.resolution_mm
    }

    /// The resolution of the file, mm: the coarsest of 1, 0.5, 0.25, 0.1 and 0.05 of which every reading is a multiple,
    /// else 0.01. A coarse sensor has larger steps.
    pub(crate) const fn file_resolution_mm(&self) -> f64 {
        self.file_resolution_mm
    }

    /// Standard deviation of the rounding of the readings to the smallest difference between them: step/√12, mm.
    #[must_use]
    pub fn rounding_mm(&self) -> f64 {
        self.resolution_mm() / 12f64.sqrt()
    }

    /// The smallest and the largest duty, percent.
    #[must_use]
    pub const fn duty_range(&self) -> [f64; 2] {
        self.duty_range
    }

    /// The lowest and the highest position, mm.
    #[must_use]
    pub const fn height_range(&self) -> [f64; 2] {
        self.height_range
    }

    /// The second sensor, where there is one.
    pub(crate) const fn second(&self) -> Option<Second> {
        self.second
    }

    /// The step of a quantised sensor, once it was asked for.
    pub(crate) const fn known_step(&self) -> &KnownStep {
        &self.known_step
    }

    /// The usual speed, once it was asked for.
    pub(crate) const fn known_speed(&self) -> &Known<f64> {
        &self.known_speed
    }

    /// Whether a row has a setpoint.
    #[must_use]
    pub fn has_setpoint(&self) -> bool {
        self.writes.iter().any(|write| write.setpoint_mm.is_some())
    }

    /// Time from the first row to the last, seconds; for several flights, the sum.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.flights.iter().map(|flight| duration_s(&self.samples[flight.clone()])).sum()
    }
}

/// One recording can be used where several are expected.
impl AsRef<[Self]> for Recording {
    fn as_ref(&self) -> &[Self] {
        std::slice::from_ref(self)
    }
}

/// Time from the first row of a flight to its last, seconds.
pub(crate) fn duration_s(flight: &[Sample]) -> f64 {
    match flight {
        [first, .., last] => last.time_s - first.time_s,
        _ => 0.0,
    }
}

fn writes(samples: &[Sample]) -> Vec<Write> {
    let write = |row: &Sample| Write {
        time_s: row.time_s,
        duty_percent: row.duty_percent,
        setpoint_mm: row.setpoint_mm.filter(|setpoint_mm| setpoint_mm.is_finite()),
    };
    samples.iter().map(write).collect()
}

/// The smallest and the largest of some values.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

fn resolution(samples: &[Sample]) -> f64 {
    let readings: Vec<f64> = samples.iter().filter_map(|sample| sample.position_mm).collect();
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 1e-6);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 1.0 }
}

fn file_resolution(samples: &[Sample]) -> f64 {
    let readings: Vec<f64> = samples.iter().filter_map(|sample| sample.position_mm).collect();
    let holds = |r: &&f64| readings.iter().all(|y| (y / **r - (y / **r).round()).abs() < 1e-4);
    [1.0, 0.5, 0.25, 0.1, 0.05].iter().find(holds).copied().unwrap_or(0.01)
}

#[cfg(test)]
mod tests;
