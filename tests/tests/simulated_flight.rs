//! Flights in virtual time: bit-exact, controlled, logged, drawn.

use serde_json::Value;
use system_tests::{Bench, root};

/// An experiment that moves the ball out of its own band.
const WILD: &str = "title = \"wild\"\n[limits]\nposition_max_mm = 350.0\n[[segment]]\nduration_s = 20.0\n\
    setpoint_mm.ramp = { from = 200.0, to = 500.0, over_s = 10.0 }\n";

fn summary(bench: &Bench, arguments: &[&str]) -> Value {
    let flags = [&["simulate", "--json"], arguments].concat();
    serde_json::from_str(&bench.output(&flags)).unwrap()
}

#[test]
fn one_seed_gives_the_same_cycles_and_another_seed_others() {
    let bench = Bench::default();
    for (seed, log) in [("5", "a.mcap"), ("5", "b.mcap"), ("6", "c.mcap")] {
        let _ = bench.output(&["simulate", "--seed", seed, "--log", log]);
    }
    let csv = |log| bench.output(&["log", "export", log]);
    assert_eq!(csv("a.mcap"), csv("b.mcap"));
    assert_ne!(csv("a.mcap"), csv("c.mcap"));
    assert_eq!(csv("a.mcap").lines().count(), 3001, "a header and 60 s at 50 Hz");
}

#[test]
fn the_ball_follows_the_square_wave_of_the_config() {
    let bench = Bench::default();
    let flight = summary(&bench, &["--duration", "64", "--log", "f.mcap"]);
    assert_eq!(flight["steps"], 8);
    // The air may rarely push the ball out of a step's ±10 mm for longer than a step lasts.
    assert!(flight["unsettled"].as_u64().unwrap() <= 2, "{flight}");
    assert!(flight["overshoot_percent"].as_f64().unwrap() < 15.0, "{flight}");
    assert!(flight["settling_s"].as_f64().unwrap() < 3.0, "{flight}");
    // After settling, little more than the sensor's noise of 2.5 mm and the disturbance by the air.
    assert!(flight["rms_settled_mm"].as_f64().unwrap() < 12.0, "{flight}");
    assert_eq!(flight["late"], 0);
    // The loop runs just after the sensor: every cycle has a new reading.
    assert_eq!(flight["fresh_percent"], 100.0);
}

#[test]
fn every_controller_of_the_config_flies_the_square_wave() {
    for kind in ["cascade", "state_feedback", "lqg", "mpc"] {
        let bench = Bench::default();
        bench.write("other.toml", format!("[controller]\nactive = \"{kind}\"\n"));
        let flight = summary(&bench, &["--duration", "64", "--patch", "other.toml", "--log", "f.mcap"]);
        assert_eq!(flight["steps"], 8);
        assert!(flight["unsettled"].as_u64().unwrap() <= 2, "{kind}: {flight}");
        assert!(flight["overshoot_percent"].as_f64().unwrap() < 20.0, "{kind}: {flight}");
        assert!(flight["settling_s"].as_f64().unwrap() < 4.0, "{kind}: {flight}");
        assert!(flight["rms_settled_mm"].as_f64().unwrap() < 12.0, "{kind}: {flight}");
        // The observer's model is the simulated plant: a gate of 5 sigma rejects almost nothing.
        assert!(flight["innovations"]["expected_percent"].as_f64().unwrap() > 98.0, "{kind}: {flight}");
    }
}

#[test]
fn a_controller_that_is_not_there_or_lacks_its_observer_is_refused_with_what_to_do() {
    let bench = Bench::default();
    bench.write("bare.toml", "[controller.lqg]\nposition_per_mm = 0.02\nvelocity_s_per_mm = 0.005\n");
    bench.write("other.toml", "[controller]\nactive = \"mpc\"\nopen_loop = { control = 0.0 }\n");
    for (config, said) in [("bare.toml", "lqg needs the table [observer]"), ("other.toml", "no table [controller.mpc]")]
    {
        let ran = bench.run(&["config", "check", "--config", config]);
        assert_eq!(ran.code, Some(2));
        assert!(ran.errors.contains(said), "{}", ran.errors);
    }
}

