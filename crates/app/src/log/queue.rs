//! The log of a real-time flight: a bounded ring between the loop and a thread that writes.
//!
//! The loop's side never waits and never allocates. Entries that do not fit are counted and lost; write errors are
//! reported at the end. Start the queue before the loop raises its priority, because a thread inherits it.

use super::LogError;
use super::files::Files;
use super::recorder::{Inline, Sink};
use super::rotation::Rotation;
use super::writer::{LogSummary, LogWriter};
use crate::flight::outside::Recorder;
use crate::flight::vocabulary::{Cycle, Event};
use crate::standard_error::fail;
use rtrb::{Consumer, Producer, RingBuffer};
use std::{
    io::{Seek, Write},
    path::Path,
    thread::{self, JoinHandle},
    time::Duration,
};

/// Entries that can wait while the disk is busy: 40 s at 50 Hz, longer than an SD card's worst pauses.
const CAPACITY: usize = 2048;
/// How often the thread reads the ring.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// An entry from the loop to the thread.
#[expect(
    clippy::large_enum_variant,
    reason = "a box would allocate in the loop, and few commands are on their way at a time"
)]
enum Entry {
    Cycle(Cycle),
    Event(Event),
}

/// The loop's side. Dropping it also lets the thread write the remaining entries and close the file.
pub struct Queue {
    files: Files,
    producer: Option<Producer<Entry>>,
    thread: Option<JoinHandle<Result<LogSummary, LogError>>>,
    /// Why there is no file.
    failed: Option<LogError>,
    dropped: u64,
}

impl Queue {
    /// Starts the thread that writes.
    ///
    /// # Errors
    /// [`LogError::Thread`] if the system could not start a thread.
    pub fn start<W: Write + Seek + Send + 'static>(writer: LogWriter<W>) -> Result<Self, LogError> {
        let files = Files::starting_with(writer.path());
        Self::with_capacity(files, Inline::new(writer), CAPACITY)
    }

    /// The same for a log in several files.
    ///
    /// # Errors
    /// As [`Queue::start`].
    pub fn rotating(rotation: Rotation) -> Result<Self, LogError> {
        Self::with_capacity(rotation.files(), rotation, CAPACITY)
    }

    /// A flight without a log, because of `failed`: a disk that cannot be written does not prevent a flight.
    #[must_use]
    pub fn without_file(path: &Path, failed: LogError) -> Self {
        Self { files: Files::starting_with(path), producer: None, thread: None, failed: Some(failed), dropped: 0 }
    }

    fn with_capacity<S: Sink + Send + 'static>(files: Files, sink: S, capacity: usize) -> Result<Self, LogError> {
        let (producer, consumer) = RingBuffer::new(capacity);
        let thread = thread::Builder::new()
            .name("log".into())
            .spawn(move || drain(consumer, sink))
            .map_err(|error| LogError::Thread { path: files.current(), cause: error.to_string() })?;
        Ok(Self { files, producer: Some(producer), thread: Some(thread), failed: None, dropped: 0 })
    }

    /// The files so far.
    #[must_use]
    pub fn files(&self) -> Files {
        self.files.clone()
    }

    /// Waits until everything is written and the file is closed.
    ///
    /// # Errors
    /// The first failure of the flight, or that of closing.
    pub fn finish(mut self) -> Result<LogSummary, LogError> {
        let summary = self.close()?;
        Ok(LogSummary { dropped: self.dropped, ..summary })
    }

    fn push(&mut self, entry: Entry) {
        let fits = self.producer.as_mut().is_some_and(|producer| producer.push(entry).is_ok());
        self.dropped += u64::from(!fits);
    }

    fn close(&mut self) -> Result<LogSummary, LogError> {
        let lost = || LogError::Thread { path: self.files.current(), cause: "it ended early".into() };
        drop(self.producer.take());
        if let Some(failed) = self.failed.take() {
            return Err(failed);
        }
        let thread = self.thread.take().ok_or_else(lost)?;
        thread.join().map_err(|_| lost())?
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        if self.thread.is_some() {
            // An error here cannot be reported; `finish` is the way to get errors.
            drop(self.close());
        }
    }
}

impl Recorder for Queue {
    fn cycle(&mut self, cycle: &Cycle) {
        self.push(Entry::Cycle(*cycle));
    }

    fn event(&mut self, event: &Event) {
        self.push(Entry::Event(*event));
    }

    fn dropped(&self) -> u64 {
        self.dropped
    }
}

/// Writes entries until the loop's side is gone. Continues after a failure, so that the ring does not fill up, and
/// reports it at once: a flight may last for weeks.
fn drain(mut from: Consumer<Entry>, mut to: impl Sink) -> Result<LogSummary, LogError> {
    let mut said = false;
    loop {
        // Checked before the ring is emptied, so that the last entries are certainly read.
        let last = from.is_abandoned();
        while let Ok(entry) = from.pop() {
            match entry {
                Entry::Cycle(cycle) => to.cycle(&cycle),
                Entry::Event(event) => to.event(&event),
            }
        }
        if let Some(error) = to.failure().filter(|_| !said) {
            said = true;
            fail(format_args!("{error}; the flight goes on"));
        }
        if last {
            return to.finish();
        }
        thread::sleep(LOOK_EVERY);
    }
}

