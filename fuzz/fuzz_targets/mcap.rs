//! Any bytes as a log: refused, or read; what was read can be summed up and exported, and is recovered whole.
#![no_main]

use airball::fuzzing::{LogWriter, Summary, copy_flight, export_csv, header_of, parse_flight, parse_record};
use libfuzzer_sys::fuzz_target;
use std::io::Cursor;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("f.mcap");
    let _ = parse_record(path, bytes, None);
    let Ok(read) = parse_flight(path, bytes) else { return };
    let _ = Summary::of(&read.cycles, None).to_string();
    export_csv(&read.cycles, std::io::sink()).expect("a sink takes it");
    let mut mended = Vec::new();
    let log = LogWriter::to(Cursor::new(&mut mended), path, &header_of(&read)).expect("memory takes it");
    copy_flight(&read, log).expect("memory takes it");
    let again = parse_flight(path, &mended).expect("a recovered log is a log");
    assert_eq!((again.cycles, again.truncated), (read.cycles, None));
    assert_eq!(again.events.len(), read.events.len());
});
