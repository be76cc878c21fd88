//! Experiments: the programme of a flight over time, as a file that `run` and `simulate` both fly.
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
//! [[segment]]                                # other gains of the PID; beyond back_off_beyond_mm: the last segment
//! duration_s = 9.0
//! setpoint_mm.constant = { value = 340.0 }
//! gains = { kp_per_mm = 0.03, td_s = 0.0 }
//! back_off_beyond_mm = 150.0
//!
//! [[segment]]                                # open loop: the fan follows the duty, here about hover
//! duration_s = 5.0
//! duty_about_hover_percent.constant = { value = 0.8 }
//! until_above_mm = 400.0
//! ```
//!
//! The flight ends, with the fan off, after the last segment. Waveforms: see [`control::waveform`].

mod check;
pub mod offers;
mod segments;

use super::command::GainChange;
use check::Problem;
use config::{ConfigError, Reference, Safety, parse_file, parse_text};
use control::waveform::Waveform;
pub use segments::Segments;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A time larger than rounding errors, seconds: a skip ends after a boundary, not at it.
const HAIR_S: f64 = 1e-9;

/// The programme of a flight over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Its purpose, in a line.
    pub title: String,
    /// Limits of the position.
    #[serde(default)]
    pub limits: Limits,
    /// The segments, one after another.
    #[serde(rename = "segment")]
    pub segments: Segments,
}

/// The band that the ball must not leave after it has been inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Lower end, mm.
    pub position_min_mm: Option<f64>,
    /// Upper end, mm.
    pub position_max_mm: Option<f64>,
}

/// One part of an experiment: a setpoint, or a duty without control.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Its duration, seconds. Only the reference of a config lasts for ever (`inf`).
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
    /// Duty without control, percent about the hover of `[compensation]`.
    #[serde(default)]
    pub duty_about_hover_percent: Option<Waveform>,
    /// The segment ends when the ball is below this, mm.
    #[serde(default)]
    pub until_below_mm: Option<f64>,
    /// The segment ends when the ball is above this, mm.
    #[serde(default)]
    pub until_above_mm: Option<f64>,
    /// If the ball is further from the setpoint than this, the flight continues with its last segment, mm.
    #[serde(default)]
    pub back_off_beyond_mm: Option<f64>,
    /// Gains of the PID during the segment; absent ones are those of the config.
    #[serde(default)]
    pub gains: Option<GainChange>,
}

/// The command at one moment.
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
    /// Drive the fan about hover.
    DriveAboutHover {
        /// Duty minus that of hover, percent.
        percent: f64,
    },
}

impl Experiment {
    /// Reads and checks an experiment against the safety limits of the rig.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn read(path: &Path, safety: &Safety) -> Result<Self, ConfigError> {
        Self::of_file(path, safety, "`--experiment FILE`")
    }

    /// The same for a file that `flag` names.
    fn of_file(path: &Path, safety: &Safety, flag: &'static str) -> Result<Self, ConfigError> {
        let (experiment, place) = parse_file::<Self>(path, flag)?;
        experiment.checked(safety, place)
    }

    /// An experiment that the program holds, checked as if it had been read from the file of this name.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn own(name: &str, text: &str, safety: &Safety) -> Result<Self, ConfigError> {
        let (experiment, place) = parse_text::<Self>(name, text)?;
        experiment.checked(safety, place)
    }

    fn checked(self, safety: &Safety, place: impl Fn(&str) -> String) -> Result<Self, ConfigError> {
        self.check(safety).map_err(|(key, problem)| match problem {
            Problem::Range(error) => {
                ConfigError::Range { place: place(&format!("{key}.{}", error.key)), table: key, error }
            }
            Problem::Message(message) => ConfigError::Contradiction { place: place(&key), message: message.into() },
        })?;
        Ok(self)
    }

    /// The config's reference as an experiment without end.
    #[must_use]
    pub fn of_reference(reference: &Reference) -> Self {
        let setpoint_mm = Some(reference.setpoint_mm.clone());
        let segment = Segment { duration_s: f64::INFINITY, setpoint_mm, ..Segment::default() };
        Self { title: "reference of the config".into(), limits: Limits::default(), segments: vec![segment].into() }
    }

    /// Its duration, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.segments.duration_s()
    }

    /// The command `t_s` seconds after the start. `None` after its end.
    #[must_use]
    pub fn demand(&self, t_s: f64) -> Option<Demand> {
        self.segments.at(t_s).map(|(segment, start_s)| segment.demand(t_s - start_s))
    }

    /// The gains of the PID `t_s` seconds after the start, where they are not those of the config.
    #[must_use]
    pub fn gains(&self, t_s: f64) -> Option<GainChange> {
        self.segments.at(t_s).and_then(|(segment, _)| segment.gains)
    }

    /// Whether it changes gains at any time.
    #[must_use]
    pub fn changes_gains(&self) -> bool {
        self.segments.iter().any(|segment| segment.gains.is_some())
    }

    /// The time of the programme that is skipped for a ball at `position_mm`, `t_s` seconds after the start, seconds.
    #[must_use]
    pub fn left_out_s(&self, t_s: f64, position_mm: f64) -> f64 {
        let Some((segment, start_s)) = self.segments.at(t_s) else { return 0.0 };
        let last = self.segments.last().filter(|_| segment.swings_out(t_s - start_s, position_mm));
        if let Some(last) = last {
            (self.duration_s() - last.duration_s - t_s).max(0.0) + HAIR_S
        } else if segment.is_over(position_mm) {
            start_s + segment.duration_s - t_s + HAIR_S
        } else {
            0.0
        }
    }

    /// The limit that `position_mm` exceeds, as lower and upper limit.
    #[must_use]
    pub fn outside_band(&self, position_mm: f64) -> Option<(f64, f64)> {
        let min = self.limits.position_min_mm.unwrap_or(f64::NEG_INFINITY);
        let max = self.limits.position_max_mm.unwrap_or(f64::INFINITY);
        (position_mm < min || position_mm > max).then_some((min, max))
    }
}

impl Segment {
    fn demand(&self, t_s: f64) -> Demand {
        let value = |wave: &Option<Waveform>| wave.as_ref().map_or(0.0, |wave| wave.value(t_s));
        match (&self.duty_percent, &self.duty_about_hover_percent) {
            (Some(duty), _) => Demand::Drive { duty_percent: duty.value(t_s) },
            (None, Some(duty)) => Demand::DriveAboutHover { percent: duty.value(t_s) },
            (None, None) => Demand::Control {
                setpoint_mm: value(&self.setpoint_mm),
                excitation_percent: value(&self.excitation_percent),
            },
        }
    }

    fn is_over(&self, position_mm: f64) -> bool {
        self.until_below_mm.is_some_and(|below| position_mm < below)
            || self.until_above_mm.is_some_and(|above| position_mm > above)
    }

    fn swings_out(&self, t_s: f64, position_mm: f64) -> bool {
        let setpoint = self.setpoint_mm.as_ref().map(|setpoint| setpoint.value(t_s));
        setpoint.zip(self.back_off_beyond_mm).is_some_and(|(setpoint, beyond)| (position_mm - setpoint).abs() > beyond)
    }
}

#[cfg(test)]
mod tests;
