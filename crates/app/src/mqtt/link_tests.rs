//! Tests of the link with a real broker, through a second client.

use super::about::About;
use super::link::{Endpoint, Link};
use super::link_support::{MODE, REPLY, SETPOINT, STATE, STATUS, about, connected, in_force, obey, start, state};
use super::mailbox::ROOM;
use super::owner::Nobody;
use super::test_broker::{Broker, Cable, Outside, PATIENCE, config, until};
use crate::flight::command::{Command, Refusal};
use crate::flight::outside::Commander;
use crate::flight::state::{Answer, State};
use crate::flight::vocabulary::Fault;
use config::mqtt::MqttConfig;
use config::topics::{ORIGINAL_POSITION, ORIGINAL_SETPOINT};
use control::numbers::COUNT;
use serde_json::json;
use std::net::TcpListener;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::{Duration, Instant};

#[test]
fn a_setpoint_arrives_and_what_is_in_force_is_replied() {
    let (_broker, outside, _link, mut mailbox) = connected();
    for topic in [SETPOINT, ORIGINAL_SETPOINT] {
        outside.say(topic, "300");
        assert_eq!(obey(&mut mailbox, None), Command::Setpoint(300.0));
        let in_force = json!({
            "setpoint_mm": 300.0, "controller": "pid", "kp_per_mm": 0.01, "ti_s": 3.0, "td_s": 0.5, "mode": "flying",
            "experiment": null
        });
        let reply = json!({"topic": "set/setpoint_mm", "accepted": true, "in_force": in_force, "reason": null});
        assert_eq!(outside.json(REPLY), reply);
    }
}

#[test]
fn what_the_loop_refuses_is_replied_with_its_reason_and_counted() {
    let (_broker, outside, link, mut mailbox) = connected();
    outside.say(MODE, "fly");
    obey(&mut mailbox, Some(Refusal::OpenLoop));
    let reply = outside.json(REPLY);
    assert_eq!((&reply["accepted"], &reply["reason"]), (&json!(false), &json!(Refusal::OpenLoop.to_string())));
    assert_eq!((link.counts().commands_received, link.counts().commands_refused), (1, 1));
}

#[test]
fn nonsense_never_reaches_the_loop_and_is_replied_with_the_reason_and_what_is_in_force() {
    let (_broker, outside, link, mut mailbox) = connected();
    mailbox.publish_state(state(0.0));
    outside.hear(STATE);
    outside.say(SETPOINT, "up");
    let reply = outside.json(REPLY);
    assert_eq!(reply["topic"], "set/setpoint_mm");
    assert!(reply["reason"].as_str().unwrap().contains("got \"up\""), "{reply}");
    assert_eq!(reply["in_force"]["setpoint_mm"], 250.0);
    outside.say("airball/rig1/set/height", "300");
    assert!(outside.json(REPLY)["reason"].as_str().unwrap().contains("set/setpoint_mm"));
    assert_eq!(mailbox.try_command(), None);
    assert_eq!(link.counts().commands_refused, 2);
}

#[test]
fn the_state_goes_out_ten_times_a_second_however_often_the_loop_says_it() {
    let (_broker, outside, _link, mut mailbox) = connected();
    let began = Instant::now();
    while began.elapsed() < Duration::from_millis(1500) {
        mailbox.publish_state(state(began.elapsed().as_secs_f64()));
        thread::sleep(Duration::from_millis(5));
    }
    let message = outside.json(STATE);
    for (key, value) in [("position_mm", json!(248.25)), ("mode", json!("flying")), ("ti_s", json!(3.0))] {
        assert_eq!(message[key], value, "{message}");
    }
    assert_eq!((&message["late_cycles"], &message["commands_received"]), (&json!(2), &json!(0)));
    assert_eq!(outside.hear(ORIGINAL_POSITION), "248.2");
    let times: Vec<f64> = (0..10).map(|_| outside.json(STATE)["time_s"].as_f64().unwrap()).collect();
    let span = times[9] - times[0];
    assert!(span > 0.8, "ten states in {span} s, of 180 that the loop said");
}

