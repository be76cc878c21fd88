//! Flights as MCAP: complete, cut, damaged, foreign, and arbitrary bytes.

use super::{cycles, events, file, header};
use crate::flight::outside::Recorder;
use crate::log::event::EventMessage;
use crate::log::header::{About, Header};
use crate::log::recorder::Inline;
use crate::log::writer::LogWriter;
use crate::log::{LogError, flight, reader};
use mcap::{MAGIC, WriteOptions, records::MessageHeader};
use proptest::prelude::*;
use serde_json::Value;
use std::io::{Cursor, Seek, SeekFrom, Write};
use std::time::{Duration, UNIX_EPOCH};
use std::{cell::RefCell, collections::BTreeMap, fs, io, path::Path, rc::Rc};

fn parse(bytes: &[u8]) -> Result<flight::Flight, LogError> {
    flight::parse(Path::new("flight.mcap"), bytes)
}

/// A file whose bytes can be seen while it is written.
#[derive(Clone, Default)]
struct Shared(Rc<RefCell<Cursor<Vec<u8>>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Shared {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.borrow_mut().seek(to)
    }
}

#[test]
fn a_log_in_another_compression_is_to_be_packed_again_not_flown_again() {
    let mut bytes = file(&cycles(200));
    for at in 0..bytes.len() - 4 {
        if bytes[at..].starts_with(b"zstd") {
            bytes[at..at + 4].copy_from_slice(b"lz4f");
        }
    }
    let message = parse(&bytes).unwrap_err().to_string();
    assert!(message.contains("lz4f") && message.contains("compress it with zstd"), "{message}");
    assert!(!message.contains("record the flight again"), "{message}");
}

#[test]
fn a_flight_is_read_as_it_was_written() {
    let flight = parse(&file(&cycles(200))).unwrap();
    assert_eq!(flight.cycles, cycles(200));
    assert_eq!(flight.events, events().into_iter().map(EventMessage::from).collect::<Vec<_>>());
    assert_eq!(flight.config_toml.as_deref(), Some(header().config_toml.as_str()));
    assert_eq!(flight.truncated, None);
    let about = About {
        version: Some("0.1.0".into()),
        command: Some("airball simulate --seed 7".into()),
        seed: Some(7),
        started: Some("1970-01-01T00:00:00.000Z".into()),
    };
    assert_eq!(flight.about, about);
}

#[test]
fn the_same_flight_makes_the_same_bytes() {
    assert_eq!(file(&cycles(300)), file(&cycles(300)));
}

#[test]
fn messages_carry_the_wall_clock() {
    let header = Header { started: UNIX_EPOCH + Duration::from_secs(1_700_000_000), ..header() };
    let mut bytes = Vec::new();
    let mut writer = LogWriter::to(Cursor::new(&mut bytes), Path::new("flight.mcap"), &header).unwrap();
    let at = crate::flight::vocabulary::Cycle { time_s: 2.5, ..cycles(1)[0] };
    writer.cycle(&at).unwrap();
    writer.finish().unwrap();
    let message = mcap::MessageStream::new(&bytes).unwrap().next().unwrap().unwrap();
    assert_eq!((message.log_time, message.publish_time), (1_700_000_002_500_000_000, 1_700_000_002_500_000_000));
    assert_eq!((message.channel.topic.as_str(), message.channel.message_encoding.as_str()), ("cycle", "json"));
}

#[test]
fn what_is_absent_is_left_out_of_a_message_as_its_schema_says() {
    for message in mcap::MessageStream::new(&file(&cycles(10))).unwrap() {
        let message = message.unwrap();
        let schema: Value = serde_json::from_slice(&message.channel.schema.as_ref().unwrap().data).unwrap();
        let data: Value = serde_json::from_slice(&message.data).unwrap();
        let has = |key: &Value| data.get(key.as_str().unwrap()).is_some();
        assert!(schema["required"].as_array().unwrap().iter().all(has), "{data}");
        assert!(data.as_object().unwrap().values().all(|value| !value.is_null()), "{data}");
    }
}

