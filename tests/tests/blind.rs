//! Blind scoring: simulated rigs of an independent program, diagnosed by `airball` and scored by `blind`, and the
//! committed verdicts.

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};
use system_tests::{Bench, root};

/// Withheld cases in `cases`, their truth and bounds in `sealed`; the output of the world.
fn world(bench: &Bench, arguments: &[&str]) -> String {
    fs::create_dir(bench.path("sealed")).unwrap();
    let mut world = Command::new(env!("CARGO_BIN_EXE_world"));
    world.args(["--out", "cases", "--truth", "sealed/truth.json", "--bounds", "sealed/bounds.json"]).args(arguments);
    let output = world.current_dir(bench.path(".")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Count and number of cases of a share.
fn share(document: &Value, name: &str) -> (u64, u64) {
    let shares = document["score"]["shares"].as_array().unwrap();
    let share = shares.iter().find(|share| share["name"] == name).unwrap();
    (share["count"].as_u64().unwrap(), share["n"].as_u64().unwrap())
}

#[test]
fn withheld_cases_are_diagnosed_and_scored() {
    let bench = Bench::default();
    let printed = world(&bench, &["--seed", "sample", "--count", "8", "--jobs", "2"]);
    let digest = Sha256::digest(fs::read(bench.path("sealed/truth.json")).unwrap());
    let seal: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(printed.lines().next(), Some(format!("sha256 of the truth: {seal}").as_str()));

    let truth = ["--truth", "sealed/truth.json", "--bounds", "sealed/bounds.json", "--json"];
    let ran = bench.judge(&[&["cases", "--out", "verdicts", "--leave-out", "1"], &truth[..]].concat());
    assert_eq!((ran.code, ran.errors.as_str()), (Some(0), ""), "no bar in a pipe");
    let document = json(&ran.output);
    assert_eq!((&document["schema"], &document["unreadable"]), (&Value::from("airball.blind/1"), &Value::from(0)));
    assert_eq!(share(&document, "read"), (8, 8));
    assert_eq!(share(&document, "left_out").1, 1);
    let (alarms, quiet) = share(&document, "false_alarm");
    assert!(quiet >= 2 && 2 * alarms <= quiet, "{alarms} false alarms in {quiet}: {document}");

    // The information in a record decides which cases count: missed ones among them are listed as losses.
    let losses = document["score"]["losses"].as_array().unwrap();
    for (kind, row) in [("single", "top_1_shown"), ("pair", "pair_both_shown")] {
        let (right, shown) = share(&document, row);
        let all = document["score"]["cases"][kind].as_u64().unwrap();
        let of_kind = losses.iter().filter(|loss| loss["kind"] == kind && loss["left_out"] == false);
        let lost = of_kind.filter(|loss| loss["shown"].as_f64().is_some_and(|nats| nats >= 5.0)).count() as u64;
        assert!(shown <= all && shown - right == lost, "{kind}: {right} of {shown} of {all}, {lost} lost");
        assert!(kind == "pair" || shown > 0, "no single of the sample is shown: {document}");
    }

    // The answer for a case is the same text as that of the command for one log.
    let alone = bench.output(&["diagnose", "--json", "cases/case-003.csv", "--config", "cases/case-003.toml"]);
    assert_eq!(bench.read("verdicts/case-003.json"), alone);

    let again = bench.judge(&[&["cases", "--verdicts", "verdicts"], &truth[..]].concat());
    assert_eq!(again.output, ran.output, "{}", again.errors);
    let page = bench.judge(&["cases", "--verdicts", "verdicts", "--truth", "sealed/truth.json"]).output;
    assert!(page.starts_with("8 cases: ") && page.contains("| single: the first entry names it "), "{page}");
}

/// A record without motion, which is answered quickly.
fn still() -> String {
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    format!("time_s,duty_percent,position_mm\n{rows}")
}

#[test]
fn a_bad_case_is_named_and_counted_and_the_others_are_answered() {
    let bench = Bench::default();
    fs::create_dir(bench.path("cases")).unwrap();
    for case in ["case-000", "case-001", "case-002"] {
        bench.write(&format!("cases/{case}.csv"), still());
    }
    bench.write("cases/case-001.csv", "time_s,duty_percent,position_mm\n0,oops,3\n");
    for case in ["case-000", "case-001"] {
        bench.write(&format!("cases/{case}.toml"), bench.read("config.toml"));
    }
    let ran = bench.judge(&["cases", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    let document = json(&ran.output);
    assert_eq!((&document["unreadable"], &document["answers"]["insufficient_data"]), (&2.into(), &1.into()));
    assert_eq!(document["score"], Value::Null);
    for reason in ["case-001: ", "`oops` is no number", "case-002: ", "case-002.toml"] {
        assert!(ran.errors.contains(reason), "{reason} in {}", ran.errors);
    }
    fs::remove_file(bench.path("cases/case-000.toml")).unwrap();
    let ran = bench.judge(&["cases"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("none of the 3 cases could be diagnosed"), "{}", ran.errors);
}

#[test]
fn a_wrong_truth_and_an_unknown_effect_are_refused() {
    let bench = Bench::default();
    fs::create_dir(bench.path("cases")).unwrap();
    bench.write("cases/case-000.csv", still());
    bench.write("truth.json", r#"{ "schema": "world.truth/9", "cases": [] }"#);
    let ran = bench.judge(&["cases", "--truth", "truth.json"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("world.truth/9") && ran.errors.contains("world.truth/1"), "{}", ran.errors);
    let diagnose = bench.run(&["diagnose", "cases/case-000.csv", "--without", "fan_lagg"]);
    for ran in [bench.judge(&["cases", "--without", "fan_lagg"]), diagnose] {
        assert_eq!(ran.code, Some(2));
        assert!(ran.errors.contains("fan_lagg") && ran.errors.contains("spin_asymmetry"), "{}", ran.errors);
    }
    let ran = bench.judge(&["cases", "--airball", "no/airball"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("no/airball; build it with `cargo build"), "{}", ran.errors);
}

#[test]
fn an_effect_that_is_left_out_is_not_named_and_the_judge_asks_for_it_so() {
    let bench = Bench::default();
    let _ = world(&bench, &["--seed", "sample", "--count", "12", "--only", "fan_lag", "--case", "3"]);
    let alone = ["diagnose", "--json", "cases/case-003.csv", "--config", "cases/case-003.toml"];
    let [all, without] = [&[][..], &["--without", "fan_lag"]].map(|more| bench.output(&[&alone[..], more].concat()));
    let names = |text: &str| json(text)["effects"].to_string();
    assert!(names(&all).contains("fan_lag") && !names(&without).contains("fan_lag"), "{all}\n{without}");
    let ran = bench.judge(&["cases", "--without", "fan_lag", "--out", "verdicts"]);
    assert_eq!((ran.code, bench.read("verdicts/case-003.json")), (Some(0), without), "{}", ran.errors);
}

/// Cases of a round that have a verdict.
fn verdicts(round: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        fs::read_dir(round.join("verdicts")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Numbers that depend on the commit; outside a checkout they are constant.
fn chosen(count: usize, of: usize) -> Vec<usize> {
    let head = Command::new("git").args(["rev-parse", "HEAD"]).current_dir(root()).output();
    let head = head.ok().filter(|output| output.status.success()).map_or_else(Vec::new, |output| output.stdout);
    let digest = Sha256::digest(head);
    digest.chunks(2).take(count).map(|pair| (usize::from(pair[0]) * 256 + usize::from(pair[1])) % of).collect()
}

/// Compares some committed verdicts of a round with what the program says.
fn compare_some(name: &str, count: usize) {
    let round = root().join("tests/blind").join(name);
    let (bench, all) = (Bench::default(), verdicts(&round));
    let records = fs::read_dir(&round).unwrap().filter(|entry| {
        let name = entry.as_ref().unwrap().file_name();
        name.to_str().unwrap().ends_with(".csv.zst")
    });
    assert_eq!((records.count(), all.len()), (120, 120), "{name}: verdicts are missing; make them with scripts/round");
    for which in chosen(count, all.len()) {
        let case = all[which].file_stem().unwrap().to_str().unwrap();
        let [record, belief] = ["csv.zst", "toml"].map(|ending| round.join(format!("{case}.{ending}")));
        let said =
            bench.output(&["diagnose", "--json", record.to_str().unwrap(), "--config", belief.to_str().unwrap()]);
        let committed = fs::read_to_string(&all[which]).unwrap();
        assert_eq!(committed, said, "{name}/{case}; make them again with scripts/round");
    }
}

#[test]
fn committed_verdicts_of_round_1_are_what_the_program_says_of_the_withheld_records() {
    compare_some("round-1", 3);
}

#[test]
fn committed_verdicts_of_round_2_are_what_the_program_says_of_the_withheld_records() {
    compare_some("round-2", 2);
}
