//! The simulator of the withheld cases: it is independent, its cases are reproducible, and its hash is right.

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};
use system_tests::{Bench, root};
use tempfile::TempDir;

/// A set of cases in a directory of its own.
struct Set {
    directory: TempDir,
    printed: String,
}

impl Set {
    fn new(seed: &str, arguments: &[&str]) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let place = |name| directory.path().join(name);
        let mut world = Command::new(env!("CARGO_BIN_EXE_world"));
        world
            .args(["--seed", seed, "--out"])
            .arg(place("cases"))
            .arg("--truth")
            .arg(place("truth.json"))
            .args(arguments);
        let output = world.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Self { printed: String::from_utf8(output.stdout).unwrap(), directory }
    }

    fn truth(&self) -> Value {
        serde_json::from_slice(&fs::read(self.directory.path().join("truth.json")).unwrap()).unwrap()
    }

    /// The files of the cases, by name.
    fn files(&self) -> Vec<(String, String)> {
        let entries = fs::read_dir(self.directory.path().join("cases")).unwrap().map(|entry| entry.unwrap());
        let mut files: Vec<_> = entries
            .map(|file| (file.file_name().into_string().unwrap(), fs::read_to_string(file.path()).unwrap()))
            .collect();
        files.sort();
        files
    }

    /// Rows of every record: time, setpoint, control, duty, position.
    fn records(&self) -> Vec<Vec<Vec<f64>>> {
        let row = |line: &str| line.split(',').map(|number| number.parse().unwrap()).collect();
        let record = |text: &str| text.lines().skip(1).map(row).collect();
        self.files().iter().filter(|(name, _)| name.ends_with(".csv")).map(|(_, text)| record(text)).collect()
    }
}

/// Names in the effects of a truth, one set per case.
fn names(truth: &Value) -> Vec<BTreeSet<String>> {
    let of = |case: &Value| {
        let effects = case["effects"].as_array().unwrap().iter();
        effects.map(|effect| effect["name"].as_str().unwrap().to_owned()).collect()
    };
    truth["cases"].as_array().unwrap().iter().map(of).collect()
}

