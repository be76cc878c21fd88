//! What a flight asks of the world besides its rig: somebody to record it, and somebody to command it. Neither may
//! block.

use super::command::Command;
use super::state::{Answer, State};
use super::vocabulary::{Cycle, Event};

/// Takes what a flight leaves behind.
pub trait Recorder {
    /// Takes one control period.
    fn cycle(&mut self, cycle: &Cycle);
    /// Takes an event.
    fn event(&mut self, event: &Event);
    /// How many of them were lost so far.
    fn dropped(&self) -> u64 {
        0
    }
}

/// Commands a flight, and hears what becomes of the commands and of the flight.
pub trait Commander {
    /// The oldest command that waits. Answer each.
    fn try_command(&mut self) -> Option<Command>;
    /// Takes what became of a command.
    fn answer(&mut self, answer: Answer);
    /// Takes how things are.
    fn publish_state(&mut self, state: State);
}
