//! The messages of the loop, as JSON for the broker.

use super::count::Counts;
use crate::flight::command::Command;
use crate::flight::state::{Answer, InForce, State};
use crate::flight::vocabulary::Cycle;
use config::topics::Quantity;
use serde::Serialize;

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
    /// In order, as in the log.
    pub(super) cycles: &'a [Cycle],
    /// Those that did not fit, since the stream began.
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
    fn from(Answer { command, refused, in_force, .. }: Answer) -> Self {
        Self {
            topic: quantity(command).topic().to_owned(),
            accepted: refused.is_none(),
            in_force: Some(in_force),
            reason: refused.map(|why| why.to_string()),
        }
    }
}

/// The quantity that a command sets.
const fn quantity(command: Command) -> Quantity {
    match command {
        Command::Setpoint(_) => Quantity::Setpoint,
        Command::Gains(_) => Quantity::Gains,
        Command::Numbers(_) | Command::Undo => Quantity::Numbers,
        Command::Controller(_) => Quantity::Controller,
        Command::Stop | Command::Fly | Command::Programme => Quantity::Mode,
        Command::Experiment(_) => Quantity::Experiment,
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, InForce, Reply};
    use crate::flight::command::{Command, Refusal};
    use crate::flight::state::Gains;
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
        let answer = Answer { command: Command::Setpoint(300.0), refused: None, in_force: IN_FORCE, numbers: None };
        let in_force = json!({"setpoint_mm": 300.0, "controller": "pid", "kp_per_mm": 0.01, "ti_s": null, "td_s": 0.5, "mode": "flying", "experiment": null});
        let expected = json!({"topic": "set/setpoint_mm", "accepted": true, "in_force": in_force, "reason": null});
        assert_eq!(serde_json::to_value(Reply::from(answer)).unwrap(), expected);
    }

    #[test]
    fn a_refused_command_is_answered_with_the_reason_and_what_stays_in_force() {
        let refused = Some(Refusal::OpenLoop);
        let reply = Reply::from(Answer { command: Command::Fly, refused, in_force: IN_FORCE, numbers: None });
        assert_eq!((reply.topic.as_str(), reply.accepted), ("set/mode", false));
        assert_eq!(reply.reason, Some(Refusal::OpenLoop.to_string()));
        assert_eq!(reply.in_force, Some(IN_FORCE));
    }
}
