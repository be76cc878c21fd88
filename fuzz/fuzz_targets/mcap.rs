//! Any bytes as a log: refused, or read; what was read can be summed up and exported, and is recovered whole.
#![no_main]

use airball::log::writer::LogWriter;
use airball::log::{export, flight, reader, recover};
use airball::report::flight::summary::Summary;
use libfuzzer_sys::fuzz_target;
use std::io::Cursor;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("f.mcap");
    let _ = reader::parse(path, bytes, None);
    let Ok(read) = flight::parse(path, bytes) else { return };
    let _ = Summary::of(&read.cycles, None).to_string();
    export::csv(&read.cycles, std::io::sink()).expect("a sink takes it");
    let mut mended = Vec::new();
    let log = LogWriter::to(Cursor::new(&mut mended), path, &recover::header(&read)).expect("memory takes it");
    recover::copy(&read, log).expect("memory takes it");
    let again = flight::parse(path, &mended).expect("a recovered log is a log");
    assert_eq!((again.cycles, again.truncated), (read.cycles, None));
    assert_eq!(again.events.len(), read.events.len());
});
