//! A log in several files, for flights that last for weeks: a new file after a fixed time, and the oldest deleted when
//! all of them are too large.
//!
//! Every file is a complete log, with config and schemas; time continues from file to file. Files are named after the
//! first, with `-2`, `-3`, …; an existing name is skipped. If no new file can be created, the old one is continued, and
//! another attempt follows. Only logs whose names are times, as the program gives them, are ever deleted.

use super::LogError;
use super::files::Files;
use super::header::Header;
use super::recorder::{Inline, Sink};
use super::writer::{LogSummary, LogWriter};
use crate::flight::lateness::Histogram;
use crate::flight::outside::Recorder;
use crate::flight::vocabulary::{Cycle, End, Event, What};
use std::fs;
use std::path::{Path, PathBuf};

/// Length of a file, and size of all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Length of a file, seconds of flight.
    pub part_s: f64,
    /// Largest size of all logs of the directory, bytes. `None`: none is deleted.
    pub keep_bytes: Option<u64>,
}

/// Time between two attempts to create a file, seconds of flight.
const RETRY_S: f64 = 10.0;

/// Records into file after file.
pub struct Rotation {
    first: PathBuf,
    files: Files,
    header: Header,
    limits: Limits,
    current: Inline,
    part: u32,
    next_s: f64,
    /// Histogram of the lateness of the recorded cycles, since the first.
    lateness: Histogram,
    /// Totals of the closed files.
    done: LogSummary,
    /// The first failure of any file.
    failed: Option<LogError>,
}

impl Rotation {
    /// Creates the first file.
    ///
    /// # Errors
    /// As [`LogWriter::create`].
    pub fn create(path: &Path, header: &Header, limits: Limits) -> Result<Self, LogError> {
        let current = Inline::new(LogWriter::create(path, header)?);
        let done = LogSummary { path: path.into(), cycles: 0, events: 0, dropped: 0 };
        let rotation = Self {
            first: path.into(),
            files: Files::starting_with(path),
            header: header.clone(),
            limits,
            current,
            part: 1,
            next_s: limits.part_s,
            lateness: Histogram::default(),
            done,
            failed: None,
        };
        rotation.prune(path);
        Ok(rotation)
    }

    /// The files so far.
    #[must_use]
    pub fn files(&self) -> Files {
        self.files.clone()
    }

    /// Closes the file and begins the next. If none can be created, the old one is continued.
    fn turn(&mut self, time_s: f64) {
        let (path, writer) = match self.next_file() {
            Ok(begun) => begun,
            Err(error) => {
                self.next_s = time_s + RETRY_S;
                return self.fail(error);
            }
        };
        self.next_s = time_s + self.limits.part_s;
        let mut full = std::mem::replace(&mut self.current, Inline::new(writer));
        if self.lateness.says_something() {
            full.event(&Event { time_s, what: What::Lateness(self.lateness) });
        }
        full.event(&Event { time_s, what: What::End(End::Continued) });
        // The next file may be on a disk with free space.
        match full.finish() {
            Ok(LogSummary { cycles, events, .. }) => {
                self.done.cycles += cycles;
                self.done.events += events;
            }
            Err(error) => self.fail(error),
        }
        self.files.add(&path);
        self.prune(&path);
    }

    fn next_file(&mut self) -> Result<(PathBuf, LogWriter), LogError> {
        let name = self.first.file_stem().unwrap_or_default().to_string_lossy();
        let mut part = self.part;
        loop {
            part += 1;
            let path = self.first.with_file_name(format!("{name}-{part}.mcap"));
            match LogWriter::create(&path, &self.header) {
                Err(LogError::Exists { .. }) => {}
                Err(error) => return Err(error),
                Ok(writer) => {
                    self.part = part;
                    return Ok((path, writer));
                }
            }
        }
    }

    fn fail(&mut self, error: LogError) {
        self.failed.get_or_insert(error);
    }

    /// Deletes the oldest logs until the rest is small enough.
    fn prune(&self, current: &Path) {
        let Some((keep_bytes, folder)) = self.limits.keep_bytes.zip(current.parent()) else { return };
        // A name alone has an empty parent, which cannot be read.
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
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
        self.lateness.count(cycle.lateness_s);
        self.current.cycle(cycle);
    }

    fn event(&mut self, event: &Event) {
        self.current.event(event);
    }
}

impl Sink for Rotation {
    fn failure(&self) -> Option<&LogError> {
        self.failed.as_ref().or_else(|| self.current.failure())
    }

    fn finish(self) -> Result<LogSummary, LogError> {
        let last = self.current.finish();
        let last = self.failed.map_or(last, Err)?;
        let (cycles, events) = (self.done.cycles + last.cycles, self.done.events + last.events);
        Ok(LogSummary { cycles, events, ..self.done })
    }
}

/// Whether a log has a name of the program: `2026-11-21T16-00-00.000Z.mcap`, or a later part of such a flight.
fn is_named_by_time(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let time = "dddd-dd-ddTdd-dd-dd.dddZ";
    let fits = |(pattern, c): (char, char)| if pattern == 'd' { c.is_ascii_digit() } else { c == pattern };
    let Some(part) = name.get(time.len()..).and_then(|rest| rest.strip_suffix(".mcap")) else { return false };
    let numbered = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_digit());
    time.chars().zip(name.chars()).all(fits) && (part.is_empty() || part.strip_prefix('-').is_some_and(numbered))
}

