//! The gap between a log and a model: on flights of our own, and on a record of another rig.

use serde_json::Value;
use system_tests::{Bench, python, root};

fn replay(bench: &Bench, arguments: &[&str]) -> Value {
    let flags = [&["replay", "--json"], arguments].concat();
    serde_json::from_str(&bench.output(&flags)).unwrap()
}

fn at(gap: &Value, key: &str, horizon: usize) -> f64 {
    gap[key][horizon].as_f64().unwrap()
}

const DEAD_ZONE: &str = "[plant.effects.dead_zone]\nlower_percent = -0.3\nupper_percent = 0.3\n";

#[test]
fn a_record_with_a_reversed_input_is_said_to_be_one_instead_of_a_model_that_lacks_an_effect() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "60", "--log", "f.mcap"]);
    let text = bench.output(&["log", "export", "f.mcap"]);
    let column = text.lines().next().unwrap().split(',').position(|name| name == "duty_percent").unwrap();
    let turned = text.lines().enumerate().map(|(k, line)| {
        let mut cells: Vec<String> = line.split(',').map(Into::into).collect();
        if let Some(duty) = cells.get(column).and_then(|cell| cell.parse::<f64>().ok()).filter(|_| k > 0) {
            cells[column] = (-duty).to_string();
        }
        cells.join(",") + "\n"
    });
    bench.write("turned.csv", turned.collect::<String>());
    for command in [&["replay", "turned.csv"][..], &["identify", "grey-box", "turned.csv"]] {
        let said = bench.run(command);
        assert!(said.errors.contains("scale = -1"), "{command:?}: {}", said.errors);
        assert!(!said.output.contains("lacks an effect"), "{}", said.output);
    }
    let said = bench.output(&["replay", "f.mcap"]);
    assert!(!said.contains("units, signs or columns"), "{said}");
}

#[test]
fn a_flight_by_its_own_model_shows_no_gap_at_any_horizon() {
    // Ten flights: one flight's 1 s errors are only about sixty independent values.
    let (mut error, mut floor) = ([0.0; 3], [0.0; 3]);
    for seed in 0..10 {
        let bench = Bench::default();
        let _ = bench.output(&["simulate", "--seed", &seed.to_string(), "--duration", "80", "--log", "f.mcap"]);
        let gap = replay(&bench, &["f.mcap"]);
        for h in 0..3 {
            error[h] += at(&gap, "error_mm", h).powi(2);
            floor[h] += at(&gap, "floor_mm", h).powi(2);
        }
    }
    for h in 0..3 {
        let ratio = f64::sqrt(error[h] / floor[h]);
        assert!((ratio - 1.0).abs() < 0.08, "E/F = {ratio} at horizon {h}");
    }
}

#[test]
fn an_effect_that_the_model_lacks_opens_the_gap_and_its_patch_closes_it() {
    let bench = Bench::default();
    bench.write("stuck.toml", DEAD_ZONE);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--duration", "80", "--log", "f.mcap"]);
    let (without, with) = (replay(&bench, &["f.mcap"]), replay(&bench, &["f.mcap", "--patch", "stuck.toml"]));
    let ratio = |gap: &Value| at(gap, "error_mm", 2) / at(gap, "floor_mm", 2);
    assert!(ratio(&without) > 1.4, "{without}");
    assert!(ratio(&with) < 1.15, "{with}");
    assert!(at(&without, "error_mm", 2) < at(&without, "stay_put_mm", 2));
}

#[test]
fn csv_and_mcap_of_one_flight_give_the_same_gap() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "40", "--log", "f.mcap"]);
    bench.write("f.csv", bench.output(&["log", "export", "f.mcap"]));
    assert_eq!(replay(&bench, &["f.mcap"]), replay(&bench, &["f.csv"]));
}

#[test]
fn the_json_has_the_keys_of_its_schema_and_no_others() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "40", "--log", "f.mcap"]);
    let gap = replay(&bench, &["f.mcap"]);
    assert_eq!(gap["schema"], "airball.replay/1");
    assert_eq!(gap["horizons_s"], serde_json::json!([0.1, 0.5, 1.0]));
    let mut keys: Vec<&String> = gap.as_object().unwrap().keys().collect();
    keys.sort();
    let mut known =
        ["error_mm", "floor_free_run_10s_mm", "floor_mm", "free_run_10s_mm", "horizons_s", "schema", "stay_put_mm"];
    known.sort_unstable();
    assert_eq!(keys, known);
}

#[test]
fn the_table_on_a_real_record_is_what_an_independent_program_computes() {
    let bench = Bench::default();
    let drone = root().join("data/quarter_drone");
    let (record, belief) = (drone.join("swept_sine.csv"), drone.join("linear.toml"));
    let (record, belief) = (record.to_str().unwrap(), belief.to_str().unwrap());
    let gap = replay(&bench, &[record, "--config", belief]);

    // An independent computation: exact discretisation and a scalar-by-scalar Kalman filter in Python, against RK4 and
    // matrices in Rust.
    let ran = python(&["replay_linear.py", record]);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    let independent: Value = serde_json::from_str(&ran.output).unwrap();
    for key in ["error_mm", "stay_put_mm", "floor_mm"] {
        for h in 0..3 {
            let (ours, theirs) = (at(&gap, key, h), at(&independent, key, h));
            assert!((ours / theirs - 1.0).abs() < 1e-5, "{key} at horizon {h}: {ours} here, {theirs} there");
        }
    }
    // Expected result: at short horizons it is better than "the ball stays put", and at one second gravity and friction
    // are visible.
    assert!(at(&gap, "error_mm", 0) < at(&gap, "stay_put_mm", 0));
    assert!(at(&gap, "error_mm", 2) > 5.0 * at(&gap, "floor_mm", 2));

    let table = bench.output(&["replay", record, "--config", belief, "--plot", "drone.svg"]);
    assert!(table.contains("10001 readings") && table.contains("The model lacks an effect"), "{table}");
    assert!(bench.read("drone.svg").contains("recorded"));
}
