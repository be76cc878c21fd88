//! What the loop says about itself: plain copies on its side, JSON on the broker's.

use super::count::Counts;
use crate::config::topics::Quantity;
use crate::flight::command::{Command, Refusal};
use crate::flight::experiment::offers::Name;
use crate::flight::lateness::Histogram;
use crate::flight::vocabulary::{Cycle, Fault, Mode};
use control::controller::Kind;
use control::pid::Pid;
use serde::{Serialize, Serializer};

/// The gains in force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gains {
    /// K_p, see [`Pid::kp_per_mm`].
    pub kp_per_mm: f64,
    /// T_i, seconds. Infinite is an integral that is off, and `null` in JSON.
    pub ti_s: f64,
    /// T_d, seconds.
    pub td_s: f64,
}

impl From<Pid> for Gains {
    fn from(Pid { kp_per_mm, ti_s, td_s, .. }: Pid) -> Self {
        Self { kp_per_mm, ti_s, td_s }
    }
}

/// What a command may change, as it is now.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InForce {
    /// Commanded position, millimetres. Null while the fan is driven without control.
    pub setpoint_mm: Option<f64>,
    /// Which controller flies.
    pub controller: Kind,
    /// The gains of the PID, where there is one.
    #[serde(flatten)]
    pub gains: Option<Gains>,
    /// What the loop is doing.
    pub mode: Mode,
    /// The experiment that was started in flight, until it is over.
    pub experiment: Option<Name>,
}

/// What became of a command, as the loop hands it over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// What was asked for.
    pub command: Command,
    /// Why it was refused, if it was.
    pub refused: Option<Refusal>,
    /// What is in force after it.
    pub in_force: InForce,
}

/// The state as the loop hands it over, every cycle if it likes; the newest is published at 10 Hz.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct State {
    /// The cycle just done.
    #[serde(flatten)]
    pub cycle: Cycle,
    /// Which controller flies.
    pub controller: Kind,
    /// The gains of the PID, where there is one.
    #[serde(flatten)]
    pub gains: Option<Gains>,
    /// The experiment that was started in flight, until it is over.
    pub experiment: Option<Name>,
    /// Cycles that began too late, since the start.
    pub late_cycles: u64,
    /// How late they began, since the start.
    pub lateness: Histogram,
    /// Messages that the log had no room for, since the start.
    pub dropped_log_messages: u64,
    /// What is wrong now, in words; null where nothing is.
    #[serde(serialize_with = "in_words")]
    pub fault: Option<Fault>,
}

fn in_words<S: Serializer>(fault: &Option<Fault>, to: S) -> Result<S::Ok, S::Error> {
    fault.map(|fault| fault.to_string()).serialize(to)
}

impl State {
    /// The part that commands may change.
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

/// The message on `state`.
#[derive(Serialize)]
pub(super) struct StateMessage {
    #[serde(flatten)]
    pub(super) state: State,
    #[serde(flatten)]
    pub(super) link: Counts,
}

/// The message on `cycles`.
#[derive(Serialize)]
pub(super) struct CyclesMessage<'a> {
    /// One after another, as the log has them.
    pub(super) cycles: &'a [Cycle],
    /// Those that were lost for want of room, since the stream began.
    pub(super) dropped: u32,
}

/// The message on `reply`.
#[derive(Serialize)]
pub(super) struct Reply {
    pub(super) topic: String,
    pub(super) accepted: bool,
    pub(super) in_force: Option<InForce>,
    pub(super) reason: Option<String>,
}

impl From<Answer> for Reply {
    fn from(Answer { command, refused, in_force }: Answer) -> Self {
        Self {
            topic: quantity(command).topic().to_owned(),
            accepted: refused.is_none(),
            in_force: Some(in_force),
            reason: refused.map(|why| why.to_string()),
        }
    }
}

/// What a command sets.
const fn quantity(command: Command) -> Quantity {
    match command {
        Command::Setpoint(_) => Quantity::Setpoint,
        Command::Gains(_) => Quantity::Gains,
        Command::Controller(_) => Quantity::Controller,
        Command::Stop | Command::Fly | Command::Programme => Quantity::Mode,
        Command::Experiment(_) => Quantity::Experiment,
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, Gains, InForce, Reply};
    use crate::flight::command::{Command, Refusal};
    use crate::flight::vocabulary::Mode;
    use control::controller::Kind;
    use serde_json::json;

    const IN_FORCE: InForce = InForce {
        setpoint_mm: Some(300.0),
        controller: Kind::Pid,
        gains: Some(Gains { kp_per_mm: 0.01, ti_s: f64::INFINITY, td_s: 0.5 }),
        mode: Mode::Flying,
        experiment: None,
    };

    #[test]
    fn an_accepted_command_is_answered_with_what_is_in_force_and_an_integral_that_is_off_is_null() {
        let answer = Answer { command: Command::Setpoint(300.0), refused: None, in_force: IN_FORCE };
        let in_force = json!({"setpoint_mm": 300.0, "controller": "pid", "kp_per_mm": 0.01, "ti_s": null, "td_s": 0.5, "mode": "flying", "experiment": null});
        let expected = json!({"topic": "set/setpoint_mm", "accepted": true, "in_force": in_force, "reason": null});
        assert_eq!(serde_json::to_value(Reply::from(answer)).unwrap(), expected);
    }

    #[test]
    fn a_refused_command_is_answered_with_the_reason_and_what_stays_in_force() {
        let refused = Some(Refusal::OpenLoop);
        let reply = Reply::from(Answer { command: Command::Fly, refused, in_force: IN_FORCE });
        assert_eq!((reply.topic.as_str(), reply.accepted), ("set/mode", false));
        assert_eq!(reply.reason, Some(Refusal::OpenLoop.to_string()));
        assert_eq!(reply.in_force, Some(IN_FORCE));
    }
}
