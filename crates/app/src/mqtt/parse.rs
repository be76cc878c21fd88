//! From a message's bytes to a [`Command`], or to a reason with what was received and what is expected.
//!
//! Only the form is checked here. The loop checks whether a setpoint is safe or a gain within its bounds.

use crate::flight::command::{Command, GainChange};
use crate::flight::name::Name;
use config::plain_words;
use config::topics::{ORIGINAL_GAINS, ORIGINAL_SETPOINT, Quantity, Topics};
use control::controller::Kind;
use control::numbers::{COUNT, Parameter, Values};

/// Longest payload that is parsed, bytes. The longest useful one, three gains, has about 80.
const LONGEST_PAYLOAD: usize = 256;
/// The same of numbers: all of them by their names have about 2,000, and the points of a predistortion 14,000.
const LONGEST_NUMBERS: usize = 24 * 1024;
/// Largest number of characters of a payload or topic in a reason.
const LONGEST_QUOTE: usize = 40;
/// Largest number of characters of a JSON error in a reason.
const LONGEST_WHY: usize = 160;

/// The content of a message.
#[expect(
    clippy::large_enum_variant,
    reason = "a box would allocate in the loop, and few commands are on their way at a time"
)]
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
    #[error("got {got} bytes, the longest command has {longest}; {expected}")]
    TooLong {
        /// Bytes in the payload.
        got: usize,
        /// Bytes of the longest that is parsed.
        longest: usize,
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
    let longest = if quantity == Quantity::Numbers { LONGEST_NUMBERS } else { LONGEST_PAYLOAD };
    if payload.len() > longest {
        return Err(ParseError::TooLong { got: payload.len(), longest, expected });
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
        Quantity::Gains if topic == ORIGINAL_GAINS => original_gains(text).map(Command::Gains).ok_or_else(|| {
            ParseError::Form { got: quoted(text), expected: "expected K_p, T_i and T_d, like 0.018,15,0.35" }
        }),
        Quantity::Gains => {
            gains(text).map(Command::Gains).map_err(|why| ParseError::Gains { got: quoted(text), why, expected })
        }
        Quantity::Numbers if text == "undo" => Ok(Command::Undo),
        Quantity::Numbers => {
            numbers(text).map(Command::Numbers).map_err(|why| ParseError::Gains { got: quoted(text), why, expected })
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
        Quantity::Numbers => {
            r#"expected undo, or JSON with names that the retained topic `about` lists, like {"lqg.fan":0.7,"observer.sensor_mm":3}"#
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
    let change: GainChange = serde_json::from_str(text).map_err(why)?;
    if change == GainChange::default() { Err("no gain is given".to_owned()) } else { Ok(change) }
}

/// K_p, T_i and T_d, the original rig's three numbers in a row.
fn original_gains(text: &str) -> Option<GainChange> {
    let mut numbers = text.split([',', ';', ' ']).filter(|part| !part.is_empty()).map(number);
    let change = GainChange { kp_per_mm: numbers.next()?, ti_s: numbers.next()?, td_s: numbers.next()? };
    let all = change.kp_per_mm.and(change.ti_s).and(change.td_s).is_some();
    (all && numbers.next().is_none()).then_some(change)
}

/// Why a payload is not JSON, in words of the files.
fn why(error: serde_json::Error) -> String {
    printable(&plain_words(&error.to_string()), LONGEST_WHY)
}

/// At least one number by name; the text "inf" is infinity, which JSON has no number for.
fn numbers(text: &str) -> Result<Values, String> {
    let given: serde_json::Map<String, serde_json::Value> = serde_json::from_str(text).map_err(why)?;
    let mut values = [None; COUNT];
    for (name, value) in &given {
        let place = Parameter::named(name).ok_or_else(|| format!("there is no number {}", quoted(name)))?;
        values[place] = Some(value_of(&Parameter::ALL[place], value)?);
    }
    if given.is_empty() { Err("no number is given".to_owned()) } else { Ok(values) }
}

/// The number or the word that a parameter is given.
fn value_of(parameter: &Parameter, given: &serde_json::Value) -> Result<f64, String> {
    let name = parameter.name;
    if parameter.words.is_empty() {
        let value = if given == "inf" { Some(f64::INFINITY) } else { given.as_f64() };
        return value.ok_or_else(|| format!("{name} is given no number"));
    }
    let said = given.as_str().and_then(|word| parameter.value_of(word));
    said.ok_or_else(|| format!("{name} is one of \"{}\"", parameter.words.join("\", \"")))
}

fn unknown(topics: &Topics, topic: &str) -> ParseError {
    let known = Quantity::ALL.map(Quantity::topic).join(", ");
    ParseError::Topic {
        topic: quoted(topics.short(topic)),
        known: format!("{known}, {ORIGINAL_SETPOINT} and {ORIGINAL_GAINS}"),
    }
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
mod tests;