/// Sort key of flights, and of the parts of one.
fn age(path: &Path) -> (String, u32) {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    match stem.split_once("Z-") {
        Some((time, part)) => (time.to_owned(), part.parse().unwrap_or(u32::MAX)),
        None => (stem.trim_end_matches('Z').to_owned(), 1),
    }
}

#[cfg(test)]
mod tests {
    use super::{Inline, Limits, LogError, LogWriter, Recorder, Rotation, Sink};
    use crate::flight::vocabulary::Cycle;
    use crate::log::flight;
    use crate::log::tests::{cycles, events, header};
    use nix::fcntl::{FcntlArg, SealFlag, fcntl};
    use nix::sys::memfd::{MFdFlags, memfd_create};
    use std::fs::File;
    use std::io::BufWriter;
    use std::path::Path;

    const PARTS: Limits = Limits { part_s: 4.0, keep_bytes: None };

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
        fly(&folder.path().join("f.mcap"), PARTS, &flown);
        let parts = ["f.mcap", "f-2.mcap", "f-3.mcap"].map(|name| flight::read(&folder.path().join(name)).unwrap());
        assert!(parts.iter().all(|part| part.complete && part.config_toml.is_some()));
        assert_eq!(parts[0].events.last().unwrap().text, "continued");
        let read: Vec<Cycle> = parts.into_iter().flat_map(|part| part.cycles).collect();
        assert_eq!(read, flown);
    }

    #[test]
    fn each_file_ends_with_how_late_the_cycles_began_so_far() {
        let folder = tempfile::tempdir().unwrap();
        fly(&folder.path().join("f.mcap"), PARTS, &cycles(500));
        let mut so_far = 0;
        for name in ["f.mcap", "f-2.mcap"] {
            let flight::Flight { cycles, events, .. } = flight::read(&folder.path().join(name)).unwrap();
            so_far += cycles.len() as u64;
            let timing = &events[events.len() - 2];
            let counted: u64 = timing.lateness.as_ref().unwrap().counts.iter().sum();
            assert_eq!((timing.kind.as_str(), counted), ("timing", so_far), "{name}");
        }
    }

    #[test]
    fn a_file_that_is_closed_leaves_no_memory_behind_but_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let flown = cycles(40_000);
        let mut log = Rotation::create(&folder.path().join("f.mcap"), &header(), PARTS).unwrap();
        let held = allocation_counter::measure(|| flown.iter().for_each(|cycle| log.cycle(cycle))).bytes_current;
        let files = i64::try_from(log.files().all().len()).unwrap();
        assert!(files > 150 && held < 200 * files, "{held} bytes for {files} files");
    }

    #[test]
    fn a_name_that_is_taken_is_passed_over_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let theirs = folder.path().join("f-2.mcap");
        std::fs::write(&theirs, "theirs").unwrap();
        let mut log = Rotation::create(&folder.path().join("f.mcap"), &header(), PARTS).unwrap();
        cycles(500).iter().for_each(|cycle| log.cycle(cycle));
        let files = log.files();
        assert_eq!(log.finish().unwrap().cycles, 500);
        assert_eq!(files.all(), ["f.mcap", "f-3.mcap", "f-4.mcap"].map(|name| folder.path().join(name)));
        assert_eq!(std::fs::read(&theirs).unwrap(), b"theirs");
    }

    #[test]
    fn a_file_that_cannot_be_begun_is_said_and_the_old_one_goes_on_until_one_can() {
        let folder = tempfile::tempdir().unwrap();
        let (here, gone) = (folder.path().join("logs"), folder.path().join("gone"));
        let mut log = Rotation::create(&here.join("f.mcap"), &header(), PARTS).unwrap();
        let flown = cycles(1500);
        flown[..100].iter().for_each(|cycle| log.cycle(cycle));
        // A file in place of the folder: nothing can be created below it, with any permissions.
        std::fs::rename(&here, &gone).unwrap();
        std::fs::write(&here, "").unwrap();
        flown[100..300].iter().for_each(|cycle| log.cycle(cycle));
        assert!(matches!(log.failure(), Some(LogError::Create { .. })), "{:?}", log.failure());
        std::fs::remove_file(&here).unwrap();
        std::fs::rename(&gone, &here).unwrap();
        flown[300..].iter().for_each(|cycle| log.cycle(cycle));
        let files = log.files().all();
        assert!(matches!(log.finish(), Err(LogError::Create { .. })));
        let read: Vec<Cycle> = files.iter().flat_map(|file| flight::read(file).unwrap().cycles).collect();
        assert_eq!((files.len(), read), (5, flown));
    }

    #[test]
    fn the_failure_of_an_earlier_file_is_that_of_the_flight() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f.mcap");
        let mut log = Rotation::create(&path, &header(), PARTS).unwrap();
        // A disk that is full after the header.
        let disk = File::from(memfd_create("disk", MFdFlags::MFD_ALLOW_SEALING).unwrap());
        let to = BufWriter::new(disk.try_clone().unwrap());
        log.current = Inline::new(LogWriter::to(to, &path, &header()).unwrap());
        fcntl(&disk, FcntlArg::F_ADD_SEALS(SealFlag::F_SEAL_GROW)).unwrap();
        cycles(300).iter().for_each(|cycle| log.cycle(cycle));
        let (said, files) = (log.failure().unwrap().to_string(), log.files().all());
        assert!(said.contains("f.mcap") && said.contains("not permitted"), "{said}");
        assert_eq!(log.finish().unwrap_err().to_string(), said);
        assert_eq!(flight::read(&files[1]).unwrap().cycles, cycles(300)[200..]);
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