#[test]
fn the_picture_shows_setpoint_position_and_duty() {
    let bench = Bench::default();
    let said = bench.output(&["simulate", "--duration", "20", "--plot", "out.svg"]);
    assert!(said.contains("picture   out.svg") && said.contains("flights/"), "{said}");
    let svg = bench.read("out.svg");
    for text in ["position, mm", "duty, %", "setpoint", "time, s"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(svg.matches("<polyline").count() >= 3);
}

/// The length of an experiment, seconds, and whether the ball may end one of its segments early.
fn length(experiment: &str) -> (f64, bool) {
    let experiment: toml::Table = experiment.parse().unwrap();
    let segments = experiment["segment"].as_array().unwrap();
    let ends_early = |key: &String| key.starts_with("until_") || key.starts_with("back_off_");
    let of = |segment: &toml::Value| segment["duration_s"].as_float().unwrap();
    (segments.iter().map(of).sum(), segments.iter().any(|segment| segment.as_table().unwrap().keys().any(ends_early)))
}

#[test]
fn every_experiment_of_the_project_flies_to_its_end() {
    let experiments = root().join("experiments");
    for entry in std::fs::read_dir(experiments).unwrap() {
        let file = entry.unwrap().path();
        let bench = Bench::default();
        let flight = summary(&bench, &["--experiment", file.to_str().unwrap(), "--log", "e.mcap"]);
        let (longest, may_end_early) = length(&std::fs::read_to_string(&file).unwrap());
        let flown = flight["duration_s"].as_f64().unwrap();
        let to_its_end = if may_end_early { flown < longest + 0.05 } else { (flown - longest).abs() < 0.05 };
        assert!(to_its_end, "{}: {flown} s of {longest} s", file.display());
        let info = bench.output(&["log", "info", "e.mcap"]);
        assert!(info.contains("end      finished"), "{info}");
    }
}

#[test]
fn an_experiment_that_throws_the_ball_out_of_its_band_ends_with_a_fault() {
    let bench = Bench::default();
    bench.write("wild.toml", WILD);
    let ran = bench.run(&["simulate", "--experiment", "wild.toml", "--log", "w.mcap"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("left the experiment's band") && ran.errors.contains("fan off"), "{}", ran.errors);
    assert!(bench.output(&["log", "info", "w.mcap"]).contains("left the experiment's band"));
}

#[test]
fn a_log_is_never_overwritten() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "2", "--log", "f.mcap"]);
    let before = std::fs::read(bench.path("f.mcap")).unwrap();
    let ran = bench.run(&["simulate", "--duration", "2", "--log", "f.mcap"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("f.mcap exists already"), "{}", ran.errors);
    assert_eq!(std::fs::read(bench.path("f.mcap")).unwrap(), before);
}

#[test]
fn a_pulse_of_open_loop_duty_does_not_spoil_the_control_that_follows() {
    let bench = Bench::default();
    for (duty, seconds) in [("26.0", "0.2"), ("12.0", "0.3")] {
        let hold = "[[segment]]\nduration_s = 10.0\nsetpoint_mm.constant = { value = 300.0 }\n";
        let pulse = format!("[[segment]]\nduration_s = {seconds}\nduty_percent.constant = {{ value = {duty} }}\n");
        bench.write("pulse.toml", format!("title = \"pulse\"\n{hold}{pulse}{hold}"));
        let _ = std::fs::remove_file(bench.path("p.mcap"));
        let _ = bench.output(&["simulate", "--experiment", "pulse.toml", "--log", "p.mcap"]);
        let csv = bench.output(&["log", "export", "p.mcap"]);
        let last_seconds: Vec<f64> =
            csv.lines().rev().take(100).map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
        let mean = last_seconds.iter().sum::<f64>() / 100.0;
        assert!((mean - 300.0).abs() < 20.0, "{duty} % for {seconds} s: {mean} mm after 8 s");
    }
}

#[test]
fn a_picture_never_replaces_anything_but_a_picture() {
    let bench = Bench::default();
    for (plot, log) in [("config.toml", "a.mcap"), ("b.mcap", "b.mcap")] {
        let ran = bench.run(&["simulate", "--duration", "2", "--plot", plot, "--log", log]);
        assert_eq!(ran.code, Some(1));
        assert!(ran.errors.contains(&format!("{plot} exists and is no SVG picture")), "{}", ran.errors);
    }
    assert!(bench.read("config.toml").contains("[plant]"));
    assert!(bench.output(&["log", "info", "b.mcap"]).contains("end      finished"));
    for log in ["c.mcap", "d.mcap"] {
        let _ = bench.output(&["simulate", "--duration", "2", "--plot", "again.svg", "--log", log]);
    }
}

#[test]
fn a_picture_in_no_folder_is_refused_before_the_flight() {
    let bench = Bench::default();
    bench.write("wild.toml", WILD);
    let ran = bench.run(&["simulate", "--experiment", "wild.toml", "--log", "w.mcap", "--plot", "nowhere/p.svg"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("nowhere/p.svg") && ran.output.is_empty(), "{}{}", ran.errors, ran.output);
    assert!(!bench.path("w.mcap").exists());
}
