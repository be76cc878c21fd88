//! A flight that is cut at every byte and has every byte changed: no panic, no invented data, a second lost at most.

use super::{cycles, events, file, header};
use crate::flight::vocabulary::Cycle;
use crate::log::event::EventMessage;
use crate::log::flight::{self, Flight};
use crate::log::recover;
use rayon::prelude::*;
use std::path::Path;

/// Three seconds: four chunks.
const CYCLES: u32 = 160;
/// A little more than a second: two chunks, few enough bytes to test them all.
const SHORT: u32 = 60;
/// A chunk holds a second: 50 cycles, the first one more.
const ONE_SECOND: usize = 51;

/// Changes of a byte: its lowest bit flipped, its highest, all of them, a zero.
const SPOILERS: [fn(u8) -> u8; 4] = [|byte| byte ^ 1, |byte| byte ^ 0x80, |byte| !byte, |_| 0];

fn parse(bytes: &[u8]) -> Option<Flight> {
    flight::parse(Path::new("flight.mcap"), bytes).ok()
}

/// Everything that was read was written, in its order, and `complete` is correct.
fn check(flight: &Flight, flown: &[Cycle], what: &str) {
    let mut rest = flown.iter();
    assert!(flight.cycles.iter().all(|cycle| rest.any(|written| written == cycle)), "{what}: invented a cycle");
    let written: Vec<EventMessage> = events().into_iter().map(EventMessage::from).collect();
    let mut rest = written.iter();
    assert!(flight.events.iter().all(|event| rest.any(|written| written == event)), "{what}: invented an event");
    let config = header().config_toml;
    assert!(flight.config_toml.as_ref().is_none_or(|read| *read == config), "{what}: invented a config");
    let command = header().command;
    assert!(flight.about.command.as_ref().is_none_or(|read| *read == command), "{what}: invented a command");
    if flight.complete {
        assert_eq!((flight.cycles.len(), flight.events.len()), (flown.len(), written.len()), "{what}");
        assert!(flight.config_toml.is_some() && flight.about.seed == header().seed, "{what}");
    }
}

/// Changes every `step`th byte of a flight, one at a time, in each of these ways.
fn spoil(count: u32, step: usize, spoilers: &(dyn Fn(usize) -> Vec<fn(u8) -> u8> + Sync)) {
    let (whole, flown) = (file(&cycles(count)), cycles(count));
    (0..whole.len()).into_par_iter().step_by(step).for_each(|place| {
        for spoiler in spoilers(place) {
            let mut bytes = whole.clone();
            bytes[place] = spoiler(whole[place]);
            let what = format!("byte {place} became {:#04x}", bytes[place]);
            let flight = parse(&bytes).unwrap_or_else(|| panic!("{what}: nothing can be read"));
            check(&flight, &flown, &what);
            let lost = flown.len() - flight.cycles.len();
            assert!(lost <= ONE_SECOND, "{what}: {lost} cycles are lost");
        }
    });
}

/// Cuts a flight at every `step`th byte.
fn cut(count: u32, step: usize) {
    let (whole, flown) = (file(&cycles(count)), cycles(count));
    let mut most = 0;
    for place in (0..whole.len()).step_by(step) {
        let Some(flight) = parse(&whole[..place]) else {
            assert_eq!(most, 0, "cut at {place}: nothing can be read, and before it could");
            continue;
        };
        check(&flight, &flown, &format!("cut at {place}"));
        assert!(flown.starts_with(&flight.cycles) && flight.cycles.len() >= most, "cut at {place}");
        most = flight.cycles.len();
    }
    assert_eq!(most, flown.len());
}

#[test]
fn every_byte_of_a_short_flight_can_be_spoilt_and_costs_a_second_at_most() {
    // A different change at each byte, so that all of them are tested.
    spoil(SHORT, 1, &|place| vec![SPOILERS[place % SPOILERS.len()]]);
}

