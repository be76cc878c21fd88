//! The log, read by an independent program: the Python package `mcap`.

use serde_json::Value;
use std::process::Command;
use system_tests::{Bench, Ran, root};

fn read(bench: &Bench, log: &str) -> Value {
    let python = root().join(".venv/bin/python");
    let output = Command::new(&python).arg(root().join("tests/read_mcap.py")).arg(bench.path(log)).output();
    let ran = Ran::from(output.unwrap_or_else(|error| panic!("{}: {error}; run scripts/test", python.display())));
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    serde_json::from_str(&ran.output).unwrap()
}

#[test]
fn python_reads_the_config_the_cycles_and_the_events() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--seed", "3", "--duration", "10", "--log", "f.mcap"]);
    let log = read(&bench, "f.mcap");
    let config = log["metadata"]["config"]["toml"].as_str().unwrap();
    assert!(config.contains("gain_mm_per_s2_per_percent = 827.2"), "{config}");
    assert_eq!(log["metadata"]["airball"]["seed"], "3");
    assert_eq!(log["channels"]["cycle"]["schema_encoding"], "jsonschema");
    assert_eq!(log["channels"]["cycle"]["message_encoding"], "json");
    assert_eq!(log["channels"]["cycle"]["messages"], 500);

    // Python's values are those of the CSV.
    let csv = bench.output(&["log", "export", "f.mcap"]);
    let last: Vec<f64> = csv.lines().last().unwrap().split(',').take(5).map(|cell| cell.parse().unwrap()).collect();
    let cycle = &log["last_cycle"];
    let keys = ["time_s", "setpoint_mm", "control_percent", "duty_percent", "position_mm"];
    assert_eq!(keys.map(|key| cycle[key].as_f64().unwrap()).to_vec(), last);
    assert_eq!(log["events"][0]["text"], "waiting → flying");
}
