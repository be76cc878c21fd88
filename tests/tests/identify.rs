//! `airball identify`: from logs to a plant, and from the plant to designs and flights.

use serde_json::Value;
use system_tests::{Bench, root};

/// A bench with the project's experiments and records.
fn bench() -> Bench {
    let bench = Bench::default();
    for directory in ["docs", "experiments", "data"] {
        std::os::unix::fs::symlink(root().join(directory).canonicalize().unwrap(), bench.path(directory)).unwrap();
    }
    bench
}

fn identify(bench: &Bench, arguments: &[&str]) -> Value {
    let flags = [&["identify"], arguments, &["--json"]].concat();
    serde_json::from_str(&bench.output(&flags)).unwrap()
}

/// Whether the 90 % interval of a parameter contains `truth`; it must have both ends.
fn holds(estimates: &Value, name: &str, truth: f64) -> bool {
    let own = estimates
        .as_array()
        .unwrap()
        .iter()
        .find(|e| e["name"] == name)
        .unwrap_or_else(|| panic!("{name}: {estimates}"));
    (own["low"].as_f64().unwrap()..=own["high"].as_f64().unwrap()).contains(&truth)
}

/// The parameters of the config, by name.
const TRUTH: [(&str, f64); 4] = [
    ("gain_mm_per_s2_per_percent", 827.2),
    ("drag_per_s", 3.896),
    ("hover_duty_percent", 21.4),
    ("fan_lag.time_constant_s", 0.257),
];

/// The identification from a flight of its experiment, with the belief of another rig as initial values.
fn identified(bench: &Bench, seed: &str) -> Value {
    let _ =
        bench.output(&["simulate", "--experiment", "experiments/identify.toml", "--log", "id.mcap", "--seed", seed]);
    bench.write(
        "guess.toml",
        "[plant]\ngain_mm_per_s2_per_percent = 500.0\ndrag_per_s = 2.0\nhover_duty_percent = 21.6\n",
    );
    let flags = ["grey-box", "id.mcap", "--patch", "guess.toml", "--patch-out", "plant.toml", "--plot", "id.svg"];
    let found = identify(bench, &flags);
    let says = (found["schema"].as_str(), found["chosen"].as_str());
    assert_eq!(says, (Some("airball.identify/1"), Some("three")), "{found}");
    found
}

#[test]
fn flights_give_back_the_plant_of_the_config_within_its_intervals() {
    let found: Vec<Value> = (1..=8).map(|seed: u32| identified(&bench(), &seed.to_string())).collect();
    for (name, truth) in TRUTH {
        let held = found.iter().filter(|found| holds(&found["models"][1]["estimates"], name, truth)).count();
        // Of eight intervals with a coverage of 90 %, fewer than five contain the truth with a probability of 0.5 %.
        assert!(held >= 5, "{name}: {held} of 8");
    }
}

#[test]
fn an_identified_plant_is_linearised_about_the_duty_that_is_asked_for() {
    let bench = bench();
    bench.write(
        "air.toml",
        "[plant]\ndrag_per_s = 2.0\n[plant.effects.relative_airflow]\ninverse_speed_s_per_mm = 1e-4\n",
    );
    let flown = ["simulate", "--patch", "air.toml", "--experiment", "experiments/identify.toml", "--log", "id.mcap"];
    let _ = bench.output(&flown);
    let arguments = ["grey-box", "id.mcap", "--patch", "air.toml", "--poles", "3"];
    let found = identify(&bench, &[&arguments[..], &["--about-duty", "25", "--html", "id.html"]].concat());
    let of = |name: &str| {
        let all = found["models"][0]["estimates"].as_array().unwrap();
        all.iter().find(|one| one["name"] == name).and_then(|one| one["value"].as_f64()).unwrap()
    };
    let (gain, drag) = (of("gain_mm_per_s2_per_percent"), of("drag_per_s"));
    // a·√(1 + 2·q·A/a) with the identified gain and drag, q believed.
    let exact = drag * (1.0 + 2e-4 * gain * (25.0 - of("hover_duty_percent")) / drag).sqrt();
    let there = found["about"]["drag_per_s"].as_f64().unwrap();
    assert!((there / exact - 1.0).abs() < 1e-3 && there > drag, "{there}, not {exact}");
    let page = std::fs::read_to_string(bench.path("id.html")).unwrap();
    assert!(page.contains("Linearised at 25.0 % and"), "the page does not say it");
    assert!(identify(&bench, &arguments)["about"].is_null());
    let refused = bench.run(&[&["identify"], &arguments[..], &["--about-duty", "130"]].concat());
    assert!(refused.code == Some(1) && refused.errors.contains("give 0 to 100 %"), "{}", refused.errors);
}

