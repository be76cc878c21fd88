//! MCAP files of other programs: their messages as a table with a column for each number, by topic and field.
//!
//! ```text
//! topic /cart, message {"y": 0.4, "joint": [1, 2]}  →  columns /cart.y, /cart.joint.0, /cart.joint.1
//! ```
//!
//! A row is a message of one topic, that of the position; the other columns hold what was heard last. Time counts from
//! the first message, by the clock of the recorder. Messages are JSON, or of ROS 2 in CDR, of the types in [`ros`].

mod ros;

use super::records::walk;
use super::writer::{CYCLE, EVENT};
use crate::log::LogError;
use crate::log::error::READABLE;
use mcap::records::Record;
use rows::Import;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The column of the time.
const TIME: &str = "time_s";
/// Elements of a list that become columns.
const LONGEST_LIST: usize = 64;
/// Most columns of a file.
const MOST_COLUMNS: usize = 4096;

/// What is known of a channel.
struct Channel {
    topic: String,
    encoding: String,
    schema: u16,
    /// Whether a message of it could not be read.
    is_unread: bool,
}

/// A message with its numbers.
struct Message {
    time_ns: u64,
    topic: usize,
    numbers: Vec<(usize, f64)>,
}

/// All numbers of a file.
#[derive(Default)]
struct Gathered {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    topics: Vec<String>,
    columns: Vec<String>,
    places: BTreeMap<String, usize>,
    messages: Vec<Message>,
}

/// A foreign MCAP file as a table.
pub(super) struct ForeignTable {
    pub(super) csv: Vec<u8>,
    /// A sentence about the channels with messages that could not be read.
    pub(super) unread: Option<String>,
}

/// The table of a foreign MCAP file as CSV, for an import that maps its columns, where there is one. `None`: it is a
/// flight of airball, or has no channel at all.
///
/// # Errors
/// [`LogError::Foreign`]: none of its channels can be read.
pub(super) fn table(path: &Path, bytes: &[u8], import: Option<&Import>) -> Option<Result<ForeignTable, LogError>> {
    let mut gathered = Gathered::default();
    walk(bytes, &mut |record| gathered.take(record));
    let is_ours = |channel: &Channel| [CYCLE, EVENT].contains(&channel.topic.as_str());
    if gathered.channels.is_empty() || gathered.channels.values().any(is_ours) {
        return None;
    }
    if gathered.columns.is_empty() {
        return Some(Err(LogError::Foreign { path: path.into(), channels: gathered.described(|_| true) }));
    }
    gathered.messages.sort_by_key(|message| message.time_ns);
    let unread = gathered.channels.values().any(|channel| channel.is_unread).then(|| {
        let channels = gathered.described(|channel| channel.is_unread);
        format!("messages of these channels could not be read: {channels}; {READABLE}")
    });
    Some(Ok(ForeignTable { csv: gathered.csv(import), unread }))
}

