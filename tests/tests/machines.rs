//! The practice rigs that are no ball in a pipe: `tests/machines.py` by closed forms, and its files by `airball`.

use system_tests::{Bench, python};

#[test]
fn its_motion_actuator_and_sensor_are_those_of_closed_forms() {
    let ran = python(&["test_machines.py"]);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    assert!(ran.errors.contains("OK"), "{}", ran.errors);
}

#[test]
fn a_seed_gives_the_same_rigs_again_and_their_records_and_beliefs_are_read() {
    let bench = Bench::default();
    let draw = |folder: &str| {
        let [out, truth] = [folder.to_owned(), format!("{folder}.json")].map(|name| bench.path(&name));
        let ran = python(&[
            "machines.py",
            out.to_str().unwrap(),
            truth.to_str().unwrap(),
            "--seed",
            "a test",
            "--count",
            "2",
        ]);
        assert_eq!(ran.code, Some(0), "{}", ran.errors);
    };
    draw("once");
    draw("again");
    for end in [".json", "/case-000.csv", "/case-000.toml", "/case-001.csv"] {
        assert!(bench.read(&format!("once{end}")) == bench.read(&format!("again{end}")), "{end}");
    }
    let gap = bench.output(&["replay", "once/case-001.csv", "--config", "once/case-001.toml", "--json"]);
    let gap: serde_json::Value = serde_json::from_str(&gap).unwrap();
    assert!(gap["error_mm"][2].as_f64().unwrap() > 2.0 * gap["floor_mm"][2].as_f64().unwrap(), "{gap}");
}
