//! Tables as logs; the content of tables is tested in the crate `rows`.

use super::{cycles, file};
use crate::log::{LogError, export, reader};
use std::path::Path;

#[test]
fn an_exported_flight_is_the_same_recording() {
    let flown = reader::parse(Path::new("flight.mcap"), &file(&cycles(300)), None).unwrap();
    let mut csv = Vec::new();
    export::csv(&flown.cycles, &mut csv).unwrap();
    let read = reader::parse(Path::new("flight.csv"), &csv, None).unwrap();
    assert_eq!(read.recording, flown.recording);
    assert!(csv.starts_with(b"time_s,setpoint_mm,control_percent,duty_percent,position_mm,fresh\n"));
}

#[test]
fn a_table_is_a_log_of_rows_alone() {
    let rows: String = (0..30).map(|k| format!("{k},20,{k}\n")).collect();
    let text = format!("time_s,duty_percent,position_mm\n{rows}");
    let log = reader::parse(Path::new("rig.csv"), text.as_bytes(), None).unwrap();
    assert!(log.cycles.is_empty() && log.recording.samples().len() == 30);
}

#[test]
fn a_table_that_cannot_be_read_is_named() {
    let error = reader::parse(Path::new("a/rig.csv"), b"", None).unwrap_err();
    assert!(matches!(error, LogError::Rows(_)));
    assert!(error.to_string().starts_with("a/rig.csv is empty; record a flight"), "{error}");
    let said = reader::read(Path::new("no/such.csv"), None).unwrap_err().to_string();
    assert!(said.starts_with("cannot read no/such.csv: "), "{said}");
}
