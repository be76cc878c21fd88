//! Designs: from a config to gains that can be flown.

use serde_json::Value;
use system_tests::{Bench, root};

fn design(bench: &Bench, arguments: &[&str]) -> Value {
    let flags = [&["design"], arguments, &["--json"]].concat();
    serde_json::from_str(&bench.output(&flags)).unwrap()
}

#[test]
fn the_original_rigs_own_gap_is_reproduced_and_closed_by_the_fans_pole() {
    let bench = Bench::default();
    let table = design(&bench, &["critical-gain", "--patch-out", "fan.toml"]);
    let row = |name: &str| {
        table["rows"].as_array().unwrap().iter().find(|row| row["model"] == name).unwrap_or_else(|| panic!("{table}"))
    };
    assert!(row("G_a")["critical_kp_per_mm"].is_null() && row("G_b")["critical_kp_per_mm"].is_null());
    assert!((row("G_c")["critical_kp_per_mm"].as_f64().unwrap() - 0.035443).abs() < 5e-7);
    for name in ["G_a", "G_b", "G_c"] {
        let chosen = row(&format!("{name}, third pole chosen"));
        assert!((chosen["critical_kp_per_mm"].as_f64().unwrap() - 0.038).abs() < 1e-9, "{chosen}");
    }
    // Measured, and not used: 0.69 s. The model that had the fan's pole from the start predicts it.
    let foretold = row("G_c, third pole chosen")["critical_ti_s"].as_f64().unwrap();
    assert!((foretold / 0.69 - 1.0).abs() < 0.1, "{foretold} s");
    assert!(bench.read("fan.toml").contains("[plant.effects.fan_lag]"));
    assert!(bench.output(&["config", "check", "--patch", "fan.toml"]).contains("fan_lag"));
}

/// The plant of an identification, which differs from the config's belief.
const IDENTIFIED: &str = "[plant]\ngain_mm_per_s2_per_percent = 423.4\ndrag_per_s = 1.595\n[plant.effects.fan_lag]\ntime_constant_s = 0.111\n";

/// Designs with `arguments`, flies the resulting patch after `patches` on the square wave of the config, and compares.
fn assert_flies_as_designed(bench: &Bench, arguments: &[&str], patches: &[&str], controller: &str) {
    let before: Vec<&str> = patches.iter().flat_map(|patch| ["--patch", patch]).collect();
    let found = design(bench, &[arguments, &before, &["--patch-out", "designed.toml"]].concat());
    assert_eq!(found["schema"], "airball.design/1");
    let flags = [&before[..], &["--patch", "designed.toml"]].concat();
    let in_force = bench.output(&[&["config", "print"], &flags[..]].concat());
    assert!(in_force.contains(&format!("active = \"{controller}\"")), "{in_force}");
    let said = bench.output(&[&["simulate", "--duration", "80", "--log", "f.mcap", "--json"], &flags[..]].concat());
    std::fs::remove_file(bench.path("f.mcap")).unwrap();
    let flown: Value = serde_json::from_str(&said).unwrap();
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{arguments:?}: {value}, {said}"));
    assert!(number(&flown["steps"]) >= 8.0 && flown["unsettled"] == 0, "{arguments:?}: {said}");
    // The sensor's noise of 2.5 mm, the disturbance by the air, and the last part of the approach within the band of 10
    // mm.
    assert!(number(&flown["rms_settled_mm"]) < 8.0, "{arguments:?}: {said}");
    let step = &found["sampled"]["step"];
    let (designed, seen) = (number(&step["overshoot_percent"]), number(&flown["overshoot_percent"]));
    // Noise increases the overshoot of a flight a little.
    assert!((designed - seen).abs() < 5.0, "{arguments:?}: designed {designed} %, flown {seen} %");
    let (designed, seen) = (number(&step["settling_s"]), number(&flown["settling_s"]));
    assert!((designed - seen).abs() < 1.0, "{arguments:?}: designed {designed} s, flown {seen} s");
}

#[test]
fn every_design_writes_a_patch_that_flies_as_its_figures_say() {
    let bench = Bench::default();
    for (arguments, controller) in [
        (&["pid"][..], "pid"),
        (&["poles", "--pole=-2.5+1i", "--pole=-2.5-1i"], "state_feedback"),
        (&["lqr", "--sampled"], "state_feedback"),
        (&["lqr", "--with-fan"], "lqg"),
        (&["poles", "--pole=-2+1.5i", "--pole=-2-1.5i", "--pole=-5"], "lqg"),
    ] {
        assert_flies_as_designed(&bench, arguments, &[], controller);
    }
}

