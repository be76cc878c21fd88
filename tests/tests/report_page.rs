//! The pages of the program, opened in a real browser.

use std::process::Command;
use system_tests::{Bench, Ran, root};

/// A file name with markup.
const STRANGER: &str = "<img src=x onerror=alert(1)>";

/// A bench with the project's experiments and patches, and its config under that name.
fn bench() -> Bench {
    let bench = Bench::default();
    for directory in ["docs", "experiments"] {
        std::os::unix::fs::symlink(root().join(directory).canonicalize().unwrap(), bench.path(directory)).unwrap();
    }
    bench.write(&format!("{STRANGER}.toml"), bench.read("config.toml"));
    bench
}

/// Runs the words of a command line.
fn run(bench: &Bench, line: &str) -> String {
    let words: Vec<String> = line.split_whitespace().map(|word| word.replace("STRANGER", STRANGER)).collect();
    bench.output(&words.iter().map(String::as_str).collect::<Vec<_>>())
}

fn diagnosis(bench: &Bench) {
    let _ = run(bench, "simulate --patch docs/dead-zone.toml --log STRANGER.mcap");
    let said = run(bench, "diagnose STRANGER.mcap --html report.html --patch-out mended.toml");
    assert!(said.contains("dead_zone"), "{said}");
    let _ = run(bench, "replay STRANGER.mcap --html replay.html");
    assert!(bench.read("report.html").contains("The rig has a dead zone that the simulator lacks"));
    let page = bench.read("report.html");
    // The effect itself is drawn; what is not significant is said and not drawn.
    assert!(page.contains("The dead zone: acceleration of the ball over duty"));
    assert!(
        page.contains("No frequency band has significantly more misfit than noise")
            && !page.contains("in a third of an octave")
    );
    // The checks with their limits, and the seed and the command in the head.
    assert!(page.contains("at least 150 readings in free flight") && page.contains("seed 1"));
    assert!(page.contains("<span>diagnose</span>"));
    // The text to copy on the page is the patch.
    assert!(bench.read("report.html").contains(bench.read("mended.toml").trim()));
}

fn identification(bench: &Bench) {
    let _ = run(bench, "simulate --experiment experiments/identify.toml --log STRANGER-i.mcap");
    let _ = run(bench, "identify grey-box STRANGER-i.mcap --html grey-box.html");
    assert!(bench.read("grey-box.html").contains("A plant of three poles explains this record but for noise"));
    for gain in ["0.011", "0.015"] {
        bench.write("kp.toml", format!("[controller.pid]\nkp_per_mm = {gain}\n"));
        let flight = format!("--experiment experiments/gain-pulses.toml --log STRANGER-{gain}.mcap");
        let _ = run(bench, &format!("simulate {flight} --patch docs/gain-patch.toml --patch kp.toml"));
    }
    let _ = run(bench, "identify transient STRANGER-0.011.mcap STRANGER-0.015.mcap --html transient.html");
    assert!(bench.read("transient.html").contains("The overshoots of 2 gains give K_g = "));
    let _ = run(bench, "identify third-pole --critical-gain 0.038 --config STRANGER.toml --html third-pole.html");
    assert!(bench.read("third-pole.html").contains("gives the model the critical gain of the rig"));
}

/// Each measurement, with words of its answer.
fn measurements(bench: &Bench) {
    let of = |what: &str, patch: &str, answer: &str| {
        let _ = run(bench, &format!("measure {what} --virtual --log STRANGER-{what}.mcap --html {what}.html {patch}"));
        assert!(bench.read(&format!("{what}.html")).contains(answer), "{what}: {answer}");
    };
    of("dead-zone", "--patch docs/dead-zone.toml", "of duty the ball neither rises nor falls");
    of("critical-gain", "", "above it the loop is unstable");
    of("steps", "", "The ball overshoots a step by");
    of("square", "", "The ball overshoots a step by");
    of("force-curve", "", "1 % of duty gives ");
    of("noise-floor", "", "The noise of a reading is ");
    of("calibration", "", "The zero of the sensor passes; its scale cannot be measured");
}

fn designs(bench: &Bench) {
    let _ = run(bench, "design pid --config STRANGER.toml --html design.html --patch-out gains.toml");
    assert!(bench.read("design.html").contains("The loop is stable: its gain may rise"));
    assert!(bench.read("design.html").contains(&bench.read("gains.toml").trim().replace('"', "&quot;")));
    bench.write("wild.toml", "[controller.pid]\nkp_per_mm = 0.5\n");
    let _ = run(bench, "design loop --config STRANGER.toml --patch wild.toml --html unstable.html");
    assert!(bench.read("unstable.html").contains("This loop is unstable: do not fly it"));
    let _ = run(bench, "design observer --config STRANGER.toml --html observer.html --patch-out observer.toml");
    assert!(bench.read("observer.html").contains("gain on the position is "));
    let _ = run(bench, "design critical-gain --config STRANGER.toml --html models.html --patch-out pole.toml");
    assert!(bench.read("models.html").contains("2 of the three models are stable at any gain; the rig is not"));
}

#[test]
fn pages_open_offline_and_can_be_read_zoomed_and_printed_by_everyone() {
    let bench = &bench();
    std::thread::scope(|scope| {
        for pages in [diagnosis, identification, measurements, designs] {
            scope.spawn(move || pages(bench));
        }
    });

    // The tests of a file run one after the other, on one processor: two processes test half of the pages each.
    let half = |part: &str| {
        let mut browser = Command::new("node");
        let file = root().join("tests/browser/page.test.mjs");
        browser.arg("--test").arg(file).env("PAGES", bench.path(".")).env("PART", part);
        Ran::from(browser.output().unwrap_or_else(|error| panic!("node: {error}; run scripts/test")))
    };
    let ran =
        std::thread::scope(|scope| ["0", "1"].map(|part| scope.spawn(move || half(part))).map(|half| half.join()));
    for ran in ran.map(Result::unwrap) {
        assert_eq!(ran.code, Some(0), "{}\n{}", ran.output, ran.errors);
    }
}

#[test]
fn a_page_replaces_an_older_one_of_the_program_and_nothing_else() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "8", "--log", "f.mcap"]);
    let replay = || bench.run(&["replay", "f.mcap", "--html", "page.html"]);
    assert_eq!(replay().code, Some(0));
    assert_eq!(replay().code, Some(0));
    for notes in ["my notes", "<!DOCTYPE html><html><head><title>My notes on airball</title></head></html>"] {
        bench.write("page.html", notes);
        let refused = replay();
        assert!(refused.code == Some(1) && refused.errors.contains("page.html exists and is no page"), "{refused:?}");
        assert_eq!(bench.read("page.html"), notes);
    }
    for command in
        [&["design", "pid"][..], &["measure", "noise-floor", "--from", "f.mcap"], &["identify", "grey-box", "f.mcap"]]
    {
        let refused = bench.run(&[command, &["--html", "config.toml"]].concat());
        assert!(refused.code == Some(1) && refused.errors.contains("config.toml exists"), "{refused:?}");
    }
    let config = bench.run(&["diagnose", "f.mcap", "--html", "config.toml"]);
    assert!(config.code == Some(1) && bench.read("config.toml").contains("[plant]"), "{}", config.errors);
}
