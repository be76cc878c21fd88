//! The thread that sends: takes answers and states from the loop's rings and puts them on the session's queue.
//!
//! It checks every 20 ms instead of being woken, because waking a thread is a system call, which the loop must not make
//! for it. Only `try_publish` is used: a broker that does not keep up loses messages, which are counted, and never
//! blocks anything. Without a session everything is discarded, so that no old message is sent.

use super::count::{Counters, count};
use super::line::{Line, RETAINED};
use super::mailbox::ROOM;
use super::message::{CyclesMessage, Reply, StateMessage};
use super::network::{Aside, What};
use super::owner::Owner;
use super::stream::Stream;
use crate::flight::state::{Answer, InForce, State};
use crate::flight::vocabulary::Fault;
use config::topics::{ORIGINAL_POSITION, Topics};
use rtrb::Consumer;
use rumqttc::PublishOptions;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

/// Time between two checks of the rings.
const TURN: Duration = Duration::from_millis(20);
/// Time between two published states.
const STATE_PERIOD: Duration = Duration::from_millis(100);

/// The state of the thread.
pub(super) struct Publisher {
    pub(super) topics: Arc<Topics>,
    pub(super) answers: Consumer<Answer>,
    pub(super) states: Consumer<State>,
    pub(super) asides: Receiver<Aside>,
    pub(super) line: Arc<Line>,
    pub(super) counters: Arc<Counters>,
    /// The loop's newest values, for replies without the loop.
    pub(super) in_force: Option<InForce>,
    /// Time of the next state to be published.
    pub(super) due: Instant,
    /// The stream of every cycle.
    pub(super) stream: Stream,
    /// The program.
    pub(super) owner: Box<dyn Owner>,
    /// The fault that the flight waits after, as told.
    pub(super) waits_after: Option<Fault>,
}

impl Publisher {
    /// Runs until the line is stopped, and then sends `offline`.
    pub(super) fn run(mut self) {
        while !self.line.stopping() {
            self.turn();
            thread::park_timeout(TURN);
        }
        self.turn();
        self.farewell();
    }

    /// Empties each ring once, up to its size, so that many messages in one do not delay the others.
    fn turn(&mut self) {
        let now = Instant::now();
        let owed = self.line.introduce(&self.topics);
        self.counters.connected.store(self.line.client().is_some(), Relaxed);
        if self.line.is_claiming() {
            return;
        }
        let said = (0..ROOM).map_while(|_| self.states.pop().ok());
        let newest = said.inspect(|state| self.stream.take(state.cycle, now)).last();
        if let Some(state) = newest {
            self.in_force = Some(state.in_force());
            self.tell_fault(state.stopped_by);
        }
        let in_force = self.in_force;
        let owed = owed.map(|Aside { topic, what }| match what {
            What::Refused(reason) => Reply { topic, accepted: false, in_force, reason: Some(reason) },
            What::Stream(_) => Reply { topic, accepted: true, in_force, reason: None },
        });
        for reply in owed.into_iter().chain(self.replies(now)) {
            self.send_json(&self.topics.reply, PublishOptions::at_least_once(), &reply);
        }
        if let Some(state) = newest {
            self.send_state(state);
        }
    }

    /// Publishes the fault that a flight waits after, once.
    fn tell_fault(&mut self, stopped_by: Option<Fault>) {
        if let (Some(fault), None) = (stopped_by, self.waits_after) {
            self.line.know(Some(&self.owner.waits_after(fault)));
            let sent = self.line.client().as_ref().is_none_or(|client| self.line.publish_fault(client, &self.topics));
            if !sent {
                count(&self.counters.dropped);
            }
        }
        self.waits_after = stopped_by;
    }

    /// The pending replies; refusals are counted, and requests for the stream are executed. A message that never
    /// reached the loop must be answered before a later command that the loop executed. Its refusal was queued before
    /// that command's answer, so that refusals are read after the answers and sent before them. In the opposite case
    /// the order is not defined: the loop answers at its next cycle.
    fn replies(&mut self, now: Instant) -> Vec<Reply> {
        let answers: Vec<_> = (0..ROOM).map_while(|_| self.answers.pop().ok()).collect();
        if let Some(newest) = answers.last() {
            self.in_force = Some(newest.in_force);
        }
        if let Some(numbers) = answers.iter().rev().find_map(|answer| answer.numbers) {
            self.line.know_numbers(&numbers, self.owner.critical_kp_per_mm(&numbers));
            let sent = self.line.client().as_ref().is_none_or(|client| self.line.publish_numbers(client, &self.topics));
            if !sent {
                count(&self.counters.dropped);
            }
        }
        let mut replies = Vec::new();
        for _ in 0..ROOM {
            let Ok(Aside { topic, what }) = self.asides.try_recv() else { break };
            let reason = match what {
                What::Refused(reason) => Some(reason),
                What::Stream(on) => {
                    self.stream.ask(on, now);
                    None
                }
            };
            replies.push(Reply { topic, accepted: reason.is_none(), in_force: self.in_force, reason });
        }
        answers.iter().filter(|answer| answer.refused.is_some()).for_each(|_| count(&self.counters.refused));
        replies.extend(answers.into_iter().map(Reply::from));
        replies
    }