#[test]
fn the_tests_depend_on_no_crate_that_they_judge() {
    let mut cargo = Command::new(env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
    let tree = cargo.args(["tree", "--package", "system-tests", "--edges", "all", "--prefix", "none", "--offline"]);
    let output = tree.args(["--format", "{p}"]).current_dir(root()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let crates: BTreeSet<&str> = text.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(crates.contains("system-tests") && crates.contains("sha2"));
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        let directory = entry.unwrap().path();
        let manifest = fs::read_to_string(directory.join("Cargo.toml")).unwrap();
        let name = manifest.lines().find_map(|line| line.strip_prefix("name = \"")).unwrap().trim_end_matches('"');
        assert!(!crates.contains(name), "{name}");
    }
}

fn sources(directory: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

#[test]
fn no_file_of_the_world_uses_a_crate_that_it_judges_or_a_file_from_elsewhere() {
    let files = sources(&root().join("tests/src/world"));
    assert!(files.len() > 10);
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let code: Vec<&str> = text.lines().filter_map(|line| line.split("//").next()).collect();
        for name in ["plant", "diagnose", "control", "hal", "airball", "system_tests"] {
            for used in [format!("{name}::"), format!("use {name};"), format!("extern crate {name}")] {
                let found = |line: &&&str| {
                    line.match_indices(&used)
                        .any(|(at, _)| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
                };
                assert!(!code.iter().any(|line| found(&line)), "{}: {used}", file.display());
            }
        }
        for elsewhere in ["#[path", "include!", "include_str!", "Command::new"] {
            assert!(!code.iter().any(|line| line.contains(elsewhere)), "{}: {elsewhere}", file.display());
        }
    }
}

#[test]
fn the_hash_is_printed_first_and_is_that_of_the_truth() {
    let set = Set::new("seal", &["--count", "3"]);
    let digest = Sha256::digest(fs::read(set.directory.path().join("truth.json")).unwrap());
    let digits: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(set.printed.lines().next(), Some(format!("sha256 of the truth: {digits}").as_str()));
    assert!(set.truth()["salt"].as_str().unwrap().len() >= 32);
    assert!(set.files().iter().all(|(name, _)| name.starts_with("case-")));
    let other = Set::new("seal", &["--count", "3", "--salt", "another"]);
    assert!(other.printed.lines().next() != set.printed.lines().next() && other.files() == set.files());
}

#[test]
fn a_seed_makes_the_same_set_again_and_each_case_alone() {
    let set = Set::new("again", &["--count", "4"]);
    let files = set.files();
    assert_eq!(files.len(), 8);
    assert_eq!(Set::new("again", &["--count", "4", "--jobs", "3"]).files(), files);
    assert_eq!(Set::new("again", &["--count", "4", "--case", "2"]).files(), files[4..6]);
    assert_eq!(Set::new("again", &["--count", "2"]).files(), files[..4]);
    assert!(Set::new("other", &["--count", "4"]).files() != files);
}

#[test]
fn a_truth_beside_the_cases_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let mut world = Command::new(env!("CARGO_BIN_EXE_world"));
    let world = world.args(["--seed", "x", "--count", "1", "--out", ".", "--truth", "truth.json"]);
    let output = world.current_dir(directory.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("beside the cases"));
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[test]
fn sets_of_one_effect_of_one_kind_and_without_an_effect_are_what_they_say() {
    let only = Set::new("only", &["--count", "6", "--only", "wall_friction"]).truth();
    assert!(names(&only).iter().all(|names| names.iter().eq(["wall_friction"])));
    let outside = Set::new("only", &["--count", "3", "--only", "gusts"]).truth();
    assert!(outside["cases"].as_array().unwrap().iter().all(|case| case["kind"] == "outside"));
    let pairs = ["--count", "6", "--mix", "pair", "--only", "dead_zone", "--only", "fan_lag", "--only", "turbulence"];
    let pairs = Set::new("pairs", &[&pairs[..], &["--leave-out", "turbulence"]].concat()).truth();
    assert!(names(&pairs).iter().all(|names| names.iter().eq(["dead_zone", "fan_lag"])));
    let none = Set::new("none", &["--count", "4", "--mix", "none=1"]).truth();
    assert!(names(&none).iter().all(BTreeSet::is_empty));
}

#[test]
fn records_are_finite_in_the_pipe_and_excited() {
    let set = Set::new("records", &["--count", "120", "--jobs", "2"]);
    for (rows, case) in set.records().iter().zip(set.truth()["cases"].as_array().unwrap()) {
        let spread = |column: usize| {
            let mean = rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64;
            (rows.iter().map(|row| (row[column] - mean).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
        };
        let resting = rows.iter().filter(|row| row[4] < 6.0 || row[4] > 594.0).count();
        assert!(rows.iter().flatten().all(|number| number.is_finite()), "{case}");
        assert!(rows.iter().all(|row| (0.0..=100.0).contains(&row[3]) && (-150.0..=750.0).contains(&row[4])), "{case}");
        // A ball that strong friction holds moves little.
        assert!(resting * 20 < rows.len() && spread(4) > 10.0 && spread(3) > 0.1, "{case}");
        assert!(rows.windows(2).all(|pair| (0.0169..0.0201).contains(&(pair[1][0] - pair[0][0]))), "{case}");
        assert!((rows[0][1] - rows[0][4]).abs() < 130.0, "{case}");
        assert!(rows[0][0] == 0.0 && (59.0..100.1).contains(&rows.last().unwrap()[0]), "{case}");
    }
}

#[test]
fn the_program_reads_records_and_beliefs_and_finds_no_gap_where_there_is_none() {
    let set = Set::new("read", &["--count", "8", "--mix", "none"]);
    let (mut error, mut floor, bench) = (0.0, 0.0, Bench::default());
    for (name, text) in set.files() {
        bench.write(&name, text);
    }
    for case in 0..8 {
        let [log, config] = ["csv", "toml"].map(|ending| format!("case-{case:03}.{ending}"));
        let gap: Value = serde_json::from_str(&bench.output(&["replay", "--json", &log, "--config", &config])).unwrap();
        error += gap["error_mm"][2].as_f64().unwrap().powi(2);
        floor += gap["floor_mm"][2].as_f64().unwrap().powi(2);
    }
    // A belief with small errors increases the gap a little.
    let ratio = f64::sqrt(error / floor);
    assert!((0.9..1.6).contains(&ratio), "{ratio}");
}
