//! A rig's messages for their readers: the displayed part of `state` and `reply`.

use crate::flight::lateness::Quantiles;
use crate::flight::vocabulary::Cycle;
use control::controller::Kind;
use serde::Deserialize;

/// The message on `state`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Seen {
    /// The latest cycle.
    #[serde(flatten)]
    pub cycle: Cycle,
    /// The active controller.
    pub controller: Kind,
    /// The experiment that was started in flight.
    #[serde(default)]
    pub experiment: Option<String>,
    /// Cycles that began too late, since the start.
    pub late_cycles: u64,
    /// Quantiles of the lateness, since the start.
    pub lateness: Quantiles,
    /// Messages that did not fit into the log's queue, since the start.
    pub dropped_log_messages: u64,
    /// Messages that were lost between loop and broker, since the start.
    pub dropped_mqtt_messages: u64,
    /// The present fault, in words.
    pub fault: Option<String>,
}

/// The message on `reply`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Said {
    /// The topic of the command, `set/…`.
    pub topic: String,
    /// Whether it is in force.
    pub accepted: bool,
    /// The reason if not.
    pub reason: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::{Said, Seen};
    use crate::mqtt::Counts;
    use crate::mqtt::link_support::state;
    use crate::mqtt::message::StateMessage;

    #[test]
    fn what_a_rig_publishes_is_read_as_it_was_meant() {
        let published = StateMessage { state: state(12.5), link: Counts::default() };
        let seen: Seen = serde_json::from_slice(&serde_json::to_vec(&published).unwrap()).unwrap();
        assert_eq!((seen.cycle, seen.late_cycles, seen.experiment), (published.state.cycle, 2, None));
    }

    #[test]
    fn a_reply_keeps_its_reason() {
        let text = r#"{"topic":"set/mode","accepted":false,"in_force":null,"reason":"busy"}"#;
        let said: Said = serde_json::from_str(text).unwrap();
        assert_eq!((said.accepted, said.reason.as_deref()), (false, Some("busy")));
    }
}
