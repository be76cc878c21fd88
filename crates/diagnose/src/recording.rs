//! A recording: what a rig did, as rows of time, duty and position, whoever recorded it.

/// One row. The position was read at `time_s`; the duty was written in response and held until the next row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Seconds since any fixed start.
    pub time_s: f64,
    /// Commanded position, millimetres, where the log has it.
    pub setpoint_mm: Option<f64>,
    /// What the controller asked for, percent of duty about hover, where the log has it.
    pub control_percent: Option<f64>,
    /// Duty from this row to the next, percent. Another rig's may be any number.
    pub duty_percent: f64,
    /// Position of the ball, millimetres, upward. `None`: the sensor gave nothing new in this row.
    pub position_mm: Option<f64>,
}

/// Rows in the order of time, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    samples: Vec<Sample>,
    resolution_mm: f64,
}

/// Why rows are no recording. Row numbers count from 1 at the first row of data.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Nothing in it.
    #[error("it has no rows of data; record a flight with `airball simulate` or `airball run`")]
    Empty,
    /// Too few readings to say anything.
    #[error("it has {readings} readings, too few to compare with a model; at least {needed} are needed")]
    TooShort {
        /// Readings found.
        readings: usize,
        /// Readings needed.
        needed: usize,
    },
    /// Time went backwards.
    #[error("time goes backwards at row {row}, from {from_s} s to {to_s} s; sort the rows or cut the log there")]
    TimeBackwards {
        /// The offending row.
        row: usize,
        /// Time of the row before.
        from_s: f64,
        /// Time of the row.
        to_s: f64,
    },
    /// Time stands still.
    #[error("time is {time_s} s in every row; name the column of the time in [import] time_s")]
    NoTime {
        /// The time of every row.
        time_s: f64,
    },
    /// A hole that no forecast can cross.
    #[error(
        "no row for {} s before row {row}, from {from_s} s to {to_s} s; cut the log there, or, if time is not in \
         seconds, give its unit as [import] time_s.scale", to_s - from_s
    )]
    Hole {
        /// The row after the hole.
        row: usize,
        /// Time of the row before.
        from_s: f64,
        /// Time of the row.
        to_s: f64,
    },
    /// A number that is none.
    #[error("{quantity} at row {row} is {value}; remove the row or mend the recorder")]
    NotFinite {
        /// The offending row.
        row: usize,
        /// Which quantity.
        quantity: &'static str,
        /// What it is.
        value: f64,
    },
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
                return Err(RecordingError::Hole { row, from_s: last_s, to_s: sample.time_s });
            }
            last_s = sample.time_s;
        }
        let readings = samples.iter().filter(|s| s.position_mm.is_some()).count();
        match (samples.is_empty(), readings < Self::MIN_READINGS) {
            (true, _) => Err(RecordingError::Empty),
            (_, true) => Err(RecordingError::TooShort { readings, needed: Self::MIN_READINGS }),
            _ if samples[0].time_s == last_s => Err(RecordingError::NoTime { time_s: last_s }),
            _ => Ok(Self { resolution_mm: resolution(&samples), samples }),
        }
    }

    /// The rows.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The smallest step between two readings in a row, mm.
    #[must_use]
    pub const fn resolution_mm(&self) -> f64 {
        self.resolution_mm
    }

    /// From the first row to the last, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.samples.first(), self.samples.last()) {
            (Some(first), Some(last)) => last.time_s - first.time_s,
            _ => 0.0,
        }
    }
}

fn resolution(samples: &[Sample]) -> f64 {
    let readings: Vec<f64> = samples.iter().filter_map(|sample| sample.position_mm).collect();
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 1e-6);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::{Recording, RecordingError, Sample};

    fn rows(count: usize) -> Vec<Sample> {
        let row = Sample {
            time_s: 0.0,
            setpoint_mm: None,
            control_percent: None,
            duty_percent: 20.0,
            position_mm: Some(100.0),
        };
        (0..count).map(|k| Sample { time_s: 0.02 * k as f64, ..row }).collect()
    }

    #[test]
    fn good_rows_are_kept_as_they_are() {
        let recording = Recording::new(rows(50)).unwrap();
        assert_eq!(recording.samples(), rows(50));
        assert!((recording.duration_s() - 0.98).abs() < 1e-12);
    }

    #[test]
    fn the_first_wrong_row_is_named() {
        let mut backwards = rows(50);
        backwards[30].time_s = 0.1;
        let error = Recording::new(backwards).unwrap_err();
        assert_eq!(error, RecordingError::TimeBackwards { row: 31, from_s: 0.02 * 29.0, to_s: 0.1 });

        let mut not_a_number = rows(50);
        not_a_number[7].duty_percent = f64::NAN;
        let error = Recording::new(not_a_number).unwrap_err();
        assert!(matches!(error, RecordingError::NotFinite { row: 8, quantity: "duty_percent", .. }), "{error}");
    }

    #[test]
    fn time_that_stands_still_or_jumps_far_is_refused_with_the_unit_to_check() {
        let mut still = rows(50);
        still.iter_mut().for_each(|s| s.time_s = 3.0);
        assert_eq!(Recording::new(still).unwrap_err(), RecordingError::NoTime { time_s: 3.0 });
        let mut nanoseconds = rows(50);
        nanoseconds.iter_mut().for_each(|s| s.time_s *= 1e9);
        let error = Recording::new(nanoseconds).unwrap_err();
        assert!(matches!(error, RecordingError::Hole { row: 2, .. }) && error.to_string().contains("scale"), "{error}");
    }

    #[test]
    fn an_empty_and_a_silent_recording_are_told_apart() {
        assert_eq!(Recording::new(vec![]).unwrap_err(), RecordingError::Empty);
        let mut silent = rows(50);
        silent.iter_mut().skip(5).for_each(|s| s.position_mm = None);
        assert_eq!(Recording::new(silent).unwrap_err(), RecordingError::TooShort { readings: 5, needed: 20 });
    }
}
