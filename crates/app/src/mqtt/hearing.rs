//! Subscriptions: all commands, unless the broker retains a message that is too large.
//!
//! A packet beyond the limit ends the connection before its topic is known. A published one ends one connection. A
//! *retained* one is sent again just after every subscription and would end every connection; so the next session
//! subscribes to less: to the mode alone, so that `stop` is received, or, if the packet is retained there, to nothing.
//! A minute later it subscribes to everything again.

use config::topics::{ORIGINAL_GAINS, ORIGINAL_SETPOINT, Topics};
use rumqttc::mqttbytes::Error as Malformed;
use rumqttc::{Client, ConnectionError, QoS, StateError, SubscribeFilter};
use std::time::{Duration, Instant};

/// A packet this soon after a subscription was retained.
pub(super) const SOON: Duration = Duration::from_secs(5);
/// Duration of a reduced subscription.
const LESS_FOR: Duration = Duration::from_secs(60);

/// The subscribed topics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    Everything,
    Mode,
    Nothing,
}

/// The present subscription, and its start.
#[derive(Debug)]
pub(super) struct Hearing {
    width: Width,
    since: Instant,
}

impl Hearing {
    pub(super) fn new() -> Self {
        Self { width: Width::Everything, since: Instant::now() }
    }

    /// Subscribes. False where the client's queue is full.
    pub(super) fn subscribe(&mut self, client: &Client, topics: &Topics) -> bool {
        self.since = Instant::now();
        let filters = self.filters(topics).into_iter().map(|filter| SubscribeFilter::new(filter, QoS::AtLeastOnce));
        self.width == Width::Nothing || client.try_subscribe_many(filters).is_ok()
    }

    fn filters(&self, topics: &Topics) -> Vec<String> {
        match self.width {
            Width::Everything => {
                let original = [ORIGINAL_SETPOINT, ORIGINAL_GAINS].map(str::to_owned);
                [[topics.claim.clone(), topics.commands.clone()], original].concat()
            }
            Width::Mode => vec![topics.claim.clone(), topics.mode.clone()],
            Width::Nothing => Vec::new(),
        }
    }

    /// Evaluates the end of a connection.
    pub(super) fn ended(&mut self, cause: &ConnectionError, now: Instant) {
        if too_large(cause).is_some() && now < self.since + SOON {
            self.width = if self.width == Width::Everything { Width::Mode } else { Width::Nothing };
        }
    }

    /// Whether a reduced subscription has lasted long enough. From now on it is everything.
    pub(super) fn recovers(&mut self, now: Instant) -> bool {
        let due = self.width != Width::Everything && now >= self.since + LESS_FOR;
        if due {
            self.width = Width::Everything;
        }
        due
    }
}

/// The size of a packet that was too large, in bytes, if that ended the connection.
pub(super) const fn too_large(cause: &ConnectionError) -> Option<usize> {
    match cause {
        ConnectionError::MqttState(StateError::Deserialization(Malformed::PayloadSizeLimitExceeded(bytes))) => {
            Some(*bytes)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{ConnectionError, Hearing, LESS_FOR, Malformed, SOON, StateError, Topics};
    use std::time::Duration;

    const HUGE: ConnectionError =
        ConnectionError::MqttState(StateError::Deserialization(Malformed::PayloadSizeLimitExceeded(9_000_000)));

    fn filters(hearing: &Hearing) -> Vec<String> {
        hearing.filters(&Topics::new("r").unwrap())
    }

    #[test]
    fn a_huge_message_right_behind_a_subscription_narrows_it_and_a_minute_widens_it() {
        let mut hearing = Hearing::new();
        let at = hearing.since;
        let all = ["airball/r/claim", "airball/r/set/#", "ball/parameters/reference", "ball/parameters/PID"];
        assert_eq!(filters(&hearing), all);
        hearing.ended(&HUGE, at);
        assert_eq!(filters(&hearing), ["airball/r/claim", "airball/r/set/mode"]);
        hearing.ended(&HUGE, at);
        assert!(filters(&hearing).is_empty());
        assert!(!hearing.recovers(at + LESS_FOR - Duration::from_secs(1)));
        assert!(hearing.recovers(at + LESS_FOR) && !hearing.recovers(at + LESS_FOR));
        assert_eq!(filters(&hearing), all);
    }

    #[test]
    fn a_huge_message_in_between_and_any_other_end_change_nothing() {
        let mut hearing = Hearing::new();
        let at = hearing.since;
        hearing.ended(&HUGE, at + SOON);
        hearing.ended(&ConnectionError::NetworkTimeout, at);
        assert_eq!(filters(&hearing).len(), 4);
    }
}