#[test]
fn a_plant_that_was_identified_is_designed_for_and_flown() {
    let bench = bench();
    let found = identified(&bench, "4");
    let [two, three] = [0, 1].map(|at| &found["models"][at]);
    assert!(two["residuals"]["input"]["p_value"].as_f64().unwrap() < 1e-3, "{two}");
    assert!(bench.read("id.svg").starts_with("<svg"));
    // The identified plant can be used like any other model.
    let design: Value = serde_json::from_str(&bench.output(&[
        "design",
        "lqr",
        "--patch",
        "plant.toml",
        "--patch-out",
        "lqr.toml",
        "--json",
    ]))
    .unwrap();
    let value = |name: &str| {
        three["estimates"].as_array().unwrap().iter().find(|e| e["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    // A patch has six significant digits.
    let (designed, identified) = (design["plant"]["fan_lag_s"].as_f64().unwrap(), value("fan_lag.time_constant_s"));
    assert!((designed / identified - 1.0).abs() < 1e-5, "{designed} and {identified}");
    let _ = bench.output(&[
        "simulate",
        "--patch",
        "plant.toml",
        "--patch",
        "lqr.toml",
        "--duration",
        "30",
        "--log",
        "f.mcap",
    ]);
}

#[test]
fn a_sweep_of_gains_gives_back_the_plant_of_a_rig_without_lag_and_the_critical_gain_its_third_pole() {
    let bench = bench();
    bench.write("ball.toml", "[plant]\ngain_mm_per_s2_per_percent = 254.598\ndrag_per_s = 1.889\n[plant.effects.fan_lag]\ntime_constant_s = 0.0\n");
    let mut logs = Vec::new();
    for (gain, log) in [("0.009", "1.mcap"), ("0.011", "2.mcap"), ("0.013", "3.mcap"), ("0.015", "4.mcap")] {
        bench.write("kp.toml", format!("[controller.pid]\nkp_per_mm = {gain}\n"));
        let patches = ["--patch", "ball.toml", "--patch", "docs/gain-patch.toml", "--patch", "kp.toml"];
        let flight = ["simulate", "--experiment", "experiments/gain-pulses.toml", "--log", log];
        let _ = bench.output(&[&flight[..], &patches[..]].concat());
        logs.push(log);
    }
    let flags = ["--patch-out", "sweep.toml", "--plot", "sweep.svg"];
    let found = identify(&bench, &[&["transient"], &logs[..], &flags[..]].concat());
    let read: Vec<f64> =
        found["gains"].as_array().unwrap().iter().map(|gain| gain["kp_per_mm"].as_f64().unwrap()).collect();
    assert!(
        read.iter().zip([0.009, 0.011, 0.013, 0.015]).all(|(read, flown)| (read / flown - 1.0).abs() < 1e-3),
        "{read:?}"
    );
    for (name, truth) in [("gain", 254.598), ("drag", 1.889)] {
        let value = found[name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.08, "{name}: {}", found[name]);
    }
    assert!(bench.read("sweep.svg").starts_with("<svg"));
    // The same plant with the third pole, for which the closed form gives the exact value.
    let third = ["third-pole", "--critical-gain", "0.038", "--patch-out", "fan.toml"];
    let exact = identify(&bench, &[&third[..], &["--patch", "ball.toml"]].concat());
    assert!((exact["fan_pole_per_s"].as_f64().unwrap() - 3.526).abs() < 5e-4, "{exact}");
    let _ = identify(&bench, &[&third[..], &["--patch", "sweep.toml"]].concat());
    let design: Value = serde_json::from_str(&bench.output(&[
        "design",
        "loop",
        "--patch",
        "sweep.toml",
        "--patch",
        "fan.toml",
        "--json",
    ]))
    .unwrap();
    assert!(design["plant"]["fan_lag_s"].as_f64().unwrap() > 0.1, "{design}");
}

#[test]
fn the_sampled_third_pole_brings_the_designed_loop_to_the_edge_at_the_measured_gain() {
    let bench = bench();
    let flags = ["third-pole", "--critical-gain", "0.03", "--sampled", "--patch-out", "fan.toml"];
    assert_eq!(identify(&bench, &flags)["period_s"].as_f64(), Some(0.02));
    bench.write("pi.toml", "[controller.pid]\nkp_per_mm = 0.01\nti_s = 15.0\ntd_s = 0.0\n");
    let design: Value =
        serde_json::from_str(&bench.output(&["design", "loop", "--patch", "fan.toml", "--patch", "pi.toml", "--json"]))
            .unwrap();
    let critical = design["sampled"]["critical_kp_per_mm"].as_f64().unwrap();
    assert!((critical / 0.03 - 1.0).abs() < 1e-3, "{critical}");
}

#[test]
fn a_record_of_another_rig_is_identified_and_its_residuals_say_what_a_linear_plant_leaves_out() {
    let bench = bench();
    let flags =
        ["grey-box", "data/quarter_drone/swept_sine.csv", "--config", "data/quarter_drone/linear.toml", "--poles", "2"];
    let found = identify(&bench, &flags);
    let of = &found["models"][0];
    // The makers' own model has 15.8 degrees/s² per percent about the mean angle. A linear plant has no gravity and no
    // friction, and its gain is too low, but of the right sign and order.
    let gain = of["estimates"][0]["value"].as_f64().unwrap();
    assert!((4.0..40.0).contains(&gain), "{gain}");
    assert!(of["residuals"]["input"]["p_value"].as_f64().unwrap() < 1e-3, "{of}");
}

#[test]
fn the_experiment_without_control_is_enough_for_the_poles_without_control() {
    let bench = bench();
    let _ = bench.output(&["simulate", "--seed", "3", "--log", "o.mcap", "--experiment", "experiments/open-loop.toml"]);
    let found = identify(&bench, &["grey-box", "o.mcap", "--open-loop", "--poles", "3"]);
    for estimate in found["models"][0]["estimates"].as_array().unwrap() {
        let [low, high] = ["low", "high"].map(|end| estimate[end].as_f64().unwrap());
        let truth = match estimate["name"].as_str().unwrap() {
            "gain_mm_per_s2_per_percent" => 827.2,
            "drag_per_s" => 3.896,
            _ => 0.257,
        };
        // 90 % intervals of one flight: twice as wide holds the truth.
        let (middle, half) = ((low + high) / 2.0, high - low);
        assert!((truth - middle).abs() < half, "{estimate}");
    }
}

#[test]
fn records_that_cannot_answer_are_refused_with_the_next_thing_to_fly() {
    let bench = bench();
    let _ = bench.output(&["simulate", "--duration", "40", "--log", "f.mcap"]);
    let ran = bench.run(&["identify", "transient", "f.mcap"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("experiments/gain-pulses.toml"), "{}", ran.errors);
    let ran = bench.run(&["identify", "grey-box", "f.mcap", "--open-loop"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("150 are needed") && ran.errors.contains("open-loop.toml"), "{}", ran.errors);
    let ran = bench.run(&["identify", "third-pole", "--critical-gain", "5", "--sampled"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("no third pole"), "{}", ran.errors);
}

#[test]
fn a_plant_is_identified_per_control_value_with_and_without_a_predistortion() {
    let bench = bench();
    let curve: Vec<String> =
        (10..=40).map(|duty| format!("[{duty}.0, {:.2}]", 827.2 * (f64::from(duty) - 21.4))).collect();
    let alone = "remove = [\"observer\", \"controller.cascade\", \"controller.lqg\", \"controller.mpc\", \
                 \"controller.state_feedback\"]\n";
    let predistorted = format!(
        "{alone}[controller.pid]\nkp_per_mm = 14.89\n[compensation.predistortion]\npoints = [{}]\n",
        curve.join(", ")
    );
    bench.write("percent.toml", alone);
    bench.write("acceleration.toml", predistorted);
    for (patch, gain) in [("percent.toml", 827.2), ("acceleration.toml", 1.0)] {
        let flags = ["--experiment", "experiments/identify.toml", "--log", "f.mcap", "--patch", patch];
        let _ = bench.output(&[&["simulate"], &flags[..]].concat());
        let log = ["grey-box", "f.mcap", "--poles", "3", "--per-control", "--patch", patch, "--patch-out", "p.toml"];
        let found = identify(&bench, &log);
        std::fs::remove_file(bench.path("f.mcap")).unwrap();
        let estimates = &found["models"][0]["estimates"];
        let value = |name: &str| {
            let own = estimates.as_array().unwrap().iter().find(|one| one["name"] == name);
            own.unwrap_or_else(|| panic!("{name}: {estimates}"))["value"].as_f64().unwrap()
        };
        assert!((value("gain_mm_per_s2_per_control") / gain - 1.0).abs() < 0.25, "{patch}: {estimates}");
        assert!(value("hover_control").abs() < 0.3 * 827.2 / gain, "{patch}: {estimates}");
        assert!((value("fan_lag.time_constant_s") / 0.257 - 1.0).abs() < 0.3, "{patch}: {estimates}");
        assert!(bench.read("p.toml").contains("[observer.believed]\ngain_mm_per_s2_per_control"), "{patch}");
    }
}
