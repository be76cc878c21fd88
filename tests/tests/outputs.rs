//! What is written, where it cannot be written, and what a terminal must not obey.
#![cfg(target_os = "linux")]

use std::process::{Command, Stdio};
use system_tests::Bench;

#[test]
fn a_full_disk_takes_the_next_experiment_and_leaves_the_answer_of_a_diagnosis() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let full = bench.airball(&["diagnose", "still.csv", "--json", "--next-out", "/dev/full"]).output().unwrap();
    let (said, answer) = (String::from_utf8_lossy(&full.stderr), String::from_utf8_lossy(&full.stdout));
    assert_eq!(full.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot write the experiment /dev/full"), "{said}");
    assert!(answer.contains("\"verdict\":\"insufficient_data\""), "{answer}");
}

#[test]
fn control_characters_are_escaped_on_both_outputs() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    let name = "\u{1b}[31m.csv";
    bench.write(name, format!("time_s,duty_percent,position_mm\n{rows}"));
    let run = bench.airball(&["replay", name]).output().unwrap();
    for said in [String::from_utf8(run.stdout).unwrap(), String::from_utf8(run.stderr).unwrap()] {
        assert!(said.contains("\\u001b[31m.csv: ") && !said.contains('\u{1b}'), "{said}");
    }
}

#[test]
fn every_file_that_is_written_is_announced_beside_a_document_on_standard_error() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    for command in
        ["design pid --patch-out p.toml --plot p.svg --html p.html", "replay still.csv --plot p.svg --html p.html"]
    {
        let words: Vec<&str> = command.split(' ').collect();
        let said = bench.output(&words);
        let json = bench.run(&[&words[..], &["--json"]].concat());
        assert!(json.output.lines().count() == 1 && json.output.starts_with('{'), "{command}: {}", json.output);
        for (flag, what) in [("--patch-out", "patch"), ("--plot", "picture"), ("--html", "page")] {
            let Some(at) = words.iter().position(|word| *word == flag) else { continue };
            let file = words[at + 1];
            assert!(said.contains(&format!("\n{what:<9} {file}\n")), "{command}: {said}");
            assert!(json.errors.contains(&format!("note: wrote the {what} {file}\n")), "{command}: {}", json.errors);
        }
    }
}

#[test]
fn a_terminal_gets_wrapped_sentences_and_a_pipe_gets_whole_lines() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let piped = bench.output(&["replay", "still.csv"]);
    let sentence = piped.lines().last().unwrap();
    assert!(sentence.len() > 100, "{sentence}");
    // `script` runs a command on a terminal of its own.
    let airball = bench.airball(&[]);
    let line = format!("stty rows 30 cols 90; {} replay still.csv", airball.get_program().display());
    let mut script = Command::new("script");
    script.args(["-qec", &line, "/dev/null"]).current_dir(bench.path("")).stdin(Stdio::null());
    let shown = String::from_utf8(script.output().unwrap().stdout).unwrap().replace('\r', "");
    assert!(shown.lines().all(|line| line.chars().count() <= 90), "{shown}");
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert!(words(&shown).ends_with(&words(sentence)), "{shown}");
}

#[test]
fn what_is_said_aside_begins_with_its_kind() {
    let bench = Bench::default();
    let failed = bench.run(&["replay", "nosuch.csv"]);
    assert!(failed.errors.starts_with("error: cannot read nosuch.csv"), "{}", failed.errors);
    bench.write("cut.mcap", "");
    let _ = bench.output(&["simulate", "--duration", "5", "--log", "whole.mcap"]);
    let whole = std::fs::read(bench.path("whole.mcap")).unwrap();
    bench.write("cut.mcap", &whole[..whole.len() / 2]);
    let cut = bench.run(&["log", "info", "cut.mcap"]);
    assert!(cut.errors.starts_with("warning: cut.mcap: "), "{}", cut.errors);
}
