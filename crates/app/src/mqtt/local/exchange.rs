//! Who has subscribed to what, and the retained messages.
//!
//! A receiver that does not keep up with [`ROOM`] messages is disconnected, so that none is lost unnoticed.

use crate::locked::locked;
use bytes::{Bytes, BytesMut};
use rumqttc::mqttbytes::matches;
use rumqttc::{Packet, Publish, QoS};
use std::collections::BTreeMap;
use std::sync::Mutex;
use tokio::sync::mpsc;

/// Messages that wait for one receiver: half a minute of states.
pub(super) const ROOM: usize = 512;
/// Most receivers: tabs of one computer.
const MOST_RECEIVERS: usize = 64;
/// Most subscriptions of one.
const MOST_FILTERS: usize = 32;
/// Largest packet that is written; the rig's own are smaller.
pub(super) const LARGEST: usize = 128 * 1024;

/// The state that sessions share.
#[derive(Debug, Default)]
pub(super) struct Exchange(Mutex<Shared>);

#[derive(Debug, Default)]
struct Shared {
    next: u64,
    receivers: BTreeMap<u64, Receiver>,
    retained: BTreeMap<String, Bytes>,
}

#[derive(Debug)]
struct Receiver {
    filters: Vec<String>,
    outbox: mpsc::Sender<Bytes>,
}

impl Exchange {
    /// A new receiver: its number, and its messages. `None`: there are too many.
    pub(super) fn join(&self) -> Option<(u64, mpsc::Receiver<Bytes>)> {
        let mut shared = locked(&self.0);
        if shared.receivers.len() >= MOST_RECEIVERS {
            return None;
        }
        let (outbox, messages) = mpsc::channel(ROOM);
        shared.next += 1;
        let id = shared.next;
        shared.receivers.insert(id, Receiver { filters: Vec::new(), outbox });
        Some((id, messages))
    }

    /// The receiver is gone.
    pub(super) fn leave(&self, id: u64) {
        locked(&self.0).receivers.remove(&id);
    }

    /// Subscribes, and returns the retained messages of the topics. `None`: too many subscriptions.
    pub(super) fn subscribe(&self, id: u64, filter: &str) -> Option<Vec<Bytes>> {
        let mut shared = locked(&self.0);
        let receiver = shared.receivers.get_mut(&id)?;
        if !receiver.filters.iter().any(|held| held == filter) {
            if receiver.filters.len() >= MOST_FILTERS {
                return None;
            }
            receiver.filters.push(filter.to_owned());
        }
        let kept = shared.retained.iter().filter(|(topic, _)| matches(topic, filter));
        Some(kept.filter_map(|(topic, payload)| packet(topic, payload, true)).collect())
    }

    /// Ends a subscription.
    pub(super) fn unsubscribe(&self, id: u64, filter: &str) {
        if let Some(receiver) = locked(&self.0).receivers.get_mut(&id) {
            receiver.filters.retain(|held| held != filter);
        }
    }

    /// Passes a message on, and keeps it if it is retained; an empty one is kept no longer. Returns how many got it.
    pub(super) fn publish(&self, topic: &str, payload: &Bytes, retain: bool) -> usize {
        let mut shared = locked(&self.0);
        if retain && payload.is_empty() {
            shared.retained.remove(topic);
        } else if retain {
            shared.retained.insert(topic.to_owned(), payload.clone());
        }
        let Some(message) = packet(topic, payload, false) else { return 0 };
        let mut got = 0;
        shared.receivers.retain(|_, receiver| {
            if !receiver.filters.iter().any(|filter| matches(topic, filter)) {
                return true;
            }
            let sent = receiver.outbox.try_send(message.clone()).is_ok();
            got += usize::from(sent);
            sent
        });
        got
    }
}

/// A message as bytes. `None` where it is too large.
fn packet(topic: &str, payload: &Bytes, retain: bool) -> Option<Bytes> {
    let message = Publish { retain, ..Publish::from_bytes(topic, QoS::AtMostOnce, payload.clone()) };
    let mut bytes = BytesMut::new();
    Packet::Publish(message).write(&mut bytes, LARGEST).ok()?;
    Some(bytes.freeze())
}
