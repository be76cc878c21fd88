//! Commands to a flight, and the reasons to refuse one.

use crate::flight::name::Name;
use control::controller::{Controllers, Kind};
use control::numbers::{Parameter, Values};
use control::pid::Pid;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A command over MQTT. A plain copy, so that it reaches the loop without allocating.
#[expect(clippy::large_enum_variant, reason = "a box would allocate, and few commands are on their way at a time")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Hold this position, millimetres, from now on.
    Setpoint(f64),
    /// Change gains together.
    Gains(GainChange),
    /// Change any numbers of controllers, observer and compensation together.
    Numbers(Values),
    /// Take the last change of gains or numbers back.
    Undo,
    /// Change to another controller.
    Controller(Kind),
    /// Turn the fan off until the command `fly`.
    Stop,
    /// Fly again after a stop.
    Fly,
    /// Return to the programme of the config or the experiment that the flight began with.
    Programme,
    /// Fly an experiment of the offers, from its start, and then the programme again.
    Experiment(Name),
}

impl Command {
    /// Whether it changes numbers of controllers, observer or compensation.
    #[must_use]
    pub const fn is_of_numbers(&self) -> bool {
        matches!(self, Self::Gains(_) | Self::Numbers(_) | Self::Undo)
    }
}

/// New gains; absent ones are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainChange {
    /// New K_p, see [`Pid::kp_per_mm`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kp_per_mm: Option<f64>,
    /// New T_i, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ti_s: Option<f64>,
    /// New T_d, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub td_s: Option<f64>,
}

impl GainChange {
    /// The gains after the change.
    #[must_use]
    pub fn applied_to(self, gains: Pid) -> Pid {
        Pid {
            kp_per_mm: self.kp_per_mm.unwrap_or(gains.kp_per_mm),
            ti_s: self.ti_s.unwrap_or(gains.ti_s),
            td_s: self.td_s.unwrap_or(gains.td_s),
            ..gains
        }
    }
}

/// Why a command was refused in flight.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The setpoint is outside the safety limits.
    #[error("{asked_mm} mm is outside the safe setpoints of {min_mm} to {max_mm} mm (table [safety] of the config)")]
    Setpoint {
        /// The commanded setpoint.
        asked_mm: f64,
        /// Smallest safe setpoint.
        min_mm: f64,
        /// Largest safe setpoint.
        max_mm: f64,
    },
    /// A gain is outside its bounds.
    #[error("{0}")]
    Gain(control::OutOfRange),
    /// A number is outside its bounds.
    #[error("{table}.{error}")]
    Number {
        /// The table.
        table: &'static str,
        /// Key, value and bounds.
        error: control::OutOfRange,
    },
    /// The config does not have the number.
    #[error("the config has no {0}, and what is absent is off; the retained topic `about` lists what can be changed")]
    Absent(&'static str),
    /// No estimate or no plan can be made with the numbers.
    #[error("{0}")]
    Unready(control::regulator::Unready),
    /// The programme changes gains itself.
    #[error("the experiment sets gains itself now; wait for its end, or send programme to set/mode first")]
    ProgrammeGains,
    /// Nothing was changed, or all of it was taken back.
    #[error("no change is left to undo: these are the numbers of the config")]
    NothingToUndo,
    /// There is no PID whose gains could change.
    #[error("the config has no table [controller.pid], so there are no gains to change")]
    NoPid,
    /// There is no such controller.
    #[error("the config has no table [controller.{}]; it has {known}", asked.name())]
    Controller {
        /// The commanded controller.
        asked: Kind,
        /// The controllers of the config.
        known: Known,
    },
    /// There is no such experiment.
    #[error(
        "there is no experiment {asked}; the retained topic `about` lists all, and [mqtt] experiments of the config \
         adds files"
    )]
    Experiment {
        /// The commanded experiment.
        asked: Name,
    },
    /// The experiment changes gains of a controller that is not active.
    #[error("the experiment changes the gains of the PID, and {} flies; send pid to set/controller first", flies.name())]
    NeedsPid {
        /// The active controller.
        flies: Kind,
    },
    /// The experiment's gains would be in another unit.
    #[error(
        "the experiment's gains are in percent per mm, and behind [compensation] predistortion they would be in mm/s² per mm"
    )]
    Predistortion,
    /// The fan is off.
    #[error("the fan is off; send fly to set/mode first")]
    Stopped,
    /// The loop is not controlling the ball.
    #[error("the fan follows an open-loop programme; wait for its end")]
    OpenLoop,
}

/// The controllers that a config holds, as a plain copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Known([bool; Kind::ALL.len()]);

impl From<&Controllers> for Known {
    fn from(controllers: &Controllers) -> Self {
        Self(Kind::ALL.map(|kind| controllers.has(kind)))
    }
}

impl fmt::Display for Known {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let there = Kind::ALL.into_iter().zip(self.0).filter_map(|(kind, there)| there.then_some(kind.name()));
        f.write_str(&there.collect::<Vec<_>>().join(", "))
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setpoint(mm) => write!(f, "setpoint_mm {mm}"),
            Self::Gains(change) => write!(f, "gains {}", serde_json::to_string(change).unwrap_or_default()),
            Self::Numbers(values) => {
                f.write_str("numbers")?;
                let given = Parameter::ALL.iter().zip(values).filter_map(|(one, value)| Some((one, (*value)?)));
                given.enumerate().try_for_each(|(k, (one, value))| {
                    write!(f, "{} {} ", if k == 0 { "" } else { "," }, one.name)?;
                    match one.word(value) {
                        Some(word) => f.write_str(word),
                        None => write!(f, "{value}"),
                    }
                })
            }
            Self::Undo => f.write_str("numbers undo"),
            Self::Controller(kind) => write!(f, "controller {}", kind.name()),
            Self::Stop => f.write_str("mode stop"),
            Self::Fly => f.write_str("mode fly"),
            Self::Programme => f.write_str("mode programme"),
            Self::Experiment(name) => write!(f, "experiment {name}"),
        }
    }
}
