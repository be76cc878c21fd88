//! Checks of an experiment: waveforms within the limits of the rig, and no contradictions.

use super::{Experiment, Segment};
use config::Safety;
use control::OutOfRange;
use control::check::within;
use control::pid::{DerivativeOn, Pid};

/// The largest excitation that may be added to the control value, percent of duty.
const MAX_EXCITATION_PERCENT: f64 = 20.0;
/// Longest pipe, mm.
const LONGEST_PIPE_MM: f64 = 2000.0;

/// An error of a segment.
pub(super) enum Problem {
    /// A number is outside its bounds.
    Range(OutOfRange),
    /// Keys contradict each other.
    Message(&'static str),
}

impl Experiment {
    /// Checks every number, and that each segment has exactly one kind of command.
    pub(super) fn check(&self, safety: &Safety) -> Result<(), (String, Problem)> {
        if self.segments.is_empty() {
            return Err(("segment".into(), Problem::Message("no [[segment]]: say what the flight shall do")));
        }
        let limit = |key, value: Option<f64>, min, max| value.map_or(Ok(()), |value| within(key, value, min, max));
        let lowest = self.limits.position_min_mm.unwrap_or(-LONGEST_PIPE_MM);
        limit("position_min_mm", self.limits.position_min_mm, -LONGEST_PIPE_MM, LONGEST_PIPE_MM)
            .and_then(|()| limit("position_max_mm", self.limits.position_max_mm, lowest, LONGEST_PIPE_MM))
            .map_err(|error| ("limits".to_owned(), Problem::Range(error)))?;
        self.segments.iter().enumerate().try_for_each(|(index, segment)| {
            segment.check(safety).map_err(|(key, problem)| (format!("segment[{index}]{key}"), problem))
        })
    }
}

impl Segment {
    fn check(&self, safety: &Safety) -> Result<(), (String, Problem)> {
        let at = |key: &str| {
            let key = key.to_owned();
            move |error| (key, Problem::Range(error))
        };
        let both = |message| Err((String::new(), Problem::Message(message)));
        within("duration_s", self.duration_s, 1e-3, 1e6).map_err(at(""))?;
        match (&self.setpoint_mm, &self.duty_percent, &self.duty_about_hover_percent) {
            (Some(setpoint), None, None) => {
                setpoint.check(safety.setpoint_min_mm, safety.setpoint_max_mm).map_err(at(".setpoint_mm"))?;
            }
            (None, Some(duty), None) => {
                duty.check(0.0, safety.duty_max_percent).map_err(at(".duty_percent"))?;
            }
            (None, None, Some(duty)) => {
                // Hover is defined by the config; the pilot keeps the sum within the safe duties.
                let reach = safety.duty_max_percent;
                duty.check(-reach, reach).map_err(at(".duty_about_hover_percent"))?;
            }
            _ => {
                return both(
                    "a segment has either setpoint_mm or duty_percent or duty_about_hover_percent; add one or remove the others",
                );
            }
        }
        if self.setpoint_mm.is_none() && (self.gains.is_some() || self.back_off_beyond_mm.is_some()) {
            return both("gains and back_off_beyond_mm need the controller, which is off here; remove them");
        }
        self.check_ends().map_err(at(""))?;
        match &self.excitation_percent {
            Some(_) if self.setpoint_mm.is_none() => {
                both("excitation_percent adds to the controller, which is off here; put it into duty_percent")
            }
            Some(wave) => {
                wave.check(-MAX_EXCITATION_PERCENT, MAX_EXCITATION_PERCENT).map_err(at(".excitation_percent"))
            }
            None => Ok(()),
        }
    }

    /// Checks the conditions that end the segment early, and its gains.
    fn check_ends(&self) -> Result<(), OutOfRange> {
        let limit = |key, value: Option<f64>, min| value.map_or(Ok(()), |mm| within(key, mm, min, LONGEST_PIPE_MM));
        limit("until_below_mm", self.until_below_mm, -LONGEST_PIPE_MM)?;
        limit("until_above_mm", self.until_above_mm, -LONGEST_PIPE_MM)?;
        limit("back_off_beyond_mm", self.back_off_beyond_mm, 1.0)?;
        let any = Pid::new(1.0, 1.0, 0.0, 10.0, DerivativeOn::Measurement);
        self.gains.map_or(Ok(()), |gains| gains.applied_to(any).check())
    }
}
