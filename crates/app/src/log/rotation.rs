//! A log in several files, for flights that last for weeks: a new file after so many seconds, and the oldest deleted
//! when all of them take too much room.
//!
//! Every file is a whole log by itself, with config and schemas; time goes on from file to file. Files are named after the
//! first, with `-2`, `-3`, … Only logs whose names are times, as the program gives them, are ever deleted.

use super::{
    LogError,
    header::Header,
    record::{Cycle, End, Event, What},
    recorder::{Inline, Recorder, Sink},
    writer::{LogSummary, LogWriter},
};
use std::fs;
use std::path::{Path, PathBuf};

/// When a file ends, and how much room all of them may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// A file lasts so long, seconds of flight.
    pub part_s: f64,
    /// All logs of the directory take so much room at most, bytes. `None`: none is deleted.
    pub keep_bytes: Option<u64>,
}

/// Records into file after file.
pub struct Rotation {
    first: PathBuf,
    header: Header,
    limits: Limits,
    current: Inline,
    part: u32,
    next_s: f64,
    /// Of the files that are closed.
    done: LogSummary,
}

impl Rotation {
    /// Creates the first file.
    ///
    /// # Errors
    /// As [`LogWriter::create`].
    pub fn create(path: &Path, header: &Header, limits: Limits) -> Result<Self, LogError> {
        let current = Inline::new(LogWriter::create(path, header)?);
        let done = LogSummary { path: path.into(), cycles: 0, events: 0, dropped: 0 };
        let rotation =
            Self { first: path.into(), header: header.clone(), limits, current, part: 1, next_s: limits.part_s, done };
        rotation.prune(path);
        Ok(rotation)
    }

    /// The first file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.first
    }

    /// Closes the file and begins the next. Where there is no room for one, the old one goes on.
    fn turn(&mut self, time_s: f64) {
        self.next_s = time_s + self.limits.part_s;
        let name = self.first.file_stem().unwrap_or_default().to_string_lossy();
        let path = self.first.with_file_name(format!("{name}-{}.mcap", self.part + 1));
        let Ok(writer) = LogWriter::create(&path, &self.header) else { return };
        self.part += 1;
        let mut full = std::mem::replace(&mut self.current, Inline::new(writer));
        full.event(&Event { time_s, what: What::End(End::Continued) });
        // A file that failed has said so; the next one may be on a disk with room again.
        if let Ok(LogSummary { cycles, events, .. }) = full.finish() {
            self.done.cycles += cycles;
            self.done.events += events;
        }
        self.prune(&path);
    }

    /// Deletes the oldest logs until the rest is small enough.
    fn prune(&self, current: &Path) {
        let Some((keep_bytes, folder)) = self.limits.keep_bytes.zip(current.parent()) else { return };
        let mut logs: Vec<(PathBuf, u64)> = fs::read_dir(folder)
            .into_iter()
            .flatten()
            .flatten()
            .filter_map(|entry| Some((entry.path(), entry.metadata().ok()?)))
            .filter(|(path, _)| is_named_by_time(path))
            .map(|(path, metadata)| (path, metadata.len()))
            .collect();
        logs.sort_by_key(|(path, _)| age(path));
        let mut room: u64 = logs.iter().map(|(_, bytes)| bytes).sum();
        for (path, bytes) in logs {
            if room <= keep_bytes {
                return;
            }
            if path != current && fs::remove_file(&path).is_ok() {
                room -= bytes;
            }
        }
    }
}

impl Recorder for Rotation {
    fn cycle(&mut self, cycle: &Cycle) {
        if cycle.time_s >= self.next_s {
            self.turn(cycle.time_s);
        }
        self.current.cycle(cycle);
    }

    fn event(&mut self, event: &Event) {
        self.current.event(event);
    }
}

impl Sink for Rotation {
    fn failure(&self) -> Option<&LogError> {
        self.current.failure()
    }

    fn finish(self) -> Result<LogSummary, LogError> {
        let last = self.current.finish()?;
        let (cycles, events) = (self.done.cycles + last.cycles, self.done.events + last.events);
        Ok(LogSummary { cycles, events, ..self.done })
    }
}

/// Whether a log has the name that the program gives: `2026-11-21T16-00-00.000Z.mcap`, or a later part of such a one.
fn is_named_by_time(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let time = "dddd-dd-ddTdd-dd-dd.dddZ";
    let fits = |(pattern, c): (char, char)| if pattern == 'd' { c.is_ascii_digit() } else { c == pattern };
    let Some(part) = name.get(time.len()..).and_then(|rest| rest.strip_suffix(".mcap")) else { return false };
    let numbered = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_digit());
    time.chars().zip(name.chars()).all(fits) && (part.is_empty() || part.strip_prefix('-').is_some_and(numbered))
}

/// The order of the flights, and of the parts of one.
fn age(path: &Path) -> (String, u32) {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    match stem.split_once("Z-") {
        Some((time, part)) => (time.to_owned(), part.parse().unwrap_or(u32::MAX)),
        None => (stem.trim_end_matches('Z').to_owned(), 1),
    }
}

#[cfg(test)]
mod tests {
    use super::{Limits, Recorder, Rotation, Sink};
    use crate::log::flight;
    use crate::log::record::Cycle;
    use crate::log::tests::{cycles, events, header};
    use std::path::Path;

    fn fly(path: &Path, limits: Limits, flown: &[Cycle]) {
        let mut log = Rotation::create(path, &header(), limits).unwrap();
        flown.iter().for_each(|cycle| log.cycle(cycle));
        events().iter().for_each(|event| log.event(event));
        assert_eq!(log.finish().unwrap().cycles, flown.len() as u64);
    }

    #[test]
    fn a_long_flight_is_in_several_whole_files_and_nothing_is_lost_between_them() {
        let folder = tempfile::tempdir().unwrap();
        let flown = cycles(500);
        fly(&folder.path().join("f.mcap"), Limits { part_s: 4.0, keep_bytes: None }, &flown);
        let parts = ["f.mcap", "f-2.mcap", "f-3.mcap"].map(|name| flight::read(&folder.path().join(name)).unwrap());
        assert!(parts.iter().all(|part| part.complete && part.config_toml.is_some()));
        assert_eq!(parts[0].events.last().unwrap().text, "continued");
        let read: Vec<Cycle> = parts.into_iter().flat_map(|part| part.cycles).collect();
        assert_eq!(read, flown);
    }

    #[test]
    fn the_oldest_logs_make_room_and_nobody_elses_file_is_touched() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let theirs = [
            "2026-11-21T16-00-00.000Z.csv",
            "mine.mcap",
            "2026-holiday.mcap",
            "2026-11-20T09-00-00.000Z-keep.mcap",
            "2026-11-20T09-00-00.000Z.recovered.mcap",
        ];
        for name in theirs.into_iter().chain(["2026-11-20T09-00-00.000Z.mcap", "2026-11-20T09-00-00.000Z-2.mcap"]) {
            std::fs::write(file(name), [0; 4000]).unwrap();
        }
        let limits = Limits { part_s: 2.0, keep_bytes: Some(15_000) };
        fly(&file("2026-11-21T16-00-00.000Z.mcap"), limits, &cycles(1000));
        assert!(theirs.iter().all(|name| file(name).exists()));
        assert!(!file("2026-11-20T09-00-00.000Z.mcap").exists() && !file("2026-11-20T09-00-00.000Z-2.mcap").exists());
        assert!(!file("2026-11-21T16-00-00.000Z.mcap").exists() && file("2026-11-21T16-00-00.000Z-10.mcap").exists());
    }
}