#[test]
fn every_cycle_is_published_once_asked_for_and_the_asking_is_answered() {
    let (_broker, outside, _link, mut mailbox) = connected();
    outside.say("airball/rig1/set/stream", "full");
    assert_eq!(outside.json(REPLY), json!({"topic": "set/stream", "accepted": true, "in_force": null, "reason": null}));
    let said: Vec<f64> = (0..50).map(f64::from).collect();
    for time_s in &said {
        mailbox.publish_state(state(*time_s));
        thread::sleep(Duration::from_millis(10));
    }
    let mut heard = Vec::new();
    while heard.len() < 30 {
        let message = outside.json("airball/rig1/cycles");
        assert_eq!(message["dropped"], 0);
        heard.extend(message["cycles"].as_array().unwrap().iter().map(|cycle| cycle["time_s"].as_f64().unwrap()));
    }
    assert_eq!(heard, said[..heard.len()]);
}

#[test]
fn what_the_rig_is_stays_with_the_broker_for_those_who_come_later() {
    let (broker, _, _link, _mailbox) = connected();
    let late = Outside::on(broker.port).message("airball/rig1/about");
    assert!(late.retain);
    assert_eq!(serde_json::from_slice::<About>(&late.payload).unwrap(), about());
}

#[test]
fn a_cut_connection_leaves_offline_by_last_will_where_online_was_retained() {
    let broker = Broker::start();
    let cable = Cable::to(broker.port);
    let outside = Outside::on(broker.port);
    let _link = start(&config(cable.port));
    assert_eq!(outside.hear(STATUS), "online");
    let late = Outside::on(broker.port).message(STATUS);
    assert!(late.retain && late.payload == "online");
    cable.cut();
    assert_eq!(outside.hear(STATUS), "offline");
    assert!(Outside::on(broker.port).message(STATUS).retain);
}

#[test]
fn of_two_that_fly_one_name_the_later_gives_way_and_leaves_no_trace_on_the_broker() {
    let (broker, outside, first, mut mailbox) = connected();
    let lands = Arc::default();
    let (second, _mailbox) =
        Link::start(&Endpoint::Broker(&broker.config()), &about(), None, &lands, Box::new(Nobody)).unwrap();
    second.wait_for_others();
    assert!(second.other().is_some() && lands.load(Relaxed));
    second.stop(None);
    assert_eq!(first.other(), None);
    // What the later one would have said comes before this.
    outside.say(SETPOINT, "300");
    obey(&mut mailbox, None);
    assert_eq!(outside.json(REPLY)["accepted"], true);
    let late = Outside::on(broker.port).message(STATUS);
    assert!(late.retain && late.payload == "online");
}

#[test]
fn stopping_sends_the_last_answer_and_offline_before_it_leaves() {
    let (broker, outside, link, mut mailbox) = connected();
    mailbox.answer(Answer { command: Command::Stop, refused: None, in_force: in_force(1.0), numbers: None });
    link.stop(None);
    assert_eq!(outside.json(REPLY)["topic"], "set/mode");
    assert_eq!(outside.hear(STATUS), "offline");
    assert_eq!(Outside::on(broker.port).hear(STATUS), "offline");
}

#[test]
fn a_broker_that_comes_back_is_subscribed_to_again_and_what_was_said_meanwhile_is_no_loss() {
    let (mut broker, _, link, mut mailbox) = connected();
    broker.kill();
    until("the lost broker", || (!mailbox.is_heard()).then_some(()));
    mailbox.publish_state(state(0.0));
    thread::sleep(Duration::from_millis(100));
    assert_eq!(link.counts().dropped_mqtt_messages, 0);
    broker.restart();
    let outside = Outside::on(broker.port);
    assert_eq!(outside.hear(STATUS), "online");
    outside.say(SETPOINT, "123");
    assert_eq!(obey(&mut mailbox, None), Command::Setpoint(123.0));
    assert_eq!(outside.json(REPLY)["accepted"], true);
}

#[test]
fn without_a_broker_the_link_starts_takes_states_without_loss_and_stops() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let (link, mut mailbox) = start(&config(port));
    for _ in 0..ROOM {
        mailbox.publish_state(state(0.0));
        assert_eq!(mailbox.try_command(), None);
    }
    assert_eq!(link.counts().dropped_mqtt_messages, 0);
    thread::sleep(Duration::from_millis(700));
    assert_eq!(link.stop(None).dropped_mqtt_messages, 0);
}

