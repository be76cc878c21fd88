//! Many logs, each diagnosed by itself: reports, table, restarts and shares.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use system_tests::Bench;

/// A record without motion, which is answered quickly.
fn still(height: u32) -> String {
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,{height}\n", 0.02 * f64::from(k))).collect();
    format!("time_s,duty_percent,position_mm\n{rows}")
}

/// A bench with two logs, one of them in a folder of the folder, a bad one and a file that is no log.
fn bench() -> Bench {
    let bench = Bench::default();
    fs::create_dir_all(bench.path("logs/monday")).unwrap();
    bench.write("logs/a.csv", still(300));
    bench.write("logs/monday/b.csv", still(200));
    bench.write("logs/bad.csv", "x,y\n1,2\n");
    bench.write("logs/notes.md", "no log");
    bench.write("logs/px4.ulg", b"ULog\x01\x12\x35\x01 and more");
    bench
}

/// Every file in a folder, by its name there.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(path).unwrap());
            }
        }
    }
    all
}

#[test]
fn every_log_of_a_folder_has_a_page_and_a_row_and_a_bad_one_has_its_reason() {
    let bench = bench();
    let said = bench.output(&["diagnose", "--each", "logs", "--out", "reports"]);
    assert!(said.starts_with("0 of 4 logs are diagnosed, 2 cannot answer, 2 cannot be read or diagnosed\n"), "{said}");
    let made = files(&bench.path("reports"));
    let expected = [
        "a.csv.html",
        "a.csv.json",
        "bad.csv.error",
        "index.html",
        "monday/b.csv.html",
        "monday/b.csv.json",
        "px4.ulg.error",
        "summary.csv",
    ];
    assert_eq!(made.keys().collect::<Vec<_>>(), expected);
    let table = bench.read("reports/summary.csv");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert!(rows[0].starts_with("a.csv,insufficient_data,") && rows[2].starts_with("monday/b.csv,"), "{table}");
    assert!(rows[1].starts_with("bad.csv,,") && rows[1].contains("no column `time_s`"), "{table}");
    assert!(bench.read("reports/index.html").contains("href=\"./monday/b.csv.html\""));
    // Why a log cannot answer is on the page, and how a log of another program is converted.
    let page = bench.read("reports/index.html");
    assert!(page.contains("the duty stays within") && page.contains("ulog2csv"), "{page}");
    // One log alone gives the same document.
    let alone = bench.run(&["diagnose", "--json", "logs/a.csv"]).output;
    assert_eq!(bench.read("reports/a.csv.json"), alone.trim_end());
}

#[test]
fn shares_and_restarts_leave_the_same_files_and_do_nothing_twice() {
    let bench = bench();
    let _ = bench.output(&["diagnose", "--each", "logs", "--out", "whole"]);
    for share in ["2/2", "1/2", "1/2"] {
        let _ = bench.output(&["diagnose", "--each", "logs", "--out", "shares", "--shard", share]);
    }
    assert_eq!(files(&bench.path("whole")), files(&bench.path("shares")));
    // What is there is kept, and what is missing is made again.
    bench.write("whole/a.csv.json", "{}");
    fs::remove_file(bench.path("whole/monday/b.csv.json")).unwrap();
    let ran = bench.run(&["diagnose", "--each", "logs", "--out", "whole"]);
    assert_eq!(bench.read("whole/a.csv.json"), "{}");
    assert_eq!(bench.read("whole/monday/b.csv.json"), bench.read("shares/monday/b.csv.json"));
    assert!(ran.errors.contains("of 3: monday/b.csv") && !ran.errors.contains("of 3: a.csv"), "{}", ran.errors);
}

#[test]
fn wrong_usage_of_many_logs_is_named() {
    let bench = bench();
    fs::create_dir(bench.path("none")).unwrap();
    bench.write("a.csv", still(100));
    for (arguments, words) in [
        (&["--each", "logs"][..], "--out"),
        (&["logs", "--out", "r"], "--each"),
        (&["--each", "none", "--out", "r"], "no log is in there"),
        (&["--each", "a.csv", "logs/a.csv", "--out", "r"], "one name"),
        (&["--each", "logs", "--out", "r", "--shard", "5/4"], "3/40"),
    ] {
        let ran = bench.run(&[&["diagnose"], arguments].concat());
        assert!(ran.code == Some(2) && ran.errors.contains(words), "{arguments:?}: {}", ran.errors);
    }
}