#[test]
fn a_killed_flight_loses_about_a_second() {
    let shared = Shared::default();
    let mut writer = LogWriter::to(shared.clone(), Path::new("flight.mcap"), &header()).unwrap();
    for (k, cycle) in cycles(530).iter().enumerate() {
        writer.cycle(cycle).unwrap();
        if k > 60 {
            let so_far = shared.0.borrow().get_ref().clone();
            let flight = parse(&so_far).unwrap();
            assert!(cycle.time_s - flight.cycles.last().unwrap().time_s < 1.05, "{:?}", flight.truncated);
        }
    }
}

#[test]
fn a_cut_file_gives_the_cycles_before_the_cut_and_says_so() {
    let (whole, flown) = (file(&cycles(400)), cycles(400));
    let mut counts = Vec::new();
    for cut in (0..whole.len()).step_by(13) {
        match parse(&whole[..cut]) {
            Ok(flight) => {
                assert!(flown.starts_with(&flight.cycles), "cut at {cut}");
                let said = flight.truncated.unwrap();
                assert!(said.contains(&format!("of {cut}, ")), "{said}");
                assert!(said.contains(&format!("read were {} cycles", flight.cycles.len())), "{said}");
                counts.push(flight.cycles.len());
            }
            Err(error) => assert!(matches!(error, LogError::NoCycles { .. }) && counts.is_empty(), "{cut}: {error}"),
        }
    }
    assert!(counts.is_sorted());
    counts.dedup();
    // Complete flushed seconds become readable one by one, and at last everything although the summary is missing.
    assert!(counts.contains(&51) && counts.contains(&101) && counts.last() == Some(&400), "{counts:?}");
}

#[test]
fn a_damaged_chunk_is_left_out_and_the_rest_is_read() {
    let (mut bytes, flown) = (file(&cycles(400)), cycles(400));
    let middle = bytes.len() / 2;
    bytes[middle..middle + 40].fill(0x55);
    let flight = parse(&bytes).unwrap();
    assert!(flight.cycles.len() < 400 && flight.cycles.iter().all(|cycle| flown.contains(cycle)));
    assert_eq!(flight.cycles.last(), flown.last());
    assert!(flight.truncated.unwrap().contains("not whole"));
}

#[test]
fn a_chunk_that_cannot_be_checked_is_not_believed() {
    let (mut bytes, flown) = (file(&cycles(120)), cycles(120));
    // The third and last chunk: its length points beyond the end of the file, and one byte of its data is wrong.
    let is_name = |at: &usize| bytes[*at..].starts_with(b"\x04\0\0\0zstd");
    let chunk = (0..bytes.len()).filter(is_name).nth(2).unwrap() - 37;
    bytes[chunk + 2] = 0xff;
    bytes[chunk + 153] = 0x66;
    let flight = parse(&bytes).unwrap();
    assert_eq!(flight.cycles, flown[..101]);
    assert!(flight.truncated.unwrap().contains(&format!("at byte {chunk} of")));
}

#[test]
fn a_short_flight_can_be_read_although_it_is_no_recording() {
    let bytes = file(&cycles(10));
    assert_eq!(parse(&bytes).unwrap().cycles.len(), 10);
    let error = reader::parse(Path::new("short.mcap"), &bytes, None).unwrap_err().to_string();
    assert!(error.starts_with("short.mcap: it has 7 readings") && error.contains("at least 20"), "{error}");
}

#[test]
fn a_repeated_position_is_no_reading() {
    let log = reader::parse(Path::new("flight.mcap"), &file(&cycles(100)), None).unwrap();
    let samples = log.recording.samples();
    assert_eq!((samples[1].position_mm, samples[7].position_mm), (None, None));
    assert_eq!(samples[8].position_mm, cycles(100)[8].position_mm);
    assert_eq!(samples[8].duty_percent, cycles(100)[8].duty_percent);
    assert_eq!(log.cycles.len(), 100);
}

#[test]
fn a_foreign_file_is_told_from_a_broken_one() {
    let mut bytes = Vec::new();
    let mut foreign = WriteOptions::new().compression(None).create(Cursor::new(&mut bytes)).unwrap();
    let channel = foreign.add_channel(0, "/imu", "cdr", &BTreeMap::new()).unwrap();
    let message = MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
    foreign.write_to_known_channel(&message, b"123").unwrap();
    foreign.finish().unwrap();
    drop(foreign);
    let error = parse(&bytes).unwrap_err().to_string();
    assert!(error.contains("flight.mcap") && error.contains("its channels are /imu"), "{error}");
    let error = parse(&bytes[..20]).unwrap_err().to_string();
    assert!(error.contains("at byte 8 of 20, the file ends within this record"), "{error}");
}

