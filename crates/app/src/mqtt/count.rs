//! Counts of messages on the link, and of lost ones.

use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Counts since the start of the link. Part of the message on `state`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Messages on the topic of a command.
    pub commands_received: u32,
    /// Commands refused, because of their form or by the loop.
    pub commands_refused: u32,
    /// Commands that did not fit into the loop's ring.
    pub commands_busy: u32,
    /// Replies and states that did not fit between loop and broker.
    pub dropped_mqtt_messages: u32,
}

/// [`Counts`] that all threads add to. 32 bits, because a wider sum takes a lock on the rig's processor.
#[derive(Debug, Default)]
pub(super) struct Counters {
    pub(super) received: AtomicU32,
    pub(super) refused: AtomicU32,
    pub(super) busy: AtomicU32,
    pub(super) dropped: AtomicU32,
    /// Whether a broker is connected and told of us.
    pub(super) connected: AtomicBool,
}

/// Adds one.
pub(super) fn count(counter: &AtomicU32) {
    counter.fetch_add(1, Relaxed);
}

impl Counters {
    pub(super) fn read(&self) -> Counts {
        Counts {
            commands_received: self.received.load(Relaxed),
            commands_refused: self.refused.load(Relaxed),
            commands_busy: self.busy.load(Relaxed),
            dropped_mqtt_messages: self.dropped.load(Relaxed),
        }
    }
}
