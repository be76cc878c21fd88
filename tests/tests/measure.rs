//! `airball measure` as a command: one flight, three ways to analyse it, and its output files.

use serde_json::Value;
use system_tests::Bench;

/// A ball at rest, for a time that is short enough for real time.
const SHORT: &str = "title = \"rest\"\n[[segment]]\nduration_s = 5.0\nduty_percent.constant = { value = 0.0 }\n";

fn found(bench: &Bench, arguments: &[&str]) -> Value {
    serde_json::from_str(&bench.output(arguments)).unwrap()
}

#[test]
fn a_flight_in_virtual_time_leaves_a_log_a_picture_and_a_patch_that_the_config_takes() {
    let bench = Bench::default();
    let files = ["--log", "still.mcap", "--plot", "still.svg", "--patch-out", "still.toml", "--json"];
    let flown = found(&bench, &[&["measure", "noise-floor", "--virtual"], &files[..]].concat());
    assert_eq!(flown["schema"], "airball.measure/1");
    let noise = flown["found"]["sensor_mm"]["value"].as_f64().unwrap();
    assert!((2.2..2.8).contains(&noise), "{flown}");
    assert!(bench.read("still.svg").starts_with("<svg"));
    let printed = bench.output(&["config", "print", "--patch", "still.toml"]);
    let written = printed.lines().find_map(|line| line.strip_prefix("sensor_mm = ")?.parse::<f64>().ok()).unwrap();
    // A patch has six significant digits.
    assert!((written / noise - 1.0).abs() < 1e-5, "{written} and {noise}");

    let again = found(&bench, &["measure", "noise-floor", "--from", "still.mcap", "--json"]);
    assert_eq!(again["found"], flown["found"]);
}

#[test]
fn the_critical_integral_time_of_the_simulated_rig_is_that_of_its_model() {
    let flown = found(&Bench::default(), &["measure", "critical-time", "--virtual", "--log", "t.mcap", "--json"]);
    let ti_s = &flown["found"]["ti_s"];
    // 0.706 s for the thesis' G_c at K_p = 0.01; the rig's delays add a little.
    assert!((0.65..0.85).contains(&ti_s["value"].as_f64().unwrap()), "{ti_s}");
}

#[test]
fn the_simulated_rig_in_real_time_is_measured_like_the_rig() {
    let bench = Bench::default();
    bench.write("short.toml", SHORT);
    let flown =
        found(&bench, &["measure", "noise-floor", "--sim", "--experiment", "short.toml", "--log", "s.mcap", "--json"]);
    assert!(flown["found"]["readings"].as_f64().unwrap() > 100.0, "{flown}");
}

#[test]
fn a_log_of_something_else_and_a_patch_of_nothing_are_refused_with_what_to_do() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "5", "--log", "flight.mcap"]);
    let ran = bench.run(&["measure", "dead-zone", "--from", "flight.mcap"]);
    assert_eq!(ran.code, Some(1), "{}", ran.errors);
    assert!(ran.errors.contains("flight.mcap: 0 jumps"), "{}", ran.errors);
    let ran = bench.run(&["measure", "critical-gain", "--from", "flight.mcap"]);
    assert_eq!(ran.code, Some(1), "{}", ran.errors);
    assert!(ran.errors.contains("no step under a proportional-integral law"), "{}", ran.errors);
    let ran = bench.run(&["measure", "steps", "--virtual", "--patch-out", "p.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.errors);
    assert!(ran.errors.contains("leave --patch-out out"), "{}", ran.errors);
    let ran = bench.run(&["measure", "noise-floor", "--virtual", "--travel-mm", "500"]);
    assert_eq!(ran.code, Some(2), "{}", ran.errors);
    assert!(ran.errors.contains("--travel-mm 500 is the ball's way in a calibration"), "{}", ran.errors);
}
