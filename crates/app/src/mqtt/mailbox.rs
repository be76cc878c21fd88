//! The loop's end of the link: three bounded rings of plain copies. Nothing here blocks or allocates.
//!
//! A stop is never lost: if the ring of commands is full, it is a flag beside it, and the commands in the ring are
//! discarded, so that no `fly` from before the stop starts the fan again.

use super::count::{Counters, count};
use crate::flight::command::Command;
use crate::flight::outside::Commander;
use crate::flight::state::{Answer, State};
use rtrb::{Consumer, Producer, RingBuffer};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Size of each ring: more than a second of states at 50 Hz, in case the publisher does not get the processor.
pub(super) const ROOM: usize = 64;

/// The loop's side. It may outlive the link, and the link may outlive it.
#[derive(Debug)]
pub struct Mailbox {
    commands: Consumer<Command>,
    /// A stop for which the ring had no space.
    stop: Arc<AtomicBool>,
    answers: Producer<Answer>,
    states: Producer<State>,
    counters: Arc<Counters>,
}

/// The network's side of the commands.
pub(super) struct Inbox {
    ring: Producer<Command>,
    stop: Arc<AtomicBool>,
    counters: Arc<Counters>,
}

impl Inbox {
    /// Passes a command on. False: the ring is full, and the command is not a stop.
    pub(super) fn push(&mut self, command: Command) -> bool {
        let kept = self.ring.push(command).is_ok();
        if !kept && command == Command::Stop && self.stop.swap(true, Relaxed) {
            forgotten(&self.counters);
        }
        kept || command == Command::Stop
    }

    /// Whether the loop's side is gone.
    pub(super) fn is_abandoned(&self) -> bool {
        self.ring.is_abandoned()
    }
}

/// Counts a discarded command and its missing reply.
fn forgotten(counters: &Counters) {
    count(&counters.busy);
    count(&counters.dropped);
}

/// The other sides: commands belong to the network's thread, the rest to the publisher's.
pub(super) struct FarEnd {
    pub(super) commands: Inbox,
    pub(super) answers: Consumer<Answer>,
    pub(super) states: Consumer<State>,
}

impl Mailbox {
    pub(super) fn new(counters: Arc<Counters>) -> (Self, FarEnd) {
        let (command_in, commands) = RingBuffer::new(ROOM);
        let (answers, answer_out) = RingBuffer::new(ROOM);
        let (states, state_out) = RingBuffer::new(ROOM);
        let stop = Arc::<AtomicBool>::default();
        let inbox = Inbox { ring: command_in, stop: Arc::clone(&stop), counters: Arc::clone(&counters) };
        let far = FarEnd { commands: inbox, answers: answer_out, states: state_out };
        (Self { commands, stop, answers, states, counters }, far)
    }

    /// A mailbox with commands in it, and no other side.
    #[cfg(test)]
    pub(crate) fn holding(commands: impl IntoIterator<Item = Command>) -> Self {
        let (mailbox, mut far) = Self::new(Arc::default());
        commands.into_iter().for_each(|command| assert!(far.commands.push(command), "no room for {command:?}"));
        mailbox
    }
}

impl Commander for Mailbox {
    fn try_command(&mut self) -> Option<Command> {
        if self.stop.swap(false, Relaxed) {
            for _ in (0..ROOM).map_while(|_| self.commands.pop().ok()) {
                forgotten(&self.counters);
            }
            return Some(Command::Stop);
        }
        self.commands.pop().ok()
    }

    fn answer(&mut self, answer: Answer) {
        if self.answers.push(answer).is_err() {
            count(&self.counters.dropped);
        }
    }

    fn publish_state(&mut self, state: State) {
        if self.states.push(state).is_err() {
            count(&self.counters.dropped);
        }
    }

    fn is_heard(&self) -> bool {
        self.counters.connected.load(Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::{Commander, Mailbox, ROOM};
    use crate::flight::command::Command;
    use std::sync::Arc;

    #[test]
    fn a_stop_gets_through_a_flood_and_nothing_that_waited_is_obeyed_after_it() {
        let (mut mailbox, mut far) = Mailbox::new(Arc::default());
        for _ in 0..ROOM {
            assert!(far.commands.push(Command::Fly));
        }
        assert!(!far.commands.push(Command::Fly));
        assert!(far.commands.push(Command::Stop));
        assert_eq!(mailbox.try_command(), Some(Command::Stop));
        assert_eq!(mailbox.try_command(), None);
        assert!(far.commands.push(Command::Fly));
        assert_eq!(mailbox.try_command(), Some(Command::Fly));
    }

    #[test]
    fn a_stop_that_finds_room_keeps_its_place() {
        let (mut mailbox, mut far) = Mailbox::new(Arc::default());
        for command in [Command::Setpoint(300.0), Command::Stop, Command::Fly] {
            assert!(far.commands.push(command));
        }
        let taken: Vec<Command> = std::iter::from_fn(|| mailbox.try_command()).collect();
        assert_eq!(taken, [Command::Setpoint(300.0), Command::Stop, Command::Fly]);
    }
}