#[test]
fn a_chunk_without_compression_is_read_up_to_its_cut() {
    let mut bytes = Vec::new();
    let mut writer = WriteOptions::new().compression(None).create(Cursor::new(&mut bytes)).unwrap();
    let channel = writer.add_channel(0, "cycle", "json", &BTreeMap::new()).unwrap();
    for cycle in cycles(50) {
        let header = MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, &serde_json::to_vec(&cycle).unwrap()).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    assert_eq!(parse(&bytes).unwrap().cycles, cycles(50));
    let cut = parse(&bytes[..5000]).unwrap();
    assert!((10..50).contains(&cut.cycles.len()) && cycles(50).starts_with(&cut.cycles), "{}", cut.cycles.len());
}

#[test]
fn an_attachment_that_lies_about_its_length_is_passed_over() {
    /// Times, name, media type and length of the data, all zero; the checksum after them is missing.
    const BODY: [u8; 32] = [0; 32];
    let whole = file(&cycles(30));
    let attachment = [&[9], (BODY.len() as u64).to_le_bytes().as_slice(), &BODY].concat();
    let bytes = [MAGIC, &attachment, &whole[MAGIC.len()..]].concat();
    assert_eq!(parse(&bytes).unwrap().cycles, cycles(30));
}

#[test]
fn a_log_is_never_overwritten_and_its_folders_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a/b/flight.mcap");
    let mut log = Inline::new(LogWriter::create(&path, &header()).unwrap());
    cycles(30).iter().for_each(|cycle| log.cycle(cycle));
    let summary = log.finish().unwrap();
    assert_eq!((summary.path.as_path(), summary.cycles), (path.as_path(), 30));
    let error = LogWriter::create(&path, &header()).err().unwrap();
    assert!(error.to_string().contains("exists already") && error.to_string().contains("flight.mcap"), "{error}");
    assert_eq!(reader::read(&path, None).unwrap().cycles, cycles(30));
    let below = LogWriter::create(&path.join("no-folder.mcap"), &header()).err().unwrap();
    assert!(matches!(below, LogError::Create { .. }), "{below}");
}

#[test]
fn the_wrong_kind_of_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    let error = flight::read(&path).unwrap_err().to_string();
    assert!(error.contains("table.csv") && error.contains("check the name"), "{error}");
    fs::write(&path, "time_s\n").unwrap();
    assert!(flight::read(&path).unwrap_err().to_string().contains("no MCAP"));
    fs::write(&path, "").unwrap();
    assert!(matches!(flight::read(&path).unwrap_err(), LogError::Empty { .. }));
}

#[test]
fn a_time_beyond_all_clocks_can_be_written() {
    let header = Header { started: UNIX_EPOCH + Duration::from_secs(1_700_000_000), ..header() };
    let mut bytes = Vec::new();
    let mut writer = LogWriter::to(Cursor::new(&mut bytes), Path::new("flight.mcap"), &header).unwrap();
    let late = crate::flight::vocabulary::Cycle { time_s: 1.844e19, ..cycles(1)[0] };
    writer.cycle(&late).unwrap();
    writer.finish().unwrap();
    assert_eq!(parse(&bytes).unwrap().cycles, [late]);
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), mcap in any::<bool>()) {
        let bytes = if mcap { [MAGIC, &bytes].concat() } else { bytes };
        let _ = reader::parse(Path::new("any"), &bytes, None);
    }

    #[test]
    fn no_record_makes_the_reader_panic(
        records in prop::collection::vec((1u8..=16, prop::collection::vec(any::<u8>(), 0..80)), 0..10)
    ) {
        let mut bytes = MAGIC.to_vec();
        for (opcode, body) in records {
            bytes.push(opcode);
            bytes.extend((body.len() as u64).to_le_bytes());
            bytes.extend(body);
        }
        let _ = parse(&bytes);
    }

    #[test]
    fn no_damage_makes_the_reader_panic_or_invent_a_cycle(
        hits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)
    ) {
        let (mut bytes, flown) = (file(&cycles(120)), cycles(120));
        for (place, byte) in hits {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Ok(flight) = parse(&bytes) {
            prop_assert!(flight.cycles.iter().all(|cycle| flown.contains(cycle)));
        }
    }
}
