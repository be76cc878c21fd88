//! Experiments: what a flight does over time, as a file that `run` and `simulate` both fly.
//!
//! ```toml
//! title = "Square wave with an excitation"
//!
//! [limits]                                   # leaving the band turns the fan off
//! position_min_mm = 20.0
//! position_max_mm = 560.0
//!
//! [[segment]]                                # closed loop: the controller follows the setpoint
//! duration_s = 60.0
//! setpoint_mm.square = { low = 200.0, high = 400.0, period_s = 20.0 }
//! excitation_percent.prbs = { low = -0.3, high = 0.3, bit_s = 0.2, order = 7 }
//!
//! [[segment]]                                # open loop: the fan follows the duty
//! duration_s = 5.0
//! duty_percent.constant = { value = 21.4 }
//! ```
//!
//! The flight ends, with the fan off, after the last segment. Waveforms: see [`control::waveform`].

use crate::config::{ConfigError, Reference, Safety, parse_file};
use control::OutOfRange;
use control::check::within;
use control::waveform::Waveform;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The largest excitation that may be added to the control value, percent of duty.
const MAX_EXCITATION_PERCENT: f64 = 20.0;
/// No pipe is longer, mm.
const LONGEST_PIPE_MM: f64 = 2000.0;

/// What a flight does over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// What it is for, in a line.
    pub title: String,
    /// Where the ball may be.
    #[serde(default)]
    pub limits: Limits,
    /// What happens, one after another.
    #[serde(rename = "segment")]
    pub segments: Vec<Segment>,
}

/// The band that the ball must not leave once it has been inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Lower end, mm.
    pub position_min_mm: Option<f64>,
    /// Upper end, mm.
    pub position_max_mm: Option<f64>,
}

/// One stretch of an experiment: a setpoint, or a duty without control.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// How long it lasts, seconds. Only the reference of a config lasts for ever (`inf`).
    pub duration_s: f64,
    /// Setpoint over the segment's own time, mm.
    #[serde(default)]
    pub setpoint_mm: Option<Waveform>,
    /// Added to the control value, percent of duty.
    #[serde(default)]
    pub excitation_percent: Option<Waveform>,
    /// Duty without control, percent.
    #[serde(default)]
    pub duty_percent: Option<Waveform>,
}

/// What is demanded at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Hold a position.
    Control {
        /// Setpoint, mm.
        setpoint_mm: f64,
        /// Added to the control value, percent of duty.
        excitation_percent: f64,
    },
    /// Drive the fan.
    Drive {
        /// Duty, percent.
        duty_percent: f64,
    },
}

