//! From a message's bytes to a [`Command`], or to a reason with what was received and what is expected.
//!
//! Only the form is checked here. The loop checks whether a setpoint is safe or a gain within its bounds.

use crate::config::plain_words;
use crate::config::topics::{ORIGINAL_SETPOINT, Quantity, Topics};
use crate::flight::command::{Command, GainChange};
use crate::flight::name::Name;
use control::controller::Kind;

/// Longest payload that is parsed, bytes. The longest useful one, three gains, has about 80.
const LONGEST_PAYLOAD: usize = 256;
/// Largest number of characters of a payload or topic in a reason.
const LONGEST_QUOTE: usize = 40;
/// Largest number of characters of a JSON error in a reason.
const LONGEST_WHY: usize = 160;

/// The content of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// A command for the loop.
    Loop(Command),
    /// Starts or ends the stream of every cycle.
    Stream(bool),
}

/// Why a message is not a command. The text is sent to its publisher.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParseError {
    /// There is no such topic.
    #[error("unknown command topic {topic}; known are {known}")]
    Topic {
        /// The topic, shortened.
        topic: String,
        /// The existing topics.
        known: String,
    },
    /// Retained by the broker from an earlier time.
    #[error("the command is retained and therefore refused; publish it without -r")]
    Retained,
    /// Too long to be parsed.
    #[error("got {got} bytes, the longest command has {LONGEST_PAYLOAD}; {expected}")]
    TooLong {
        /// Bytes in the payload.
        got: usize,
        /// What is expected, with an example.
        expected: &'static str,
    },
    /// Empty.
    #[error("got an empty message; {expected}")]
    Empty {
        /// What is expected, with an example.
        expected: &'static str,
    },
    /// Not of the expected form.
    #[error("got {got}; {expected}")]
    Form {
        /// The payload, shortened and printable.
        got: String,
        /// What is expected, with an example.
        expected: &'static str,
    },
    /// Invalid gains.
    #[error("got {got}: {why}; {expected}")]
    Gains {
        /// The payload, shortened and printable.
        got: String,
        /// What is wrong with it.
        why: String,
        /// What is expected, with an example.
        expected: &'static str,
    },
}

/// Reads a message.
///
/// # Errors
/// [`ParseError`] with the reason, as text for the sender.
pub fn parse(topics: &Topics, topic: &str, payload: &[u8]) -> Result<Asked, ParseError> {
    let quantity = topics.quantity(topic).ok_or_else(|| unknown(topics, topic))?;
    let expected = expected(quantity);
    if payload.len() > LONGEST_PAYLOAD {
        return Err(ParseError::TooLong { got: payload.len(), expected });
    }
    let form = || ParseError::Form { got: quoted(&String::from_utf8_lossy(payload)), expected };
    let text = std::str::from_utf8(payload).map_err(|_| form())?.trim();
    if text.is_empty() {
        return Err(ParseError::Empty { expected });
    }
    let command = match quantity {
        Quantity::Setpoint => number(text).map(Command::Setpoint).ok_or_else(form),
        Quantity::Controller => Kind::named(text).map(Command::Controller).ok_or_else(form),
        Quantity::Mode => mode(text).ok_or_else(form),
        Quantity::Experiment => Name::new(text).map(Command::Experiment).ok_or_else(form),
        Quantity::Gains => {
            gains(text).map(Command::Gains).map_err(|why| ParseError::Gains { got: quoted(text), why, expected })
        }
        Quantity::Stream => return stream(text).map(Asked::Stream).ok_or_else(form),
    };
    command.map(Asked::Loop)
}

/// What is expected, with an example.
const fn expected(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Setpoint => "expected a number of millimetres, like 300 or 300.5",
        Quantity::Gains => {
            r#"expected JSON with one or more of kp_per_mm, ti_s, td_s, like {"kp_per_mm":0.01,"ti_s":3}"#
        }
        Quantity::Controller => {
            "expected one of pid, cascade, state_feedback, lqg, mpc, open_loop that the config holds, like pid"
        }
        Quantity::Mode => "expected one of stop, fly, programme, like stop",
        Quantity::Experiment => "expected the name of an experiment that the retained topic `about` lists, like steps",
        Quantity::Stream => "expected full or off, like full",
    }
}

/// A finite number.
fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

fn mode(text: &str) -> Option<Command> {
    match text {
        "stop" => Some(Command::Stop),
        "fly" => Some(Command::Fly),
        "programme" => Some(Command::Programme),
        _ => None,
    }
}

fn stream(text: &str) -> Option<bool> {
    match text {
        "full" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// At least one gain by name. The JSON parser would accept a list, but the meaning of its order is not defined.
fn gains(text: &str) -> Result<GainChange, String> {
    if !text.starts_with('{') {
        return Err("not a JSON object".to_owned());
    }
    let change: GainChange =
        serde_json::from_str(text).map_err(|why| printable(&plain_words(&why.to_string()), LONGEST_WHY))?;
    if change == GainChange::default() { Err("no gain is given".to_owned()) } else { Ok(change) }
}

fn unknown(topics: &Topics, topic: &str) -> ParseError {
    let known = Quantity::ALL.map(Quantity::topic).join(", ");
    ParseError::Topic { topic: quoted(topics.short(topic)), known: format!("{known} and {ORIGINAL_SETPOINT}") }
}

/// The text in quotes, short and printable for every input.
fn quoted(text: &str) -> String {
    format!("\"{}\"", printable(text, LONGEST_QUOTE))
}

/// The first characters, with control characters replaced by �.
fn printable(text: &str, longest: usize) -> String {
    let mut short: String =
        text.chars().take(longest).map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect();
    if text.chars().nth(longest).is_some() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::{Asked, LONGEST_PAYLOAD, ParseError, parse};
    use crate::config::topics::{ORIGINAL_SETPOINT, Topics};
    use crate::flight::command::{Command, GainChange};
    use control::controller::Kind;
    use proptest::prelude::*;

    const SETPOINT: &str = "airball/rig1/set/setpoint_mm";
    const GAINS: &str = "airball/rig1/set/gains";
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
}