#[test]
fn a_design_for_an_identified_plant_flies_that_plant() {
    let bench = Bench::default();
    bench.write("identified.toml", IDENTIFIED);
    for (arguments, controller) in
        [(&["pid"][..], "pid"), (&["lqr", "--with-fan"], "lqg"), (&["lqr"], "state_feedback")]
    {
        assert_flies_as_designed(&bench, arguments, &["identified.toml"], controller);
    }
    // The patch of an LQG includes the observer of the identified plant, and so does that of the observer alone.
    let found = design(&bench, &["observer", "--patch", "identified.toml", "--patch-out", "observer.toml"]);
    assert_eq!(found["observer"]["believed"]["gain_mm_per_s2_per_control"], 423.4);
    let in_force = bench.output(&["config", "print", "--patch", "observer.toml"]);
    assert!(
        in_force.contains("gain_mm_per_s2_per_control = 423.4") && in_force.contains("active = \"pid\""),
        "{in_force}"
    );
}

#[test]
fn the_default_pid_of_the_default_rig_has_margins_and_hardly_overshoots() {
    let bench = Bench::default();
    let found = design(&bench, &["pid", "--plot", "pid.svg"]);
    for form in ["continuous", "sampled"] {
        let loop_ = &found[form];
        let of = |path: &str| loop_.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {loop_}"));
        assert!(of("/phase_margins/0/phase_deg") > 50.0 && of("/gain_margins/0/factor") > 3.0, "{loop_}");
        assert!(of("/step/overshoot_percent") < 10.0 && of("/step/settling_s") < 3.0, "{loop_}");
    }
    assert!(bench.read("pid.svg").starts_with("<svg"));
    assert!(bench.output(&["design", "pid"]).contains("weights   setpoint 0."));
}

#[test]
fn the_integral_of_the_configs_state_feedback_is_kept_and_said() {
    let bench = Bench::default();
    let poles = ["design", "poles", "--pole=-2.5+1i", "--pole=-2.5-1i"];
    assert!(bench.output(&poles).contains("the config's integral is kept: added, T_i = 30 s"));
    bench.write("in-place.toml", "[controller.state_feedback]\nintegral.in_place = { ti_s = 2.0 }\n");
    let kept = bench.output(&[&poles[..], &["--patch", "in-place.toml"]].concat());
    // The variant of the patch takes the place of the config's.
    assert!(kept.contains("the config's integral is kept: in place of K_r·r, T_i = 2 s"), "{kept}");
}

#[test]
fn behind_a_predistortion_gains_are_for_its_control_value() {
    let bench = Bench::default();
    bench.write(
        "curve.toml",
        "[compensation.predistortion]\npoints = [[19.4, -20.0], [20.4, -10.0], [21.4, 0.0], \
         [22.4, 10.0], [23.4, 20.0]]\n",
    );
    let [plain, curved] = [&["pid"][..], &["pid", "--patch", "curve.toml"]].map(|arguments| design(&bench, arguments));
    let kp = |found: &Value| found["pid"]["kp_per_mm"].as_f64().unwrap();
    // A percent is 10 mm/s² of the control value, so that the gains are ten times as large.
    assert!((kp(&curved) / kp(&plain) - 10.0).abs() < 1e-6, "{} and {}", kp(&plain), kp(&curved));
}