impl Experiment {
    /// Reads and checks an experiment against the safety limits of the rig.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn read(path: &Path, safety: &Safety) -> Result<Self, ConfigError> {
        let (experiment, place) = parse_file::<Self>(path, "--experiment FILE")?;
        experiment.check(safety).map_err(|(key, problem)| match problem {
            Problem::Range(error) => {
                ConfigError::Range { place: place(&format!("{key}.{}", error.key)), table: key, error }
            }
            Problem::Message(message) => ConfigError::Contradiction { place: place(&key), message: message.into() },
        })?;
        Ok(experiment)
    }

    /// The config's reference as an experiment without end.
    #[must_use]
    pub fn of_reference(reference: &Reference) -> Self {
        let segment = Segment {
            duration_s: f64::INFINITY,
            setpoint_mm: Some(reference.setpoint_mm.clone()),
            excitation_percent: None,
            duty_percent: None,
        };
        Self { title: "reference of the config".into(), limits: Limits::default(), segments: vec![segment] }
    }

    /// How long it lasts, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.segments.iter().map(|segment| segment.duration_s).sum()
    }

    /// What is demanded `t_s` seconds after the start. `None` when it is over.
    #[must_use]
    pub fn demand(&self, t_s: f64) -> Option<Demand> {
        let mut start_s = 0.0;
        for segment in &self.segments {
            if t_s < start_s + segment.duration_s {
                return Some(segment.demand(t_s - start_s));
            }
            start_s += segment.duration_s;
        }
        None
    }

    /// The band's end that `position_mm` is beyond, as lower and upper end.
    #[must_use]
    pub fn outside_band(&self, position_mm: f64) -> Option<(f64, f64)> {
        let min = self.limits.position_min_mm.unwrap_or(f64::NEG_INFINITY);
        let max = self.limits.position_max_mm.unwrap_or(f64::INFINITY);
        (position_mm < min || position_mm > max).then_some((min, max))
    }

    fn check(&self, safety: &Safety) -> Result<(), (String, Problem)> {
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

/// What is wrong with a segment.
enum Problem {
    Range(OutOfRange),
    Message(&'static str),
}

impl Segment {
    fn demand(&self, t_s: f64) -> Demand {
        let value = |wave: &Option<Waveform>| wave.as_ref().map_or(0.0, |wave| wave.value(t_s));
        match &self.duty_percent {
            Some(duty) => Demand::Drive { duty_percent: duty.value(t_s) },
            None => Demand::Control {
                setpoint_mm: value(&self.setpoint_mm),
                excitation_percent: value(&self.excitation_percent),
            },
        }
    }

    fn check(&self, safety: &Safety) -> Result<(), (String, Problem)> {
        let at = |key: &str| {
            let key = key.to_owned();
            move |error| (key, Problem::Range(error))
        };
        let both = |message| Err((String::new(), Problem::Message(message)));
        within("duration_s", self.duration_s, 1e-3, 1e6).map_err(at(""))?;
        match (&self.setpoint_mm, &self.duty_percent) {
            (Some(setpoint), None) => {
                setpoint.check(safety.setpoint_min_mm, safety.setpoint_max_mm).map_err(at(".setpoint_mm"))?;
            }
            (None, Some(duty)) => {
                duty.check(0.0, safety.duty_max_percent).map_err(at(".duty_percent"))?;
            }
            _ => return both("a segment has either setpoint_mm or duty_percent; add one or remove the other"),
        }
        match &self.excitation_percent {
            Some(_) if self.duty_percent.is_some() => {
                both("excitation_percent adds to the controller, which is off here; put it into duty_percent")
            }
            Some(wave) => {
                wave.check(-MAX_EXCITATION_PERCENT, MAX_EXCITATION_PERCENT).map_err(at(".excitation_percent"))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Demand, Experiment};
    use crate::config::Safety;

    const SAFETY: Safety = Safety {
        setpoint_min_mm: 20.0,
        setpoint_max_mm: 560.0,
        duty_min_percent: 0.0,
        duty_max_percent: 40.0,
        coast_s: 0.5,
        stall_s: 0.5,
        stuck: None,
    };

    fn read(text: &str) -> Result<Experiment, String> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("e.toml");
        std::fs::write(&path, text).unwrap();
        let place = format!("{}/", directory.path().display());
        Experiment::read(&path, &SAFETY).map_err(|error| error.to_string().replace(&place, ""))
    }

    const TWO: &str = "title = \"t\"\n[limits]\nposition_max_mm = 550.0\n\
        [[segment]]\nduration_s = 10.0\nsetpoint_mm.constant = { value = 300.0 }\n\
        excitation_percent.square = { low = -0.5, high = 0.5, period_s = 2.0 }\n\
        [[segment]]\nduration_s = 5.0\nduty_percent.ramp = { from = 20.0, to = 25.0, over_s = 5.0 }\n";

    #[test]
    fn segments_follow_each_other_on_their_own_time_and_end() {
        let experiment = read(TWO).unwrap();
        assert_eq!(experiment.duration_s(), 15.0);
        let control = |excitation_percent| Some(Demand::Control { setpoint_mm: 300.0, excitation_percent });
        assert_eq!(experiment.demand(0.5), control(0.5));
        assert_eq!(experiment.demand(9.5), control(-0.5));
        assert_eq!(experiment.demand(12.0), Some(Demand::Drive { duty_percent: 22.0 }));
        assert_eq!(experiment.demand(15.0), None);
    }

    #[test]
    fn the_band_holds_only_where_it_has_an_end() {
        let experiment = read(TWO).unwrap();
        assert!(experiment.outside_band(-100.0).is_none());
        assert!(experiment.outside_band(551.0).is_some());
    }

    #[test]
    fn limits_that_could_not_hold_are_refused() {
        let message = read(&TWO.replace("position_max_mm = 550.0", "position_max_mm = nan")).unwrap_err();
        assert!(message.starts_with("e.toml:3: limits.position_max_mm = NaN"), "{message}");
        let crossed = "position_max_mm = 100.0\nposition_min_mm = 300.0";
        let message = read(&TWO.replace("position_max_mm = 550.0", crossed)).unwrap_err();
        assert!(message.contains("limits.position_max_mm = 100 is outside 300 to 2000"), "{message}");
    }

    #[test]
    fn a_setpoint_outside_the_safe_band_is_refused_with_its_line() {
        let message = read(&TWO.replace("300.0", "700.0")).unwrap_err();
        assert!(message.starts_with("e.toml:6: segment[0].setpoint_mm.constant.value = 700"), "{message}");
        assert!(message.contains("20 to 560"), "{message}");
    }

    #[test]
    fn a_duty_above_the_safe_one_is_refused() {
        let message = read(&TWO.replace("to = 25.0", "to = 55.0")).unwrap_err();
        assert!(message.starts_with("e.toml:10: segment[1].duty_percent.ramp.to = 55 is outside 0 to 40"), "{message}");
    }

    #[test]
    fn a_segment_that_controls_and_drives_at_once_is_refused() {
        let message = read(&TWO.replace("excitation_percent.square", "duty_percent.square")).unwrap_err();
        assert!(message.contains("either setpoint_mm or duty_percent"), "{message}");
        let message = read("title = \"t\"\nsegment = []\n").unwrap_err();
        assert!(message.contains("no [[segment]]"), "{message}");
    }

    #[test]
    fn an_unknown_waveform_is_refused_with_the_known_ones() {
        let message = read(&TWO.replace("setpoint_mm.constant", "setpoint_mm.const")).unwrap_err();
        assert!(message.contains("unknown variant `const`") && message.contains("`chirp`"), "{message}");
    }
}
