//! The diagnosis from the command line: a verdict, a document, and a patch that mends the simulator.

use serde_json::Value;
use system_tests::Bench;

const STUCK: &str = "[plant.effects.dead_zone]\nlower_percent = -0.3\nupper_percent = 0.3\n";

fn diagnose(bench: &Bench, arguments: &[&str]) -> Value {
    let flags = [&["diagnose", "--json"], arguments].concat();
    serde_json::from_str(&bench.output(&flags)).unwrap()
}

#[test]
fn a_simulated_flight_against_its_own_config_has_no_gap() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--seed", "4", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--patch-out", "mend.toml"]);
    assert_eq!((&found["verdict"], &found["config_patch"]), (&Value::from("no_gap"), &Value::from("")), "{found}");
    assert_eq!(bench.read("mend.toml"), "");
    assert!(bench.output(&["diagnose", "f.mcap"]).starts_with("No gap"));
}

#[test]
fn a_dead_zone_is_named_and_its_patch_closes_the_gap_in_replay() {
    let bench = Bench::default();
    bench.write("stuck.toml", STUCK);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--duration", "70", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--patch-out", "mended.toml"]);
    assert_eq!(found["verdict"], "effect", "{found}");
    let effect = &found["effects"][0];
    assert_eq!((&effect["name"], &effect["change"]), (&Value::from("dead_zone"), &Value::from("added")));
    let zone = &effect["parameters"];
    let of = |key: &str, end: &str| zone[key][end].as_f64().unwrap();
    // Moving both edges is moving hover: only the width is certain.
    let width = of("upper_percent", "value") - of("lower_percent", "value");
    assert!((0.45..0.75).contains(&width), "{zone}");
    assert!(of("upper_percent", "low") < 0.3 && of("upper_percent", "high") > 0.25, "{zone}");
    assert!(found["gap"]["closed"]["value"].as_f64().unwrap() > 0.8, "{found}");
    assert_eq!(found["where"]["stage"][0]["name"], "actuator");

    let error = |flags: &[&str]| {
        let gap: Value =
            serde_json::from_str(&bench.output(&[&["replay", "f.mcap", "--json"], flags].concat())).unwrap();
        gap["error_mm"][2].as_f64().unwrap()
    };
    assert!(error(&["--patch", "mended.toml"]) < 0.7 * error(&[]));
    let _ = bench.output(&["simulate", "--patch", "mended.toml", "--duration", "5", "--log", "mended.mcap"]);
}

#[test]
fn a_record_that_cannot_answer_says_so_and_names_nothing() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let found = diagnose(&bench, &["still.csv"]);
    assert_eq!(found["verdict"], "insufficient_data");
    assert_eq!(found["effects"], serde_json::json!([]));
    assert!(found["check"]["findings"].as_array().unwrap().len() >= 2, "{found}");
}

#[test]
fn the_closed_loop_is_told_before_and_after_the_mend() {
    let bench = Bench::default();
    bench.write("late.toml", "[plant.effects.transport_delay]\ndelay_s = 0.12\n");
    let _ = bench.output(&["simulate", "--patch", "late.toml", "--duration", "70", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--next-out", "next.toml"]);
    let looped = &found["gap"]["closed_loop"];
    assert_eq!(looped["steps"], 9, "{looped}");
    let overshoot = |who: &str| looped["overshoot_percent"][who].as_f64().unwrap();
    assert!((overshoot("mended") - overshoot("recorded")).abs() < 5.0, "{looped}");
    assert!(overshoot("nominal") < overshoot("recorded") - 2.0, "{looped}");
    let critical = |who: &str| looped["critical_gain_ratio"][who].as_f64().unwrap();
    assert!(critical("mended") < 0.5 * critical("nominal"), "{looped}");
    // A delay of the duty and one of the reading are twins: no flight parts them, and no file pretends to.
    let findings = found["check"]["findings"].as_array().unwrap();
    assert!(findings.iter().any(|finding| finding.as_str().unwrap().contains("fan_rpm")), "{findings:?}");
    assert!(found["next_experiment"].is_null() && !bench.path("next.toml").exists());
}

#[test]
fn the_next_experiment_of_a_record_that_cannot_answer_is_a_file_that_flies() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let found = diagnose(&bench, &["still.csv", "--next-out", "next.toml"]);
    let next = &found["next_experiment"];
    assert_eq!(next["file"], bench.read("next.toml"), "{found}");
    assert!(next["expected_nats"].as_f64().unwrap() > 2.0 && next["separates"].as_array().unwrap().len() > 1, "{next}");
    let _ = bench.output(&["simulate", "--experiment", "next.toml", "--log", "next.mcap"]);
    assert!(bench.output(&["diagnose", "still.csv"]).contains("next: fly \""));
}
