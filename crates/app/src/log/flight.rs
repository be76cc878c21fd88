//! A flight as read from its MCAP file, up to the last complete message.

use super::LogError;
use super::event::EventMessage;
use super::header::{ABOUT, About, CONFIG, TOML, is_intact};
use super::packed::unpacked;
use super::records::{Damage, has_chunk, walk};
use super::writer::{CYCLE, EVENT};
use crate::flight::vocabulary::Cycle;
use mcap::{MAGIC, records::Record};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// The content of a file, however short the flight was.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flight {
    /// The file's metadata.
    pub about: About,
    /// The config that was in force.
    pub config_toml: Option<String>,
    /// The control periods.
    pub cycles: Vec<Cycle>,
    /// The events.
    pub events: Vec<EventMessage>,
    /// What is missing, in words and numbers, if anything is.
    pub truncated: Option<String>,
    /// Nothing of the flight is missing: all that was written before its end, config included. A file without its
    /// summary can be complete; one that was cut between two chunks is not.
    pub complete: bool,
}

/// Reads an MCAP file; also one with too few readings to be a recording.
///
/// # Errors
/// [`LogError`] if the file cannot be read or has no readable cycle.
pub fn read(path: &Path) -> Result<Flight, LogError> {
    let bytes = fs::read(path).map_err(|source| LogError::Open { path: path.into(), source })?;
    if bytes.is_empty() {
        return Err(LogError::Empty { path: path.into() });
    }
    let bytes = unpacked(path, &bytes)?;
    if is_mcap(&bytes) {
        return parse(path, &bytes);
    }
    Err(LogError::NoCycles {
        path: path.into(),
        cause: "it is no MCAP file (the first bytes are not its magic number)".into(),
        advice: "name a flight that airball recorded; `airball diagnose` and `airball replay` read tables too",
    })
}

/// Whether these are the bytes of an MCAP file, even if it is cut or damaged within its magic number.
pub(super) fn is_mcap(bytes: &[u8]) -> bool {
    !bytes.is_empty() && (bytes.starts_with(MAGIC) || MAGIC.starts_with(bytes) || has_chunk(bytes))
}

/// Reads the bytes of an MCAP file; `path` is only its name in messages.
///
/// # Errors
/// [`LogError::NoCycles`] if there is no readable cycle in them.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Flight, LogError> {
    let mut gathered = Gathered::default();
    let damage = walk(bytes, &mut |record| gathered.take(record));
    if gathered.flight.cycles.is_empty() {
        return no_cycles(path, gathered.why_none(damage, bytes.len()));
    }
    // A lost chunk is no gap in the numbers of a channel that has no later message.
    let complete = gathered.is_complete() && !damage.as_ref().is_some_and(|damage| damage.of_messages);
    let truncated = gathered.missing(damage, bytes.len());
    Ok(Flight { truncated, complete, ..gathered.flight })
}

fn no_cycles<T>(path: &Path, cause: String) -> Result<T, LogError> {
    // The library's word for a chunk that it cannot unpack; airball itself packs with zstd.
    let advice = if cause.contains("nsupported compression") {
        "the flight may be whole: compress it with zstd (`mcap compress --compression zstd`)"
    } else {
        "record the flight again"
    };
    Err(LogError::NoCycles { path: path.into(), cause, advice })
}

/// A flight during reading.
#[derive(Default)]
struct Gathered {
    flight: Flight,
    topics: BTreeMap<u16, String>,
    /// Next expected message number of each channel, unless one has been missing.
    next: BTreeMap<u16, u32>,
    missing_messages: bool,
    spoilt_metadata: bool,
    misunderstood: Option<String>,
    misunderstood_count: usize,
}

impl Gathered {
    fn take(&mut self, record: Record<'_>) {
        match record {
            Record::Channel(channel) => drop(self.topics.insert(channel.id, channel.topic)),
            Record::Message { header, data } => {
                self.count(header.channel_id, header.sequence);
                self.message(header.channel_id, &data);
            }
            Record::Metadata(mut record) => match (record.name.as_str(), is_intact(&record.metadata)) {
                (ABOUT, true) => self.flight.about = About::from(&record.metadata),
                (CONFIG, true) => self.flight.config_toml = record.metadata.remove(TOML),
                (ABOUT | CONFIG, false) => self.spoilt_metadata = true,
                _ => {}
            },
            _ => {}
        }
    }

    /// Messages of a channel are numbered from 0.
    fn count(&mut self, channel: u16, sequence: u32) {
        let next = self.next.entry(channel).or_insert(0);
        self.missing_messages |= *next != sequence;
        *next = sequence.wrapping_add(1);
    }

    fn message(&mut self, channel: u16, data: &[u8]) {
        let flight = &mut self.flight;
        let understood = match self.topics.get(&channel).map(String::as_str) {
            Some(CYCLE) => serde_json::from_slice(data).map(|cycle| flight.cycles.push(cycle)),
            Some(EVENT) => serde_json::from_slice(data).map(|event| flight.events.push(event)),
            Some(_) => Ok(()),
            // The chunk that defined this channel was damaged. No message of ours can be parsed as one of the other
            // kind.
            None => {
                if let Ok(cycle) = serde_json::from_slice(data) {
                    flight.cycles.push(cycle);
                } else if let Ok(event) = serde_json::from_slice(data) {
                    flight.events.push(event);
                }
                Ok(())
            }
        };
        if let Err(error) = understood {
            self.misunderstood_count += 1;
            self.misunderstood.get_or_insert(error.to_string());
        }
    }

    /// Every message is there up to the last, which marks the end of the flight, and so is the metadata.
    fn is_complete(&self) -> bool {
        let ended = self.flight.events.last().is_some_and(|event| event.kind == "end");
        let described = self.flight.about.version.is_some() && self.flight.config_toml.is_some();
        ended && described && !self.missing_messages && self.misunderstood.is_none()
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
        if let Some(Damage { at_byte, cause, records, .. }) = damage {
            let count = if records == 1 { String::new() } else { format!(" ({records} such places)") };
            return Some(format!("the log is not whole: at byte {at_byte} of {file_bytes}, {cause}{count}; {read}"));
        }
        if self.spoilt_metadata {
            return Some(format!("what the log says of its flight, or its config, is damaged; {read}"));
        }
        let error = self.misunderstood.as_ref()?;
        let count = self.misunderstood_count;
        Some(format!("{count} messages of the log were left out, the first because of {error}; {read}"))
    }
}
