//! A flight as its MCAP file tells it, up to the last whole message.

use super::{
    LogError,
    header::{ABOUT, About, CONFIG, TOML},
    record::{Cycle, EventMessage},
    records::{Damage, walk},
    writer::{CYCLE, EVENT},
};
use mcap::{MAGIC, records::Record};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// What is in a file, however short the flight was.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flight {
    /// What the file says about itself.
    pub about: About,
    /// The config that was in force.
    pub config_toml: Option<String>,
    /// The control periods.
    pub cycles: Vec<Cycle>,
    /// The events.
    pub events: Vec<EventMessage>,
    /// What is missing, in words and numbers, if anything is.
    pub truncated: Option<String>,
}

/// Reads an MCAP file; also one with too few readings to be a recording.
///
/// # Errors
/// [`LogError`] if the file cannot be read or has no readable cycle.
pub fn read(path: &Path) -> Result<Flight, LogError> {
    let bytes = fs::read(path).map_err(|source| LogError::Open { path: path.into(), source })?;
    match bytes.as_slice() {
        [] => Err(LogError::Empty { path: path.into() }),
        _ if is_mcap(&bytes) => parse(path, &bytes),
        _ => no_cycles(path, "it is no MCAP file (the first bytes are not its magic number)".into()),
    }
}

/// Whether these are the first bytes of an MCAP file, be it cut within its magic number.
pub(super) fn is_mcap(bytes: &[u8]) -> bool {
    !bytes.is_empty() && (bytes.starts_with(MAGIC) || MAGIC.starts_with(bytes))
}

/// Reads the bytes of an MCAP file; `path` is only its name in messages.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Flight, LogError> {
    let mut gathered = Gathered::default();
    let damage = walk(bytes, &mut |record| gathered.take(record));
    if gathered.flight.cycles.is_empty() {
        return no_cycles(path, gathered.why_none(damage, bytes.len()));
    }
    let truncated = gathered.missing(damage, bytes.len());
    Ok(Flight { truncated, ..gathered.flight })
}

fn no_cycles<T>(path: &Path, cause: String) -> Result<T, LogError> {
    Err(LogError::NoCycles { path: path.into(), cause })
}

/// A flight while it is being read.
#[derive(Default)]
struct Gathered {
    flight: Flight,
    topics: BTreeMap<u16, String>,
    misunderstood: Option<String>,
    misunderstood_count: usize,
}

impl Gathered {
    fn take(&mut self, record: Record<'_>) {
        match record {
            Record::Channel(channel) => drop(self.topics.insert(channel.id, channel.topic)),
            Record::Message { header, data } => {
                let understood = match self.topics.get(&header.channel_id).map(String::as_str) {
                    Some(CYCLE) => serde_json::from_slice(&data).map(|cycle| self.flight.cycles.push(cycle)),
                    Some(EVENT) => serde_json::from_slice(&data).map(|event| self.flight.events.push(event)),
                    _ => Ok(()),
                };
                if let Err(error) = understood {
                    self.misunderstood_count += 1;
                    self.misunderstood.get_or_insert(error.to_string());
                }
            }
            Record::Metadata(record) if record.name == ABOUT => self.flight.about = About::from(&record.metadata),
            Record::Metadata(mut record) if record.name == CONFIG => {
                self.flight.config_toml = record.metadata.remove(TOML);
            }
            _ => {}
        }
    }

    fn why_none(&self, damage: Option<Damage>, file_bytes: usize) -> String {
        if let Some(error) = &self.misunderstood {
            return format!("its {} messages are not cycles of airball, the first: {error}", self.misunderstood_count);
        }
        let topics: BTreeSet<&str> = self.topics.values().map(String::as_str).collect();
        match damage {
            Some(Damage { at_byte, cause, .. }) => format!("at byte {at_byte} of {file_bytes}, {cause}"),
            None if topics.is_empty() => "it has no channels".into(),
            None => format!("its channels are {}", Vec::from_iter(topics).join(", ")),
        }
    }

    fn missing(&self, damage: Option<Damage>, file_bytes: usize) -> Option<String> {
        let cycles = &self.flight.cycles;
        let until_s = cycles.last().map_or(0.0, |cycle| cycle.time_s);
        let read = format!("read were {} cycles up to {until_s:.2} s", cycles.len());
        if let Some(Damage { at_byte, cause, records }) = damage {
            let count = if records == 1 { String::new() } else { format!(" ({records} such places)") };
            return Some(format!("the log is not whole: at byte {at_byte} of {file_bytes}, {cause}{count}; {read}"));
        }
        let error = self.misunderstood.as_ref()?;
        let count = self.misunderstood_count;
        Some(format!("{count} messages of the log were left out, the first because of {error}; {read}"))
    }
}
