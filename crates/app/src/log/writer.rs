//! One MCAP file per flight: JSON messages with JSON Schema, in chunks compressed with zstd.
//!
//! ```text
//! log_time = wall clock at the start of the flight + time_s      nanoseconds
//! ```
//!
//! A chunk ends once a second of flight time and reaches the operating system complete, so that a killed program loses
//! about a second. It is not forced onto the disk: a power cut may lose more.

use super::event::EventMessage;
use super::header::{ABOUT, CONFIG, Header};
use super::{LogError, schema};
use crate::flight::vocabulary::{Cycle, Event};
use mcap::{Compression, McapError, McapResult, WriteOptions, records::MessageHeader, records::Metadata};
use serde::Serialize;
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{self, BufWriter, Seek, Write},
    path::{Path, PathBuf},
    time::{Duration, UNIX_EPOCH},
};

/// Topic of the cycles.
pub(super) const CYCLE: &str = "cycle";
/// Topic of the events.
pub(super) const EVENT: &str = "event";
/// Flight time from one flush to the next, seconds.
const FLUSH_EVERY_S: f64 = 1.0;
/// Uncompressed size at which a chunk ends even within the second, bytes.
const CHUNK_BYTES: u64 = 64 * 1024;

/// Writes a flight. Dropped without [`finish`](Self::finish) it tries to finish and ignores errors.
pub struct LogWriter<W: Write + Seek = BufWriter<File>> {
    path: PathBuf,
    mcap: mcap::Writer<W>,
    start: Duration,
    cycle: Channel,
    event: Channel,
    next_flush_s: f64,
}

/// A channel of the file and how many messages it has.
struct Channel {
    id: u16,
    messages: u64,
}

/// The result of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogSummary {
    /// The file.
    pub path: PathBuf,
    /// Cycles in it.
    pub cycles: u64,
    /// Events in it.
    pub events: u64,
    /// Cycles and events that were lost because the disk was too slow.
    pub dropped: u64,
}

impl LogWriter {
    /// Creates the file, and the folders above it.
    ///
    /// # Errors
    /// [`LogError::Exists`] instead of overwriting a log; [`LogError::Create`] and [`LogError::Write`] with the
    /// system's error.
    pub fn create(path: &Path, header: &Header) -> Result<Self, LogError> {
        let failed = |source: io::Error| match source.kind() {
            io::ErrorKind::AlreadyExists if path.exists() => LogError::Exists { path: path.into() },
            _ => LogError::Create { path: path.into(), source },
        };
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(failed)?;
        }
        let file = File::create_new(path).map_err(failed)?;
        // A log without its head is of no use, and its name would be taken at the next try.
        Self::to(BufWriter::new(file), path, header).inspect_err(|_| drop(fs::remove_file(path)))
    }
}

impl<W: Write + Seek> LogWriter<W> {
    /// Writes into anything that can seek; `path` is only its name in messages.
    ///
    /// # Errors
    /// [`LogError::Write`] with the system's error.
    pub fn to(to: W, path: &Path, header: &Header) -> Result<Self, LogError> {
        let failed = |error| write_error(path, 0, &error);
        let mut mcap = options(header).create(to).map_err(failed)?;
        for (name, metadata) in [(ABOUT, header.about()), (CONFIG, header.config())] {
            mcap.write_metadata(&Metadata { name: name.into(), metadata }).map_err(failed)?;
        }
        let cycle = channel(&mut mcap, CYCLE, "airball.Cycle", &schema::of::<Cycle>()).map_err(failed)?;
        let event = channel(&mut mcap, EVENT, "airball.Event", &schema::of::<EventMessage>()).map_err(failed)?;
        let start = header.started.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
        Ok(Self { path: path.into(), mcap, start, cycle, event, next_flush_s: FLUSH_EVERY_S })
    }