#[cfg(test)]
mod tests {
    use super::{Files, Inline, Queue, Recorder};
    use crate::log::tests::{cycles, events, header};
    use crate::log::writer::LogWriter;
    use crate::log::{LogError, flight};
    use std::io::{self, Cursor, Seek, SeekFrom, Write};
    use std::path::Path;
    use std::sync::mpsc::{Receiver, channel};

    /// A disk that is full after so many bytes.
    struct FullDisk(Cursor<Vec<u8>>, usize);

    impl Write for FullDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0.get_ref().len() + bytes.len() > self.1 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.0.write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for FullDisk {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    /// A disk that blocks until it is released.
    struct StuckDisk(Cursor<Vec<u8>>, Option<Receiver<()>>);

    impl Write for StuckDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if let Some(go) = self.1.take_if(|_| self.0.get_ref().len() > 5000) {
                go.recv().unwrap();
            }
            self.0.write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for StuckDisk {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    fn small<W: Write + Seek + Send + 'static>(writer: LogWriter<W>, capacity: usize) -> Result<Queue, LogError> {
        Queue::with_capacity(Files::starting_with(writer.path()), Inline::new(writer), capacity)
    }

    #[test]
    fn a_flight_without_a_log_counts_what_it_loses_and_says_why_at_the_end() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let below_a_file = file.path().join("f.mcap");
        let failed = LogWriter::create(&below_a_file, &header()).err().unwrap();
        let mut queue = Queue::without_file(&below_a_file, failed);
        cycles(70).iter().for_each(|cycle| queue.cycle(cycle));
        assert_eq!(queue.dropped(), 70);
        assert!(matches!(queue.finish(), Err(LogError::Create { .. })));
    }

    #[test]
    fn everything_pushed_before_the_end_is_in_the_file() {
        let path = tempfile::tempdir().unwrap().path().join("flight.mcap");
        let mut queue = Queue::start(LogWriter::create(&path, &header()).unwrap()).unwrap();
        cycles(500).iter().for_each(|cycle| queue.cycle(cycle));
        events().iter().for_each(|event| queue.event(event));
        let summary = queue.finish().unwrap();
        assert_eq!((summary.cycles, summary.events, summary.dropped), (500, 3, 0));
        let flight = flight::read(&path).unwrap();
        assert_eq!(flight.cycles, cycles(500));
        assert_eq!(flight.truncated, None);
    }

    #[test]
    fn a_queue_that_is_dropped_still_leaves_a_whole_file() {
        let path = tempfile::tempdir().unwrap().path().join("flight.mcap");
        let mut queue = Queue::start(LogWriter::create(&path, &header()).unwrap()).unwrap();
        cycles(70).iter().for_each(|cycle| queue.cycle(cycle));
        drop(queue);
        let flight = flight::read(&path).unwrap();
        assert_eq!((flight.cycles.len(), flight.truncated), (70, None));
    }

    #[test]
    fn what_does_not_fit_is_counted_and_the_loop_does_not_wait() {
        let (go, stuck) = channel();
        let disk = StuckDisk(Cursor::default(), Some(stuck));
        let writer = LogWriter::to(disk, Path::new("stuck.mcap"), &header()).unwrap();
        let mut queue = small(writer, 10).unwrap();
        // Pushing returns although the disk is blocked; otherwise this would never end.
        let pushed = 1_000_000;
        let cycle = cycles(1)[0];
        (0..pushed).for_each(|_| queue.cycle(&cycle));
        assert!(queue.dropped() > 0);
        go.send(()).unwrap();
        let summary = queue.finish().unwrap();
        assert_eq!(summary.cycles + summary.dropped, pushed);
    }

    #[test]
    fn a_full_disk_is_reported_at_the_end_and_the_flight_goes_on() {
        let disk = FullDisk(Cursor::default(), 6000);
        let writer = LogWriter::to(disk, Path::new("full.mcap"), &header()).unwrap();
        let mut queue = small(writer, 10_000).unwrap();
        cycles(5000).iter().for_each(|cycle| queue.cycle(cycle));
        events().iter().for_each(|event| queue.event(event));
        assert_eq!(queue.dropped(), 0);
        let error = queue.finish().unwrap_err();
        assert!(matches!(error, LogError::Write { cycles: 51.., .. }), "{error}");
        let said = error.to_string();
        // The first cause, not the writer's error after its failure.
        assert!(said.contains("full.mcap") && said.contains("no storage space"), "{said}");
    }
}
