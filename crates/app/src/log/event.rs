//! The message of a log's channel `event`: an event in words.

use crate::flight::lateness::Lateness;
use crate::flight::vocabulary::{Event, What, word};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An [`Event`] in words. The message of the log's channel `event`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EventMessage {
    /// When, seconds since the start of the flight.
    pub time_s: f64,
    /// `mode`, `fault`, `command`, `timing` or `end`.
    pub kind: String,
    /// What happened, in words.
    pub text: String,
    /// Of `timing`: how late the cycles began since the start of the flight, counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateness: Option<Lateness>,
}

impl From<Event> for EventMessage {
    fn from(event: Event) -> Self {
        let (kind, text) = match event.what {
            What::Mode { from, to } => ("mode", format!("{} → {}", word(from), word(to))),
            What::Fault(fault) => ("fault", fault.to_string()),
            What::Command { command, refused: None } => ("command", format!("{command}: accepted")),
            What::Command { command, refused: Some(why) } => ("command", format!("{command}: refused, {why}")),
            What::Lateness(lateness) => ("timing", lateness.to_string()),
            What::End(end) => ("end", word(end)),
        };
        let lateness = if let What::Lateness(counted) = event.what { Some(counted.into()) } else { None };
        Self { time_s: event.time_s, kind: kind.into(), text, lateness }
    }
}