impl Gathered {
    fn take(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { header, .. } => drop(self.schemas.insert(header.id, header.name)),
            Record::Channel(channel) => {
                let (topic, encoding, schema) = (channel.topic, channel.message_encoding, channel.schema_id);
                self.channels.entry(channel.id).or_insert(Channel { topic, encoding, schema, is_unread: false });
            }
            Record::Message { header, data } => self.message(header.channel_id, header.log_time, &data),
            _ => {}
        }
    }

    fn message(&mut self, channel: u16, time_ns: u64, data: &[u8]) {
        let Some(Channel { topic, encoding, schema, is_unread }) = self.channels.get_mut(&channel) else { return };
        let topic = topic.clone();
        let value = match encoding.as_str() {
            "json" => serde_json::from_slice(data).ok(),
            "cdr" => self.schemas.get(schema).and_then(|name| ros::value(name, data)),
            _ => None,
        };
        *is_unread |= value.is_none();
        let mut numbers = Vec::new();
        flatten(&topic, &value.unwrap_or(Value::Null), &mut |name, number| {
            numbers.extend(self.column(name).map(|column| (column, number)));
        });
        if numbers.is_empty() {
            return;
        }
        let at = self.topics.iter().position(|known| *known == topic).unwrap_or_else(|| {
            self.topics.push(topic);
            self.topics.len() - 1
        });
        self.messages.push(Message { time_ns, topic: at, numbers });
    }

    /// The place of a column; a new one is added.
    fn column(&mut self, name: String) -> Option<usize> {
        if let Some(at) = self.places.get(&name) {
            return Some(*at);
        }
        let at = self.columns.len();
        (at < MOST_COLUMNS).then(|| {
            self.columns.push(name.clone());
            self.places.insert(name, at);
            at
        })
    }

    /// The topic whose messages are rows: that of the position, or the one with most messages.
    fn lead(&self, import: Option<&Import>) -> usize {
        let wanted = import.map(|import| import.position_mm.column.as_str()).and_then(|name| self.places.get(name));
        let of_column = |column: &usize| {
            let holds = |message: &&Message| message.numbers.iter().any(|(at, _)| at == column);
            self.messages.iter().find(holds).map(|message| message.topic)
        };
        let count = |topic: &usize| self.messages.iter().filter(|message| message.topic == *topic).count();
        // The first of several with as many.
        let most = || (0..self.topics.len()).rev().max_by_key(count);
        wanted.and_then(of_column).or_else(most).unwrap_or(0)
    }

    fn csv(&self, import: Option<&Import>) -> Vec<u8> {
        let lead = self.lead(import);
        let needed = import.map(|import| import.duty_percent.column.as_str()).and_then(|name| self.places.get(name));
        let first_ns = self.messages.first().map_or(0, |message| message.time_ns);
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing to memory does not fail.
        let _ = writer.write_record([TIME].into_iter().chain(self.columns.iter().map(String::as_str)));
        let mut held: Vec<Option<f64>> = vec![None; self.columns.len()];
        // What a row's own message does not hold was not read; only an input stays in force.
        let of_lead = self.messages.iter().filter(|message| message.topic == lead).flat_map(|message| &message.numbers);
        let own: BTreeSet<usize> = of_lead.map(|(column, _)| *column).filter(|column| needed != Some(column)).collect();
        for message in &self.messages {
            if message.topic == lead {
                own.iter().for_each(|column| held[*column] = None);
            }
            message.numbers.iter().for_each(|(column, number)| held[*column] = Some(*number));
            // Before its input is known, a row is of no use.
            if message.topic != lead || needed.is_some_and(|column| held[*column].is_none()) {
                continue;
            }
            let since_s = std::time::Duration::from_nanos(message.time_ns - first_ns).as_secs_f64();
            let cells = held.iter().map(|value| value.map(|value| value.to_string()).unwrap_or_default());
            let _ = writer.write_record([since_s.to_string()].into_iter().chain(cells));
        }
        writer.into_inner().unwrap_or_default()
    }

    /// Some channels with how their messages are written.
    fn described(&self, which: impl Fn(&&Channel) -> bool) -> String {
        let one = |channel: &Channel| {
            let schema = self.schemas.get(&channel.schema).map(|name| format!(" {name}")).unwrap_or_default();
            format!("{} ({}{schema})", rows::shown(&channel.topic), rows::shown(&channel.encoding))
        };
        self.channels.values().filter(which).take(20).map(one).collect::<Vec<_>>().join(", ")
    }
}

/// Every number in a value, by its path.
fn flatten(path: &str, value: &Value, each: &mut dyn FnMut(String, f64)) {
    match value {
        Value::Number(number) => number.as_f64().into_iter().for_each(|number| each(path.to_owned(), number)),
        Value::Bool(flag) => each(path.to_owned(), f64::from(u8::from(*flag))),
        Value::Array(values) => {
            let named = values.iter().take(LONGEST_LIST).enumerate();
            named.for_each(|(at, value)| flatten(&format!("{path}.{at}"), value, each));
        }
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| flatten(&format!("{path}.{name}"), value, each))
        }
        Value::Null | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests;
