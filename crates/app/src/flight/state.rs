//! The loop's state for its commander: plain copies on the loop's side, JSON on the other.

use super::command::{Command, Refusal};
use super::lateness::Histogram;
use super::name::Name;
use super::vocabulary::{Cycle, Fault, Mode};
use control::controller::Kind;
use control::numbers::Values;
use control::pid::Pid;
use serde::{Serialize, Serializer};

/// The gains in force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gains {
    /// K_p, see [`Pid::kp_per_mm`].
    pub kp_per_mm: f64,
    /// T_i, seconds. Infinite: no integral, `null` in JSON.
    pub ti_s: f64,
    /// T_d, seconds.
    pub td_s: f64,
}

impl From<Pid> for Gains {
    fn from(Pid { kp_per_mm, ti_s, td_s, .. }: Pid) -> Self {
        Self { kp_per_mm, ti_s, td_s }
    }
}

/// The present values that commands can change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InForce {
    /// Commanded position, millimetres. Null while the fan is driven without control.
    pub setpoint_mm: Option<f64>,
    /// The active controller.
    pub controller: Kind,
    /// The gains of the PID, where there is one.
    #[serde(flatten)]
    pub gains: Option<Gains>,
    /// What the loop is doing.
    pub mode: Mode,
    /// The experiment that was started in flight, until it is over.
    pub experiment: Option<Name>,
}

/// The result of a command, as the loop passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The command.
    pub command: Command,
    /// Why it was refused, if it was.
    pub refused: Option<Refusal>,
    /// The values in force after it.
    pub in_force: InForce,
    /// All numbers, where it changed any.
    pub numbers: Option<Values>,
}

/// The state as the loop passes it on, in every cycle if needed; the newest is published at 10 Hz.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct State {
    /// The cycle just done.
    #[serde(flatten)]
    pub cycle: Cycle,
    /// The active controller.
    pub controller: Kind,
    /// The gains of the PID, where there is one.
    #[serde(flatten)]
    pub gains: Option<Gains>,
    /// The experiment that was started in flight, until it is over.
    pub experiment: Option<Name>,
    /// Cycles that began too late, since the start.
    pub late_cycles: u64,
    /// Histogram of the lateness, since the start.
    pub lateness: Histogram,
    /// Messages that did not fit into the log's queue, since the start.
    pub dropped_log_messages: u64,
    /// The present fault, in words; null where there is none.
    #[serde(serialize_with = "in_words")]
    pub fault: Option<Fault>,
    /// The fault after which the fan is off until `fly`, in words; null where there is none.
    #[serde(serialize_with = "in_words")]
    pub stopped_by: Option<Fault>,
}

fn in_words<S: Serializer>(fault: &Option<Fault>, to: S) -> Result<S::Ok, S::Error> {
    fault.map(|fault| fault.to_string()).serialize(to)
}

impl State {
    /// The part that commands can change.
    #[must_use]
    pub const fn in_force(&self) -> InForce {
        InForce {
            setpoint_mm: self.cycle.setpoint_mm,
            controller: self.controller,
            gains: self.gains,
            mode: self.cycle.mode,
            experiment: self.experiment,
        }
    }
}
