//! The thread that speaks: takes answers and states from the loop's rings and puts them on the session's queue.
//!
//! It looks every 20 ms instead of being woken, because waking a thread is a system call and the loop is to make
//! none on its account. Only `try_publish` is used: a broker that does not keep up loses messages, counted, and
//! never holds anybody up. Without a session everything is thrown away, so that nothing is told late.

use super::count::{Counters, count};
use super::mailbox::ROOM;
use super::message::{CyclesMessage, Reply, StateMessage};
use super::network::{Aside, Line, What};
use super::stream::Stream;
use crate::config::topics::{ORIGINAL_POSITION, Topics};
use crate::flight::state::{Answer, InForce, State};
use rtrb::Consumer;
use rumqttc::QoS;
use serde::Serialize;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

/// Between two looks into the rings.
const TURN: Duration = Duration::from_millis(20);
/// Between two states on the broker.
const STATE_PERIOD: Duration = Duration::from_millis(100);

/// The thread's belongings.
pub(super) struct Publisher {
    pub(super) topics: Arc<Topics>,
    pub(super) answers: Consumer<Answer>,
    pub(super) states: Consumer<State>,
    pub(super) asides: Receiver<Aside>,
    pub(super) line: Arc<Line>,
    pub(super) counters: Arc<Counters>,
    /// The newest that the loop said, for replies that it has no part in.
    pub(super) in_force: Option<InForce>,
    /// When the next state is to be published.
    pub(super) due: Instant,
    /// Who wants every cycle.
    pub(super) stream: Stream,
}

impl Publisher {
    /// Runs until the line is told to stop, and then says goodbye.
    pub(super) fn run(mut self) {
        while !self.line.stopping() {
            self.turn();
            thread::park_timeout(TURN);
        }
        self.turn();
        self.farewell();
    }

    /// One look into each ring, no longer than its room, so that a flood in one does not starve the others.
    fn turn(&mut self) {
        let now = Instant::now();
        let said = (0..ROOM).map_while(|_| self.states.pop().ok());
        let newest = said.inspect(|state| self.stream.take(state.cycle, now)).last();
        if let Some(state) = newest {
            self.in_force = Some(state.in_force());
        }
        for reply in self.replies(now) {
            self.send_json(&self.topics.reply, QoS::AtLeastOnce, &reply);
        }
        if let Some(state) = newest {
            self.send_state(state);
        }
    }

    /// What is to be replied; refusals are counted, and who asked for the stream has it. A message that never reached
    /// the loop is answered before a later one that the loop obeyed: its refusal was here before that one's answer, so
    /// that it is looked for after the answers are taken, and told before them. The other way round nothing is
    /// promised: the loop answers at its next cycle.
    fn replies(&mut self, now: Instant) -> Vec<Reply> {
        let answers: Vec<_> = (0..ROOM).map_while(|_| self.answers.pop().ok()).collect();
        if let Some(newest) = answers.last() {
            self.in_force = Some(newest.in_force);
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

    /// Publishes the state if it is time.
    fn send_state(&mut self, state: State) {
        let now = Instant::now();
        if now < self.due {
            return;
        }
        self.due = next(self.due, now);
        let message = StateMessage { state, link: self.counters.read() };
        self.send_json(&self.topics.state, QoS::AtMostOnce, &message);
        if let Some((cycles, dropped)) = self.stream.batch(now) {
            self.send_json(&self.topics.cycles, QoS::AtMostOnce, &CyclesMessage { cycles: &cycles, dropped });
        }
        if let Some(position_mm) = state.cycle.position_mm {
            self.send(ORIGINAL_POSITION, QoS::AtMostOnce, format!("{position_mm:.1}"));
        }
    }

    fn send_json(&self, topic: &str, qos: QoS, message: &impl Serialize) {
        match serde_json::to_vec(message) {
            Ok(payload) => self.send(topic, qos, payload),
            Err(_) => count(&self.counters.dropped),
        }
    }

    fn send(&self, topic: &str, qos: QoS, payload: impl Into<Vec<u8>>) {
        if let Some(client) = self.line.client().as_ref()
            && client.try_publish(topic, qos, false, payload).is_err()
        {
            count(&self.counters.dropped);
        }
    }

    /// Says `offline` and leaves properly. Where the queue is full, the last will says it when the connection ends.
    fn farewell(&self) {
        if let Some(client) = self.line.client().as_ref()
            && self.line.publish_fault(client, &self.topics)
            && client.try_publish(&self.topics.status, QoS::AtLeastOnce, true, "offline").is_ok()
        {
            let _ = client.try_disconnect();
        }
    }
}

/// When the state after the one that was due, and is sent now, is due: on a raster that does not drift with the
/// turns, and without making up for a silence.
fn next(due: Instant, now: Instant) -> Instant {
    (due + STATE_PERIOD).max(now)
}

#[cfg(test)]
mod tests {
    use super::{Arc, Aside, Duration, Instant, Line, Publisher, ROOM, STATE_PERIOD, Stream, Topics, What, next};
    use crate::flight::command::Command;
    use crate::flight::outside::Commander;
    use crate::flight::state::Answer;
    use crate::mqtt::link_tests::{about, in_force};
    use crate::mqtt::mailbox::Mailbox;
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
            line: Arc::new(Line::new(&about())),
            counters: Arc::default(),
            in_force: None,
            due: Instant::now(),
            stream: Stream::default(),
        };
        aside.send(Aside { topic: "set/#".into(), what: What::Refused("too large".into()) }).unwrap();
        mailbox.answer(Answer { command: Command::Stop, refused: None, in_force: in_force(1.0) });
        let replies = publisher.replies(Instant::now());
        let told: Vec<_> = replies.iter().map(|reply| (reply.topic.as_str(), reply.accepted)).collect();
        assert_eq!(told, [("set/#", false), ("set/mode", true)]);
        assert!(replies.iter().all(|reply| reply.in_force == Some(in_force(1.0))));
    }
}
