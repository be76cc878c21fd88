//! Tests with messages that are too large, too many, or invalid.

use super::link_support::{MODE, REPLY, SETPOINT, STATUS, connected, in_force, obey, start};
use super::network::LARGEST_IN;
use super::test_broker::{Broker, Outside, until};
use crate::flight::command::Command;
use crate::flight::outside::Commander;
use crate::flight::state::Answer;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

const GAINS: &str = "airball/rig1/set/gains";

#[test]
fn a_megabyte_is_answered_and_the_connection_stays() {
    let (_broker, outside, link, mut mailbox) = connected();
    outside.say(SETPOINT, "3".repeat(1 << 20));
    assert!(outside.json(REPLY)["reason"].as_str().unwrap().contains("1048576 bytes"));
    outside.say(SETPOINT, "300");
    assert_eq!(obey(&mut mailbox, None), Command::Setpoint(300.0));
    assert_eq!(outside.json(REPLY)["accepted"], true);
    assert_eq!((link.counts().commands_received, link.counts().commands_refused), (2, 1));
}

#[test]
fn a_message_that_ends_the_connection_is_counted_and_answered_in_the_next_and_commands_work_again() {
    let (_broker, outside, link, mut mailbox) = connected();
    // Makes the connection old enough that the message does not count as retained.
    std::thread::sleep(super::hearing::SOON);
    outside.say(SETPOINT, "3".repeat(LARGEST_IN + 1));
    assert_eq!((outside.hear(STATUS), outside.hear(STATUS)), ("offline".into(), "online".into()));
    let reply = outside.json(REPLY);
    assert!(reply["topic"] == "set/#" && reply["reason"].as_str().unwrap().contains("ended the connection"), "{reply}");
    assert_eq!((link.counts().commands_received, link.counts().commands_refused), (1, 1));
    outside.say(SETPOINT, "300");
    assert_eq!(obey(&mut mailbox, None), Command::Setpoint(300.0));
}

#[test]
fn a_huge_message_that_the_broker_keeps_does_not_end_every_connection_and_stop_gets_through() {
    let broker = Broker::start();
    let outside = Outside::on(broker.port);
    outside.say_retained(GAINS, vec![b'7'; LARGEST_IN + 1]);
    let (_link, mut mailbox) = start(&broker.config());
    // The message may arrive before the first `online` is sent.
    until("the end of a connection", || (outside.hear(STATUS) == "offline").then_some(()));
    assert_eq!(outside.hear(STATUS), "online");
    outside.say(MODE, "stop");
    assert_eq!(obey(&mut mailbox, None), Command::Stop);
    assert_eq!(outside.hear(REPLY).matches("ended the connection").count(), 1);
    assert_eq!(outside.json(REPLY)["accepted"], true);
}

#[test]
fn a_huge_message_that_is_kept_as_the_mode_leaves_a_link_that_stays_and_only_speaks() {
    let broker = Broker::start();
    let outside = Outside::on(broker.port);
    outside.say_retained(MODE, vec![b'7'; LARGEST_IN + 1]);
    let (link, mut mailbox) = start(&broker.config());
    for _ in 0..2 {
        until("the end of a connection", || (outside.hear(STATUS) == "offline").then_some(()));
    }
    assert_eq!(outside.hear(STATUS), "online");
    mailbox.answer(Answer { command: Command::Stop, refused: None, in_force: in_force(1.0), numbers: None });
    until("the answer", || (outside.json(REPLY)["accepted"] == true).then_some(()));
    assert_eq!(link.counts().commands_refused, 2);
}

/// A number, a word, gains, or random bytes, sometimes long.
fn payload(random: &mut Pcg64) -> Vec<u8> {
    let draw = random.next_u32();
    let rubbish = |bytes: usize| draw.to_le_bytes().into_iter().cycle().take(bytes).collect();
    match draw % 8 {
        0 | 1 => format!("{}", draw % 1000).into_bytes(),
        2 => b"stop".to_vec(),
        3 => br#"{"kp_per_mm":0.01}"#.to_vec(),
        4 if draw.is_multiple_of(1000) => rubbish(50_000),
        4 => Vec::new(),
        _ => rubbish((draw % 300) as usize),
    }
}

#[test]
fn of_a_flood_every_message_is_answered_or_counted() {
    const SENT: u32 = 10_000;
    // Messages that the broker drops are not in our counts.
    let broker = Broker::with_access("allow_anonymous true\nmax_queued_messages 0");
    let outside = Outside::on(broker.port);
    let (link, mut mailbox) = start(&broker.config());
    assert_eq!(outside.hear(STATUS), "online");
    let mut random = Pcg64::seed_from_u64(1);
    let mut obeyed = 0;
    // As in a cycle: four commands at most, each answered.
    let mut cycle = || {
        for _ in 0..4 {
            let Some(command) = mailbox.try_command() else { return };
            obeyed += 1;
            mailbox.answer(Answer { command, refused: None, in_force: in_force(1.0), numbers: None });
        }
    };
    for k in 0..SENT {
        outside.say([SETPOINT, MODE, GAINS, "airball/rig1/set/nothing"][k as usize % 4], payload(&mut random));
        if k.is_multiple_of(100) {
            cycle();
        }
    }
    let mut replies = 0;
    while replies + link.counts().dropped_mqtt_messages < SENT {
        cycle();
        outside.message(REPLY);
        replies += 1;
    }
    let counts = link.stop(None);
    assert_eq!(counts.commands_received, SENT);
    assert_eq!(replies + counts.dropped_mqtt_messages, SENT, "{replies} replies, {counts:?}");
    assert_eq!(obeyed + counts.commands_refused + counts.commands_busy, SENT, "{obeyed} obeyed, {counts:?}");
}
