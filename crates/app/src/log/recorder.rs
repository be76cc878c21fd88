//! Recorders that write a log: recording never fails in flight.
//!
//! In virtual time [`Inline`] writes at once; in real time [`Queue`](super::queue::Queue) passes entries to a thread.
//! Both report the first failure at the end: a full disk must not end a flight.

use super::LogError;
use super::writer::{LogSummary, LogWriter};
use crate::flight::outside::Recorder;
use crate::flight::vocabulary::{Cycle, Event};
use std::{
    fs::File,
    io::{BufWriter, Seek, Write},
};

/// A recorder that writes files.
pub trait Sink: Recorder {
    /// The first failure so far.
    fn failure(&self) -> Option<&LogError>;

    /// Closes the file.
    ///
    /// # Errors
    /// The first failure of the flight, or that of closing.
    fn finish(self) -> Result<LogSummary, LogError>;
}

/// Writes in the calling thread; for virtual time.
pub struct Inline<W: Write + Seek = BufWriter<File>> {
    writer: LogWriter<W>,
    failed: Option<LogError>,
}

impl<W: Write + Seek> Inline<W> {
    /// Records into this writer.
    pub fn new(writer: LogWriter<W>) -> Self {
        Self { writer, failed: None }
    }

    /// Closes the file.
    ///
    /// # Errors
    /// The first failure of the flight, or that of closing.
    pub fn finish(self) -> Result<LogSummary, LogError> {
        self.failed.map_or_else(|| self.writer.finish(), Err)
    }
}

impl<W: Write + Seek> Sink for Inline<W> {
    fn failure(&self) -> Option<&LogError> {
        self.failed.as_ref()
    }

    fn finish(self) -> Result<LogSummary, LogError> {
        Inline::finish(self)
    }
}

impl<W: Write + Seek> Recorder for Inline<W> {
    fn cycle(&mut self, cycle: &Cycle) {
        if self.failed.is_none() {
            self.failed = self.writer.cycle(cycle).err();
        }
    }

    fn event(&mut self, event: &Event) {
        if self.failed.is_none() {
            self.failed = self.writer.event(event).err();
        }
    }
}
