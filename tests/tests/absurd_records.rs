//! Whole commands on records with numbers that are finite and absurd: each has an answer or a refusal in words, within
//! a minute and a gigabyte for 10,000 rows, and names no effect with confidence that only what was spoilt has made.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use system_tests::spoilt::{Spoilt, Table};
use system_tests::{Bench, Ran};

/// The most that a command may take: seconds, and kilobytes of memory, of which threads reserve some unused.
const MOST_S: u32 = 60;
const MOST_KB: u32 = 1_000_000;
/// Every command that reads a record.
const COMMANDS: [&[&str]; 15] = [
    &["diagnose", "f.csv", "--json", "--html", "p.html", "--plot", "p.svg", "--patch-out", "p.toml"],
    &["diagnose", "f.csv", "--json", "--config", "none.toml", "--init"],
    &["replay", "f.csv", "--json", "--html", "p.html", "--plot", "p.svg"],
    &["init", "f.csv", "--yes", "--force", "--out", "i.toml"],
    &["identify", "grey-box", "f.csv", "--json", "--html", "p.html", "--plot", "p.svg"],
    &["identify", "grey-box", "f.csv", "--json", "--open-loop"],
    &["identify", "transient", "f.csv", "--json"],
    &["measure", "dead-zone", "--from", "f.csv", "--json", "--html", "p.html"],
    &["measure", "force-curve", "--from", "f.csv", "--json", "--html", "p.html"],
    &["measure", "critical-gain", "--from", "f.csv", "--json", "--html", "p.html"],
    &["measure", "critical-time", "--from", "f.csv", "--json", "--html", "p.html"],
    &["measure", "steps", "--from", "f.csv", "--json", "--html", "p.html", "--plot", "p.svg"],
    &["measure", "square", "--from", "f.csv", "--json", "--html", "p.html"],
    &["measure", "noise-floor", "--from", "f.csv", "--json", "--html", "p.html"],
    &["measure", "calibration", "--from", "f.csv", "--json", "--html", "p.html"],
];

/// A flight of the simulated rig, as believed.
fn flight(bench: &Bench, rows: usize) -> Table {
    let duration_s = (rows / 50 + 1).to_string();
    let _ = bench.output(&["simulate", "--duration", &duration_s, "--log", "f.mcap"]);
    Table::of(&bench.output(&["log", "export", "f.mcap"]), rows)
}

/// Runs a command that may take no more than it should.
fn run(bench: &Bench, arguments: &[&str]) -> Ran {
    let command = bench.airball(arguments);
    let mut limited = Command::new("sh");
    let limits = format!("ulimit -v {MOST_KB}; exec timeout {MOST_S} \"$@\"");
    limited.args(["-c", &limits, "sh"]).arg(command.get_program()).args(command.get_args());
    limited.current_dir(bench.path(".")).stdin(Stdio::null());
    Ran::from(limited.output().expect("a shell runs"))
}

/// Names with a probability of at least one half, where there is a verdict.
fn sure(document: &Value) -> Vec<String> {
    if document["verdict"] == "insufficient_data" {
        return Vec::new();
    }
    let effects = document["effects"].as_array().into_iter().flatten();
    let sure = effects.filter(|effect| effect["probability"].as_f64().is_some_and(|probability| probability >= 0.5));
    sure.map(|effect| effect["name"].to_string()).collect()
}

/// All commands on one record.
fn survives(bench: &Bench, spoilt: &Spoilt) {
    bench.write("f.csv", &spoilt.csv);
    for arguments in COMMANDS {
        let what = format!("{}: {arguments:?}", spoilt.what);
        let Ran { code, output, errors } = run(bench, arguments);
        assert!(matches!(code, Some(0..=3)), "{what}: {code:?}, {errors}");
        assert!(!errors.contains("panicked"), "{what}: {errors}");
        assert!(code == Some(0) || !errors.is_empty() || !output.is_empty(), "{what}: says nothing");
        assert!(errors.lines().all(|line| line.len() < 2_000), "{what}: {errors}");
        if code == Some(0) && arguments.contains(&"--json") {
            let document: Value = serde_json::from_str(&output).unwrap_or_else(|error| panic!("{what}: {error}"));
            // Without a belief there is no clock and no unit that could be wrong: the record is then that of another
            // rig.
            if arguments.contains(&"p.toml") {
                assert_eq!(sure(&document), [""; 0], "{what}");
            }
        }
    }
}

fn survive_all(numbers: std::ops::Range<u64>, rows: usize) {
    let bench = Bench::default();
    let table = flight(&bench, rows);
    numbers.for_each(|number| survives(&bench, &table.spoilt(number)));
}

#[test]
fn every_command_survives_records_with_absurd_numbers_and_names_nothing_with_confidence() {
    survive_all(0..8, 400);
}

#[test]
#[ignore = "slow: hundreds of records"]
fn every_command_survives_hundreds_of_records_with_absurd_numbers() {
    survive_all(1000..1400, 600);
}

#[test]
#[ignore = "slow: long records"]
fn every_command_survives_ten_thousand_rows_with_absurd_numbers_in_a_minute_and_a_gigabyte() {
    survive_all(2000..2060, 10_000);
}

#[test]
fn many_absurd_records_at_once_are_each_a_row() {
    let bench = Bench::default();
    let table = flight(&bench, 330);
    std::fs::create_dir(bench.path("logs")).unwrap();
    for number in 100..106 {
        bench.write(&format!("logs/{number}.csv"), table.spoilt(number).csv);
    }
    let ran = run(&bench, &["diagnose", "--each", "logs", "--out", "reports"]);
    assert!(ran.code == Some(0) && !ran.errors.contains("panicked"), "{ran:?}");
    assert_eq!(bench.read("reports/summary.csv").lines().count(), 7);
    assert!(Path::exists(&bench.path("reports/index.html")));
}