    /// Writes one control period, and flushes when a second of flight time is over.
    ///
    /// # Errors
    /// [`LogError::Write`]; every write after the first failure fails too.
    pub fn cycle(&mut self, cycle: &Cycle) -> Result<(), LogError> {
        let written = write(&mut self.mcap, &mut self.cycle, self.start, cycle.time_s, cycle);
        written.map_err(|error| self.error(&error))?;
        if cycle.time_s >= self.next_flush_s {
            self.next_flush_s = cycle.time_s.floor() + FLUSH_EVERY_S;
            self.mcap.flush().map_err(|error| self.error(&error))?;
        }
        Ok(())
    }

    /// Writes an event.
    ///
    /// # Errors
    /// As [`cycle`](Self::cycle).
    pub fn event(&mut self, event: &Event) -> Result<(), LogError> {
        self.message(&EventMessage::from(*event))
    }

    /// Writes an event that is already in words.
    ///
    /// # Errors
    /// As [`cycle`](Self::cycle).
    pub fn message(&mut self, message: &EventMessage) -> Result<(), LogError> {
        let written = write(&mut self.mcap, &mut self.event, self.start, message.time_s, message);
        written.map_err(|error| self.error(&error))
    }

    /// Writes the summary that lets viewers seek, and closes the file.
    ///
    /// # Errors
    /// [`LogError::Write`]; the file is then readable up to its last complete chunk.
    pub fn finish(mut self) -> Result<LogSummary, LogError> {
        self.mcap.finish().map_err(|error| self.error(&error))?;
        let Self { path, mcap, cycle, event, .. } = self;
        mcap.into_inner().flush().map_err(|error| write_error(&path, cycle.messages, &error.into()))?;
        Ok(LogSummary { path, cycles: cycle.messages, events: event.messages, dropped: 0 })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn error(&self, error: &McapError) -> LogError {
        write_error(&self.path, self.cycle.messages, error)
    }
}

/// Compresses in the calling thread; chunks are written complete instead of being corrected later by seeking back.
fn options(header: &Header) -> WriteOptions {
    WriteOptions::new()
        .library(format!("airball {}", header.version))
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .chunk_size(Some(CHUNK_BYTES))
        .disable_seeking(true)
}

fn channel<W: Write + Seek>(
    mcap: &mut mcap::Writer<W>,
    topic: &str,
    schema_name: &str,
    schema: &[u8],
) -> McapResult<Channel> {
    let schema = mcap.add_schema(schema_name, "jsonschema", schema)?;
    let id = mcap.add_channel(schema, topic, "json", &BTreeMap::new())?;
    Ok(Channel { id, messages: 0 })
}

fn write<W: Write + Seek>(
    mcap: &mut mcap::Writer<W>,
    channel: &mut Channel,
    start: Duration,
    time_s: f64,
    message: &impl Serialize,
) -> McapResult<()> {
    let data = present(message).map_err(io::Error::from)?;
    let since_start = Duration::try_from_secs_f64(time_s).unwrap_or(Duration::ZERO);
    let log_time = u64::try_from(start.saturating_add(since_start).as_nanos()).unwrap_or(u64::MAX);
    let sequence = u32::try_from(channel.messages).unwrap_or(u32::MAX);
    let header = MessageHeader { channel_id: channel.id, sequence, log_time, publish_time: log_time };
    mcap.write_to_known_channel(&header, &data)?;
    channel.messages += 1;
    Ok(())
}

/// The message without absent values: a `null` would violate the schema, see [`schema`].
fn present(message: &impl Serialize) -> serde_json::Result<Vec<u8>> {
    let mut message = serde_json::to_value(message)?;
    if let Value::Object(quantities) = &mut message {
        quantities.retain(|_, value| !value.is_null());
    }
    serde_json::to_vec(&message)
}

fn write_error(path: &Path, cycles: u64, error: &McapError) -> LogError {
    let cause = match error {
        McapError::Io(error) => error.to_string(),
        other => other.to_string(),
    };
    LogError::Write { path: path.into(), cycles, cause }
}
