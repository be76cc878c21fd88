//! Whole commands on a flight whose cells any bytes have spoilt: an answer or a refusal, and no panic.
#![no_main]

use airball::cli::{Cli, Command};
use airball::commands::{diagnose, identify, init, measure, replay};
use airball::fuzzing::{Tables, parse_text};
use clap::Parser;
use libfuzzer_sys::fuzz_target;
use plant::Simulator;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

/// The commands that read a record; run in a folder of their own.
const COMMANDS: [&str; 14] = [
    "replay f.csv --json --html p.html --plot p.svg",
    "init f.csv --yes --force --out i.toml",
    "identify grey-box f.csv --json --html p.html --plot p.svg",
    "identify grey-box f.csv --json --open-loop",
    "identify transient f.csv --json",
    "measure dead-zone --from f.csv --json --html p.html",
    "measure force-curve --from f.csv --json --html p.html",
    "measure critical-gain --from f.csv --json --html p.html",
    "measure critical-time --from f.csv --json --html p.html",
    "measure steps --from f.csv --json --html p.html --plot p.svg",
    "measure square --from f.csv --json --html p.html",
    "measure noise-floor --from f.csv --json --html p.html",
    "measure calibration --from f.csv --json --html p.html",
    "diagnose f.csv --json --html p.html --plot p.svg",
];
/// Rows at most: a diagnosis needs 300 readings.
const MOST_ROWS: usize = 340;

/// A folder of its own, with the project's config.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("airball-fuzz-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("config.toml"), include_str!("../../config.toml")).expect("a config");
    folder
});

/// Time, setpoint, control, duty and position of a flight of the config's rig.
static FLOWN: LazyLock<Vec<[f64; 5]>> = LazyLock::new(|| {
    let config = include_str!("../../config.toml");
    let (tables, _) = parse_text::<Tables>("config.toml", config).expect("the project's config");
    let model = tables.plant.expect("a model");
    let hover = model.hover_duty_percent;
    let mut simulator = Simulator::new(model, 3);
    let mut last = 0.0;
    let row = |k: usize| {
        let time_s = 0.02 * k as f64;
        simulator.advance_to(time_s);
        let reading = simulator.reading_mm();
        let setpoint = if time_s % 4.0 < 2.0 { 350.0 } else { 250.0 };
        let control = 0.01 * (setpoint - reading) - 0.05 * (reading - last);
        last = reading;
        simulator.drive(hover + control);
        [time_s, setpoint, control, hover + control, reading]
    };
    (0..MOST_ROWS).map(row).collect()
});

/// Each 11 bytes change a column: one cell, all by a factor, all to a number, or all beyond a row by a sum.
fn spoilt(bytes: &[u8]) -> Vec<[f64; 5]> {
    let mut rows = FLOWN.clone();
    for change in bytes.chunks_exact(11) {
        let column = usize::from(change[0] % 5);
        let at = usize::from(change[2]) * rows.len() / 256;
        let value = f64::from_le_bytes(change[3..11].try_into().expect("eight bytes"));
        if !value.is_finite() {
            continue;
        }
        match change[1] % 5 {
            0 => rows[at][column] = value,
            1 => rows.iter_mut().for_each(|row| row[column] *= value),
            2 => rows.iter_mut().for_each(|row| row[column] = value),
            3 => rows[at..].iter_mut().for_each(|row| row[column] += value),
            _ => rows.truncate(at),
        }
        if rows.is_empty() {
            break;
        }
    }
    rows.retain(|row| row.iter().all(|number| number.is_finite()));
    rows
}

fuzz_target!(|bytes: &[u8]| {
    let Some((which, changes)) = bytes.split_first() else { return };
    let folder = &*FOLDER;
    let mut text = String::from("time_s,setpoint_mm,control_percent,duty_percent,position_mm\n");
    for [time, setpoint, control, duty, position] in spoilt(changes) {
        text += &format!("{time:e},{setpoint:e},{control:e},{duty:e},{position:e}\n");
    }
    fs::write(folder.join("f.csv"), text).expect("a record is written");
    let command = COMMANDS[usize::from(*which) % COMMANDS.len()];
    let config = if command.starts_with("init") { "" } else { " --config config.toml" };
    // libFuzzer needs the working directory as it is.
    let place = |word: &str| if word.contains('.') { folder.join(word).into() } else { OsString::from(word) };
    let words = format!("airball {command}{config}");
    let cli = Cli::try_parse_from(words.split(' ').map(place)).expect("a command line");
    let refused = match cli.command {
        Command::Replay(args) => replay::replay(&args).err(),
        Command::Init(args) => init::init(&args).err(),
        Command::Identify(command) => identify::identify(&command).err(),
        Command::Measure(args) => measure::measure(&args).err(),
        Command::Diagnose(args) => diagnose::diagnose(&args).err(),
        _ => None,
    };
    assert!(refused.is_none_or(|error| !error.to_string().is_empty()));
});
