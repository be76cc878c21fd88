//! The interfaces of a flight besides its rig: a recorder and a commander. Neither may block.

use super::command::Command;
use super::state::{Answer, State};
use super::vocabulary::{Cycle, Event};

/// Receives the data of a flight.
pub trait Recorder {
    /// Takes one control period.
    fn cycle(&mut self, cycle: &Cycle);
    /// Takes an event.
    fn event(&mut self, event: &Event);
    /// Number of lost entries so far.
    fn dropped(&self) -> u64 {
        0
    }
}

/// Commands a flight, and receives replies and state.
pub trait Commander {
    /// The oldest pending command. Each needs an answer.
    fn try_command(&mut self) -> Option<Command>;
    /// Takes the answer to a command.
    fn answer(&mut self, answer: Answer);
    /// Takes the present state.
    fn publish_state(&mut self, state: State);
    /// Whether somebody can send commands now.
    fn is_heard(&self) -> bool {
        false
    }
}
