//! The pages that the program writes, opened in a real browser.

use std::process::Command;
use system_tests::{Bench, Ran, root};

/// A name that a stranger could give to a file.
const LOG: &str = "<img src=x onerror=alert(1)>.mcap";

#[test]
fn pages_open_offline_and_can_be_read_zoomed_and_printed_by_everyone() {
    let bench = Bench::default();
    let patch = root().join("docs/dead-zone.toml");
    let _ = bench.output(&["simulate", "--patch", patch.to_str().unwrap(), "--log", LOG]);
    let said = bench.output(&["diagnose", LOG, "--html", "report.html", "--patch-out", "mended.toml"]);
    assert!(said.contains("dead_zone"), "{said}");
    let _ = bench.output(&["replay", LOG, "--html", "replay.html"]);
    assert!(bench.read("report.html").contains("The rig has a dead zone that the simulator lacks"));
    // What the page offers to copy is the patch.
    assert!(bench.read("report.html").contains(bench.read("mended.toml").trim()));

    let mut browser = Command::new("node");
    browser.arg("--test").arg(root().join("tests/browser/page.test.mjs"));
    browser.env("REPORT", bench.path("report.html")).env("REPLAY", bench.path("replay.html"));
    let ran = Ran::from(browser.output().unwrap_or_else(|error| panic!("node: {error}; run scripts/test")));
    assert_eq!(ran.code, Some(0), "{}\n{}", ran.output, ran.errors);
}

#[test]
fn a_page_replaces_an_older_one_and_nothing_else() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "8", "--log", "f.mcap"]);
    let replay = || bench.run(&["replay", "f.mcap", "--html", "page.html"]);
    assert_eq!(replay().code, Some(0));
    assert_eq!(replay().code, Some(0));
    bench.write("page.html", "my notes");
    let refused = replay();
    assert!(refused.code == Some(1) && refused.errors.contains("page.html exists and is no HTML page"), "{refused:?}");
    assert_eq!(bench.read("page.html"), "my notes");
    let config = bench.run(&["diagnose", "f.mcap", "--html", "config.toml"]);
    assert!(config.code == Some(1) && bench.read("config.toml").contains("[plant]"), "{}", config.errors);
}
