//! Tests of `parse.rs`: what is understood, and the reasons for what is not.

use super::{Asked, LONGEST_PAYLOAD, Parameter, ParseError, parse};
use crate::flight::command::{Command, GainChange};
use config::topics::{ORIGINAL_GAINS, ORIGINAL_SETPOINT, Topics};
use control::controller::Kind;
use proptest::prelude::*;

const SETPOINT: &str = "airball/rig1/set/setpoint_mm";
const GAINS: &str = "airball/rig1/set/gains";
const NUMBERS: &str = "airball/rig1/set/numbers";
const MODE: &str = "airball/rig1/set/mode";

fn asked(topic: &str, payload: impl AsRef<[u8]>) -> Result<Asked, ParseError> {
    parse(&Topics::new("rig1").unwrap(), topic, payload.as_ref())
}

fn read(topic: &str, payload: impl AsRef<[u8]>) -> Result<Command, ParseError> {
    asked(topic, payload).map(|asked| match asked {
        Asked::Loop(command) => command,
        Asked::Stream(_) => panic!("{topic} asks nothing of the loop"),
    })
}

fn reason(topic: &str, payload: impl AsRef<[u8]>) -> String {
    read(topic, payload).unwrap_err().to_string()
}

#[test]
fn a_plain_number_is_a_setpoint_also_by_the_original_name() {
    assert_eq!(read(SETPOINT, "300"), Ok(Command::Setpoint(300.0)));
    assert_eq!(read(SETPOINT, " 300.5\n"), Ok(Command::Setpoint(300.5)));
    assert_eq!(read(ORIGINAL_SETPOINT, "2.5e2"), Ok(Command::Setpoint(250.0)));
}

#[test]
fn what_is_no_finite_number_is_refused_with_what_was_got_and_an_example() {
    for got in ["NaN", "inf", "-infinity", "1e999", "up", "300 mm", "300,5", "0x10", "[300]"] {
        let reason = reason(SETPOINT, got);
        assert!(reason.contains(got) && reason.contains("like 300"), "{reason}");
    }
    assert!(reason(SETPOINT, " \n").contains("empty"));
}

#[test]
fn a_long_or_binary_payload_makes_a_short_printable_reason() {
    let limit = "1".repeat(LONGEST_PAYLOAD);
    assert!(reason(SETPOINT, limit + "1").contains("257 bytes"));
    for payload in [b"\x00\x1b[2J\xff\xfe".to_vec(), "ž".repeat(128).into_bytes()] {
        let reason = reason(SETPOINT, payload);
        assert!(reason.chars().count() < 120 && !reason.chars().any(char::is_control), "{reason:?}");
    }
}

#[test]
fn the_three_words_are_the_modes_and_no_other_is() {
    assert_eq!(read(MODE, "stop\n"), Ok(Command::Stop));
    assert_eq!(read(MODE, "fly"), Ok(Command::Fly));
    assert_eq!(read(MODE, "programme"), Ok(Command::Programme));
    assert!(reason(MODE, "program").contains("stop, fly, programme"));
}

#[test]
fn an_experiment_is_asked_for_by_a_word_and_the_stream_by_two() {
    const EXPERIMENT: &str = "airball/rig1/set/experiment";
    const STREAM: &str = "airball/rig1/set/stream";
    assert!(matches!(read(EXPERIMENT, "steps\n"), Ok(Command::Experiment(name)) if name.as_str() == "steps"));
    assert!(reason(EXPERIMENT, "../etc/passwd").contains("`about` lists"));
    assert_eq!(asked(STREAM, "full"), Ok(Asked::Stream(true)));
    assert_eq!(asked(STREAM, "off"), Ok(Asked::Stream(false)));
    assert!(reason(STREAM, "on").contains("full or off"));
}

#[test]
fn every_controller_is_named_and_an_unknown_one_refused_with_all_of_them() {
    for kind in Kind::ALL {
        assert_eq!(read("airball/rig1/set/controller", kind.name()), Ok(Command::Controller(kind)));
        assert!(reason("airball/rig1/set/controller", "PID").contains(kind.name()));
    }
}