#[test]
fn a_flight_whose_last_chunk_holds_only_its_end_is_complete_only_where_no_cycle_is_lost() {
    for count in [100, 101, 102] {
        spoil(count, 3, &|place| vec![SPOILERS[place / 3 % SPOILERS.len()]]);
    }
}

#[test]
fn a_spoilt_byte_costs_a_second_at_most_and_invents_nothing() {
    spoil(CYCLES, 11, &|_| SPOILERS.to_vec());
}

#[test]
#[ignore = "slow: every byte"]
fn any_spoilt_byte_costs_a_second_at_most_and_invents_nothing() {
    spoil(CYCLES, 1, &|_| SPOILERS.to_vec());
}

#[test]
fn a_short_flight_that_is_cut_anywhere_gives_what_was_whole_before_the_cut() {
    cut(SHORT, 1);
}

#[test]
fn a_cut_file_gives_what_was_whole_before_the_cut() {
    cut(CYCLES, 7);
}

#[test]
#[ignore = "slow: every byte"]
fn a_file_that_is_cut_anywhere_gives_what_was_whole_before_the_cut() {
    cut(CYCLES, 1);
}

#[test]
fn a_length_that_swallows_the_next_chunks_takes_none_of_them_with_it() {
    let (whole, flown) = (file(&cycles(CYCLES)), cycles(CYCLES));
    // The first record after the first chunk: its length now reaches over two chunks more.
    let sign = (0..whole.len()).find(|at| whole[*at..].starts_with(b"\x04\0\0\0zstd")).unwrap();
    let chunk = sign - 37;
    let length = usize::try_from(u64::from_le_bytes(whole[chunk + 1..chunk + 9].try_into().unwrap())).unwrap();
    let mut bytes = whole.clone();
    bytes[chunk + 9 + length + 1..][..8].copy_from_slice(&(3 * length as u64).to_le_bytes());
    let flight = parse(&bytes).unwrap();
    assert_eq!(flight.cycles, flown);
}

#[test]
fn a_flight_without_its_first_chunk_still_knows_cycles_from_events() {
    let (whole, flown) = (file(&cycles(CYCLES)), cycles(CYCLES));
    let sign = (0..whole.len()).find(|at| whole[*at..].starts_with(b"\x04\0\0\0zstd")).unwrap();
    let mut bytes = whole;
    bytes[sign + 40] ^= 0xFF;
    let flight = parse(&bytes).unwrap();
    assert_eq!(flight.cycles, flown[ONE_SECOND..]);
    assert_eq!(flight.events.len(), 3);
    assert!(!flight.complete);
}

#[test]
fn a_recovered_log_is_whole_and_holds_what_could_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let whole = file(&cycles(CYCLES));
    let cut = parse(&whole[..whole.len() * 2 / 3]).unwrap();
    assert!(!cut.complete && cut.truncated.is_some());
    let path = folder.path().join("mended.mcap");
    recover::write(&cut, &path).unwrap();
    let mended = flight::read(&path).unwrap();
    assert_eq!((&mended.cycles, &mended.about), (&cut.cycles, &cut.about));
    assert_eq!((&mended.config_toml, &mended.truncated), (&cut.config_toml, &None));
    assert!(recover::write(&cut, &path).is_err(), "a log is never overwritten");
}

#[test]
fn a_whole_flight_is_complete_and_so_is_one_that_only_lacks_its_summary() {
    let whole = file(&cycles(CYCLES));
    assert!(parse(&whole).unwrap().complete);
    let without_footer = parse(&whole[..whole.len() - 20]).unwrap();
    assert!(without_footer.complete && without_footer.truncated.is_some());
}

#[test]
fn a_spoilt_magic_number_does_not_hide_the_flight() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.mcap");
    let mut bytes = file(&cycles(CYCLES));
    bytes[0] = 0;
    std::fs::write(&path, bytes).unwrap();
    assert_eq!(flight::read(&path).unwrap().cycles, cycles(CYCLES));
}