#[test]
fn poles_that_the_fan_forbids_are_refused_with_the_next_thing_to_try() {
    let ran = Bench::default().run(&["design", "pid", "--omega", "9"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.errors.contains("ask for a slower or less damped pair"), "{}", ran.errors);
}

#[test]
fn a_relay_flown_within_limits_tunes_a_pid_that_flies() {
    let bench = Bench::default();
    for directory in ["docs", "experiments"] {
        std::os::unix::fs::symlink(root().join(directory).canonicalize().unwrap(), bench.path(directory)).unwrap();
    }
    let relay = ["--patch", "docs/relay-patch.toml", "--experiment", "experiments/relay.toml"];
    let _ = bench.output(&[&["simulate", "--log", "r.mcap"], &relay[..]].concat());
    let found = design(&bench, &["relay", "r.mcap", "--patch-out", "tuned.toml"]);
    // Tyreus and Luyben take K_u/2.2; the rig's proportional loop is critical at 0.0332 when sampled.
    let ultimate = 2.2 * found["pid"]["kp_per_mm"].as_f64().unwrap();
    assert!((ultimate / 0.0332 - 1.0).abs() < 0.15, "K_u = {ultimate}");
    assert!(found["sampled"]["stable"].as_bool().unwrap());
    let _ = bench.output(&["simulate", "--patch", "tuned.toml", "--duration", "40", "--log", "t.mcap"]);
}

#[test]
fn a_design_about_a_duty_has_the_gain_and_drag_of_the_air_there() {
    let bench = Bench::default();
    bench.write("air.toml", "[plant]\ngain_mm_per_s2_per_percent = 200.0\ndrag_per_s = 2.0\nhover_duty_percent = 20.0\n[plant.effects.relative_airflow]\ninverse_speed_s_per_mm = 1e-3\n");
    let of = |more: &[&str]| design(&bench, &[&["pid", "--patch", "air.toml"], more].concat());
    let drag = |found: &Value| found["plant"]["drag_per_s"].as_f64().unwrap();
    let (plain, there) = (of(&[]), of(&["--about-duty", "30"]));
    // a·√(1 + 2·q·A/a) with A = 200·10.
    let exact = 2.0 * 3.0_f64.sqrt();
    assert!(drag(&plain) == 2.0 && (drag(&there) / exact - 1.0).abs() < 1e-5, "{}", drag(&there));
    assert!(plain["about"].is_null() && there["about"]["duty_percent"] == 30.0, "{}", there["about"]);
    // More drag needs less derivative for the same poles.
    let td = |found: &Value| found["pid"]["td_s"].as_f64().unwrap();
    assert!(td(&there) < td(&plain), "{} and {}", td(&there), td(&plain));
    let observed = design(&bench, &["observer", "--patch", "air.toml", "--about-duty", "30"]);
    assert!((observed["observer"]["believed"]["drag_per_s"].as_f64().unwrap() / exact - 1.0).abs() < 1e-5);
    assert!(bench.output(&["design", "pid", "--patch", "air.toml", "--about-duty", "30"]).contains("drag 3.46 1/s"));
    for (flags, said) in
        [(["--about-duty", "130"], "give 0 to 100 %"), (["--about-height", "nan"], "give a height within the pipe")]
    {
        let ran = bench.run(&[&["design", "pid", "--patch", "air.toml"], &flags[..]].concat());
        assert!(ran.code == Some(1) && ran.errors.contains(said), "{}", ran.errors);
    }
}

#[test]
fn an_observer_of_a_given_w_and_v_is_that_of_the_riccati_equation() {
    let bench = Bench::default();
    let two = "remove = [\"plant.effects.fan_lag\", \"observer.believed.fan_lag_s\"]\n[plant]\ndrag_per_s = 0.78\n";
    bench.write("two.toml", two);
    let found = design(&bench, &["observer", "--patch", "two.toml", "--w", "3,3", "--v", "5"]);
    let gain = |k: usize| found["continuous"][k].as_f64().unwrap();
    // The thesis' model, W and V: not its L, which belongs to W = 0.1·V·I.
    let (first, second) = (gain(0), gain(1));
    // L of A = [0 1; 0 -a] by hand: 2·l₂ = l₁² − W₁/V, and l₁·l₂ = P₂₂/V − a·l₂ with 2·a·P₂₂/V = W₂/V − l₂².
    assert!((2.0 * second - first * first + 0.6).abs() < 1e-9, "{found}");
    assert!((first * second - (0.6 - second * second) / (2.0 * 0.78) + 0.78 * second).abs() < 1e-9, "{found}");
    assert_eq!(found["flown"], serde_json::json!([]));
    let refused = bench.run(&["design", "observer", "--patch", "two.toml", "--w", "3,3,3", "--v", "5"]);
    assert!(refused.code == Some(2) && refused.errors.contains("2 states"), "{refused:?}");
    let flies = ["observer", "--patch", "two.toml", "--w", "0,500", "--v", "0.1", "--patch-out", "o.toml"];
    assert!(design(&bench, &flies)["flown"].as_array().is_some_and(|gains| gains.len() == 4));
    let patch = bench.read("o.toml");
    assert!(patch.contains("acceleration_psd_mm2_per_s3 = 500") && patch.contains("sensor_mm = 2.236"), "{patch}");
}
