//! What is written, where it cannot be written, and what a terminal must not obey.
#![cfg(target_os = "linux")]

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