#[test]
fn gains_come_together_and_what_is_absent_stays() {
    let change = GainChange { kp_per_mm: Some(0.01), ti_s: Some(3.0), td_s: None };
    assert_eq!(read(GAINS, r#"{"kp_per_mm":0.01,"ti_s":3}"#), Ok(Command::Gains(change)));
}

#[test]
fn the_original_rigs_gains_are_three_numbers_in_a_row() {
    let change = GainChange { kp_per_mm: Some(0.018), ti_s: Some(15.0), td_s: Some(0.35) };
    for text in ["0.018,15,0.35", "0.018; 15; 0.35", " 0.018 15 0.35 "] {
        assert_eq!(asked(ORIGINAL_GAINS, text), Ok(Asked::Loop(Command::Gains(change))), "{text}");
    }
    for text in ["0.018,15", "0.018,15,0.35,1", "a,b,c", "0.018,inf,0.35"] {
        assert!(asked(ORIGINAL_GAINS, text).is_err(), "{text}");
    }
}

#[test]
fn numbers_are_given_by_name_and_infinity_as_a_text() {
    let at = |name: &str| Parameter::named(name).unwrap();
    let Ok(Asked::Loop(Command::Numbers(values))) = asked(NUMBERS, r#"{"lqg.fan":0.7,"pid.ti_s":"inf"}"#) else {
        panic!("refused")
    };
    assert_eq!((values[at("lqg.fan")], values[at("pid.ti_s")]), (Some(0.7), Some(f64::INFINITY)));
    assert_eq!(values.iter().flatten().count(), 2);
    assert_eq!(asked(NUMBERS, "undo"), Ok(Asked::Loop(Command::Undo)));
    for (text, why) in [
        ("{}", "no number is given"),
        (r#"{"lqg.fun":1}"#, "there is no number \"lqg.fun\""),
        (r#"{"lqg.fan":"much"}"#, "lqg.fan is given no number"),
        ("[1]", "expected a table"),
    ] {
        let reason = reason(NUMBERS, text);
        assert!(reason.contains(why), "{text}: {reason}");
    }
}

#[test]
fn an_unknown_gain_is_refused_with_the_known_ones() {
    let reason = reason(GAINS, r#"{"kp":0.01}"#);
    assert!(reason.contains("unknown key `kp`") && reason.contains("`td_s`"), "{reason}");
}

#[test]
fn gains_without_a_gain_a_name_or_a_finite_number_are_refused() {
    for got in ["{}", r#"{"ti_s":null}"#] {
        assert!(reason(GAINS, got).contains("no gain is given"));
    }
    assert!(reason(GAINS, "[0.01,3,0]").contains("not a JSON object"));
    assert!(read(GAINS, r#"{"ti_s":1e999}"#).is_err());
    assert!(read(GAINS, r#"{"ti_s":1,"ti_s":2}"#).is_err());
}

#[test]
fn an_unknown_topic_is_refused_with_the_known_ones() {
    let reason = reason("airball/rig1/set/setpoint", "300");
    assert!(reason.contains("\"set/setpoint\"") && reason.contains("set/setpoint_mm, set/gains"), "{reason}");
}

proptest! {
    #[test]
    fn no_payload_on_any_topic_panics_or_makes_a_number_that_is_not_finite(
        payload in prop::collection::vec(any::<u8>(), 0..300),
        topic in prop_oneof![Just(SETPOINT.to_owned()), Just(GAINS.to_owned()), Just(MODE.to_owned()), ".*"],
    ) {
        match read(&topic, payload) {
            Ok(Command::Setpoint(mm)) => prop_assert!(mm.is_finite()),
            Ok(_) => {}
            Err(why) => prop_assert!(!why.to_string().chars().any(char::is_control)),
        }
    }

    #[test]
    fn a_number_is_read_back_as_it_was_printed(mm in -1e9_f64..1e9) {
        prop_assert_eq!(read(SETPOINT, mm.to_string()), Ok(Command::Setpoint(mm)));
    }
}

#[test]
fn words_are_given_as_texts_and_another_one_is_refused_with_those_that_there_are() {
    let Ok(Command::Numbers(values)) = read(NUMBERS, r#"{"pid.derivative_on":"error","compensation.dead_zone":"on"}"#)
    else {
        panic!("no numbers");
    };
    let value = |name: &str| values[Parameter::named(name).unwrap()];
    assert_eq!((value("pid.derivative_on"), value("compensation.dead_zone")), (Some(1.0), Some(1.0)));
    for wrong in [r#""position""#, "1", "true", "null"] {
        let reason = reason(NUMBERS, format!(r#"{{"pid.derivative_on":{wrong}}}"#));
        assert!(reason.contains(r#"pid.derivative_on is one of "measurement", "error""#), "{reason}");
    }
}