    /// Publishes the state when it is due.
    fn send_state(&mut self, state: State) {
        let now = Instant::now();
        if now < self.due {
            return;
        }
        self.due = next(self.due, now);
        let message = StateMessage { state, link: self.counters.read() };
        self.send_json(&self.topics.state, PublishOptions::at_most_once(), &message);
        if let Some((cycles, dropped)) = self.stream.batch(now) {
            self.send_json(
                &self.topics.cycles,
                PublishOptions::at_most_once(),
                &CyclesMessage { cycles: &cycles, dropped },
            );
        }
        if let Some(position_mm) = state.cycle.position_mm {
            self.send(ORIGINAL_POSITION, PublishOptions::at_most_once(), format!("{position_mm:.1}"));
        }
    }

    fn send_json(&self, topic: &str, options: PublishOptions, message: &impl Serialize) {
        match serde_json::to_vec(message) {
            Ok(payload) => self.send(topic, options, payload),
            Err(_) => count(&self.counters.dropped),
        }
    }

    fn send(&self, topic: &str, options: PublishOptions, payload: impl Into<Vec<u8>>) {
        if let Some(client) = self.line.client().as_ref()
            && client.try_publish(topic, payload.into(), options).is_err()
        {
            count(&self.counters.dropped);
        }
    }

    /// Sends `offline` and disconnects. If the queue is full, the broker publishes the last will at the end of the
    /// connection.
    fn farewell(&self) {
        self.line.leave_unsaid();
        let held = self.line.client();
        let Some(client) = held.as_ref() else { return };
        // Where another program flies our name, it is not offline.
        let told = self.line.claim.other().is_some()
            || (self.line.publish_fault(client, &self.topics)
                && client.try_publish(&self.topics.status, "offline", RETAINED).is_ok());
        if told {
            let _ = client.try_disconnect();
        }
    }
}

/// Time of the state after the present one: on a grid that does not drift with the checks, without catching up after a
/// gap.
fn next(due: Instant, now: Instant) -> Instant {
    (due + STATE_PERIOD).max(now)
}

#[cfg(test)]
mod tests {
    use super::{Arc, Aside, Duration, Instant, Line, Publisher, ROOM, STATE_PERIOD, Stream, Topics, What, next};
    use crate::flight::command::Command;
    use crate::flight::outside::Commander;
    use crate::flight::state::Answer;
    use crate::mqtt::claim::Claim;
    use crate::mqtt::link_support::{about, in_force};
    use crate::mqtt::mailbox::Mailbox;
    use crate::mqtt::owner::Nobody;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn a_late_state_does_not_shift_the_next_and_a_silence_is_not_made_up_for() {
        let due = Instant::now();
        assert_eq!(next(due, due + Duration::from_millis(19)), due + STATE_PERIOD);
        assert_eq!(next(due, due + Duration::from_secs(60)), due + Duration::from_secs(60));
    }

    #[test]
    fn a_refusal_without_the_loop_is_told_before_what_the_loop_obeyed_after_it() {
        let (mut mailbox, far) = Mailbox::new(Arc::default());
        let (aside, asides) = sync_channel(ROOM);
        let mut publisher = Publisher {
            topics: Arc::new(Topics::new("rig1").unwrap()),
            answers: far.answers,
            states: far.states,
            asides,
            line: Arc::new(Line::new(&about(), Claim::new(Arc::default()))),
            counters: Arc::default(),
            in_force: None,
            due: Instant::now(),
            stream: Stream::default(),
            owner: Box::new(Nobody),
            waits_after: None,
        };
        aside.send(Aside { topic: "set/#".into(), what: What::Refused("too large".into()) }).unwrap();
        mailbox.answer(Answer { command: Command::Stop, refused: None, in_force: in_force(1.0), numbers: None });
        let replies = publisher.replies(Instant::now());
        let told: Vec<_> = replies.iter().map(|reply| (reply.topic.as_str(), reply.accepted)).collect();
        assert_eq!(told, [("set/#", false), ("set/mode", true)]);
        assert!(replies.iter().all(|reply| reply.in_force == Some(in_force(1.0))));
    }
}