#[test]
fn a_broker_that_hangs_up_is_not_hammered() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    listener.set_nonblocking(true).unwrap();
    let _link = start(&config(port));
    let began = Instant::now();
    let mut calls = 0;
    // Until the link connects again, which takes longer on a busy machine.
    while began.elapsed() < Duration::from_millis(1200) || (calls < 2 && began.elapsed() < PATIENCE) {
        calls += usize::from(listener.accept().is_ok());
        thread::sleep(Duration::from_millis(5));
    }
    assert!((2..=3).contains(&calls), "{calls} calls, expected them at 0, 0.2 and 0.6 s");
}

#[test]
fn a_broker_that_says_nothing_does_not_hold_up_stopping() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (link, _mailbox) = start(&config(listener.local_addr().unwrap().port()));
    let (silent, _) = listener.accept().unwrap();
    let (done, stopped) = mpsc::channel();
    thread::spawn(move || done.send(link.stop(None)));
    // The client's own timeout is five seconds; the link's is one.
    assert!(stopped.recv_timeout(Duration::from_secs(4)).is_ok(), "still waiting for a broker that says nothing");
    drop(silent);
}

#[test]
fn a_flood_fills_the_mailbox_once_and_the_rest_is_replied_as_busy() {
    let (_broker, outside, link, mut mailbox) = connected();
    for mm in 0..=ROOM {
        outside.say(SETPOINT, mm.to_string());
    }
    assert!(outside.json(REPLY)["reason"].as_str().unwrap().contains("busy"));
    assert_eq!(std::iter::from_fn(|| mailbox.try_command()).count(), ROOM);
    assert_eq!(link.counts().commands_busy, 1);
}

#[test]
fn a_retained_command_is_refused_because_it_was_meant_for_another_moment() {
    let broker = Broker::start();
    let outside = Outside::on(broker.port);
    outside.say_retained(MODE, "fly");
    let (_link, mut mailbox) = start(&broker.config());
    assert!(outside.json(REPLY)["reason"].as_str().unwrap().contains("retained"));
    assert_eq!(mailbox.try_command(), None);
}

#[test]
fn a_command_after_the_flight_is_replied_as_such() {
    let (_broker, outside, _link, mailbox) = connected();
    drop(mailbox);
    outside.say(SETPOINT, "300");
    assert_eq!(outside.json(REPLY)["reason"], "the flight is over");
}

#[test]
fn a_broker_that_asks_for_a_user_gets_the_password_from_its_file() {
    let broker = Broker::with_user("rig", "s3cret");
    let outside = Outside::with_login(broker.port, Some(("rig", "s3cret")));
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), "s3cret\n").unwrap();
    let login = MqttConfig { user: Some("rig".into()), password_file: Some(file.path().into()), ..broker.config() };
    let _link = start(&login);
    assert_eq!(outside.hear(STATUS), "online");
}

#[test]
fn a_fault_that_a_flight_waits_after_is_published_once_and_the_next_one_again() {
    let (_broker, outside, _link, mut mailbox) = connected();
    let stopped = |mm| {
        let fault = Fault::NoBall { reported_mm: mm };
        State { fault: Some(fault), stopped_by: Some(fault), ..state(1.0) }
    };
    let told = || outside.json("airball/rig1/fault")["fault"].as_str().unwrap().to_owned();
    (0..3).for_each(|_| mailbox.publish_state(stopped(8190)));
    assert!(told().contains("8190"));
    mailbox.publish_state(state(2.0));
    outside.hear(STATE);
    thread::sleep(Duration::from_millis(60));
    mailbox.publish_state(stopped(8191));
    assert!(told().contains("8191"));
}

#[test]
fn the_critical_gain_is_told_and_told_again_where_numbers_change() {
    let (_broker, outside, _link, mut mailbox) = connected();
    assert_eq!(outside.hear("airball/rig1/critical_kp_per_mm"), "null");
    let mut numbers = [None; COUNT];
    numbers[0] = Some(0.02);
    mailbox.answer(Answer { command: Command::Undo, refused: None, in_force: in_force(300.0), numbers: Some(numbers) });
    assert_eq!(outside.hear("airball/rig1/critical_kp_per_mm"), "0.12");
}

#[test]
fn somebody_can_send_commands_while_a_broker_is_there() {
    let (mut broker, _outside, _link, mailbox) = connected();
    until("it is heard", || mailbox.is_heard().then_some(()));
    broker.kill();
    until("it is not", || (!mailbox.is_heard()).then_some(()));
}
