//! The loop's end of the link: three bounded rings of plain copies. Nothing here blocks or allocates.

use super::count::{Counters, count};
use super::message::{Answer, State};
use crate::command::Command;
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;

/// Room in each ring: more than a second of states at 50 Hz, should the publisher not get the processor.
pub(super) const ROOM: usize = 64;

/// What the loop holds. It outlives the link without harm, and the link outlives it.
#[derive(Debug)]
pub struct Mailbox {
    commands: Consumer<Command>,
    answers: Producer<Answer>,
    states: Producer<State>,
    counters: Arc<Counters>,
}

/// The other ends: commands belong to the network's thread, the rest to the publisher's.
pub(super) struct FarEnd {
    pub(super) commands: Producer<Command>,
    pub(super) answers: Consumer<Answer>,
    pub(super) states: Consumer<State>,
}

impl Mailbox {
    pub(super) fn new(counters: Arc<Counters>) -> (Self, FarEnd) {
        let (command_in, commands) = RingBuffer::new(ROOM);
        let (answers, answer_out) = RingBuffer::new(ROOM);
        let (states, state_out) = RingBuffer::new(ROOM);
        let far = FarEnd { commands: command_in, answers: answer_out, states: state_out };
        (Self { commands, answers, states, counters }, far)
    }

    /// One with commands in it, and nobody at the other end.
    #[cfg(test)]
    pub(crate) fn holding(commands: impl IntoIterator<Item = Command>) -> Self {
        let (mailbox, mut far) = Self::new(Arc::default());
        commands.into_iter().for_each(|command| far.commands.push(command).unwrap());
        mailbox
    }

    /// The oldest command that waits. Answer each.
    pub fn try_command(&mut self) -> Option<Command> {
        self.commands.pop().ok()
    }

    /// Says what became of a command.
    pub fn answer(&mut self, answer: Answer) {
        if self.answers.push(answer).is_err() {
            count(&self.counters.dropped);
        }
    }

    /// Says how things are.
    pub fn publish_state(&mut self, state: State) {
        if self.states.push(state).is_err() {
            count(&self.counters.dropped);
        }
    }
}
