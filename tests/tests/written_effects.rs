//! Effects that a user writes, from the shipped library: flown, found beside the catalogue, and refused where wrong.

use serde_json::Value;
use system_tests::{Bench, root};

fn library() -> String {
    root().join("effects.toml").to_str().unwrap().to_owned()
}

/// Flies the identification experiment with a patch; the log's name.
fn flown(bench: &Bench, patch: &str) -> &'static str {
    bench.write("on.toml", patch);
    let root = root();
    let at = |file: &str| root.join(file).to_str().unwrap().to_owned();
    let (config, experiment, effects) = (at("config.toml"), at("experiments/identify.toml"), library());
    let files = ["--config", &config, "--effects", &effects, "--patch", "on.toml", "--experiment", &experiment];
    let said = bench.output(&[&["simulate", "--log", "log.mcap", "--seed", "3"], &files[..]].concat());
    assert!(said.contains("log.mcap"), "{said}");
    "log.mcap"
}

#[test]
fn each_effect_of_the_library_changes_a_flight() {
    let library: toml::Table = toml::from_str(&std::fs::read_to_string(library()).unwrap()).unwrap();
    let rows = |patch: &str| {
        let bench = Bench::default();
        bench.output(&["log", "export", flown(&bench, patch)])
    };
    let plain = rows("");
    let effects = library["effect"].as_table().unwrap();
    assert!(effects.len() > 5);
    for (name, effect) in effects {
        let values = effect["parameters"].as_table().unwrap().iter().map(|(key, parameter)| {
            let number = |key: &str| parameter.get(key).and_then(toml::Value::as_float);
            format!("{key} = {:?}\n", number("value").unwrap_or_else(|| number("scale").unwrap()))
        });
        let patch = format!("[plant.effects.{name}]\n{}", values.collect::<String>());
        assert_ne!(rows(&patch), plain, "{name}");
    }
}

// A lag of its own behind the fan, with a state: no effect of the catalogue has it.
#[test]
fn a_written_effect_is_named_beside_the_catalogue_and_its_patch_stands_alone() {
    let bench = Bench::default();
    let log = flown(&bench, "[plant.effects.second_lag]\nshare = 0.7\ntau = 0.5\n");
    let root = root();
    let config = root.join("config.toml");
    let config = config.to_str().unwrap();
    let said = bench.output(&[
        "diagnose",
        "--json",
        log,
        "--config",
        config,
        "--effects",
        &library(),
        "--patch-out",
        "p.toml",
    ]);
    let found: Value = serde_json::from_str(&said).unwrap();
    let first = &found["effects"][0];
    assert_eq!((&found["verdict"], &first["name"]), (&"effect".into(), &"second_lag".into()));
    for (name, truth) in [("share", 0.7), ("tau", 0.5)] {
        let interval = &first["parameters"][name];
        let (low, high) = (interval["low"].as_f64().unwrap(), interval["high"].as_f64().unwrap());
        assert!(low < truth && truth < high, "{name}: {low} to {high}, in truth {truth}");
    }
    assert!(found["gap"]["closed"]["value"].as_f64().unwrap() > 0.9, "{}", found["gap"]["closed"]);
    // The patch brings the definition along.
    let error = |patch: &[&str]| {
        let said = bench.output(&[&["replay", "--json", log, "--config", config], patch].concat());
        serde_json::from_str::<Value>(&said).unwrap()["error_mm"][2].as_f64().unwrap()
    };
    assert!(error(&["--patch", "p.toml"]) < error(&[]));
}

#[test]
fn a_library_that_cannot_be_read_and_an_unknown_name_are_said() {
    let bench = Bench::default();
    let root = root();
    let config = root.join("config.toml");
    let config = config.to_str().unwrap();
    bench.write(
        "wrong.toml",
        "[effect.mine]\nstage = \"air\"\nadds = \"k / x\"\nparameters.k = { neutral = 0.0, low = 0.0, high = 1.0 }\n",
    );
    let ran = bench.run(&["config", "check", "--config", config, "--effects", "wrong.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.errors);
    assert!(ran.errors.contains("wrong.toml:3: effect.mine.adds: `k / x`, column 3"), "{}", ran.errors);
    let ran =
        bench.run(&["diagnose", flown(&bench, ""), "--config", config, "--effects", &library(), "--without", "leek"]);
    assert_eq!(ran.code, Some(2), "{}", ran.errors);
    assert!(ran.errors.contains("leek") && ran.errors.contains("second_lag"), "{}", ran.errors);
}

// The controller adds to the duty when the setpoint jumps, and its config does not say so.
#[test]
fn an_effect_of_the_setpoint_flies_is_weighed_where_the_record_has_one_and_is_refused_where_not() {
    let bench = Bench::default();
    bench.write(
        "fed.toml",
        "[effect.fed]\nstage = \"air\"\nadds = \"k * (setpoint - 300)\"\n\
         parameters.k = { neutral = 0.0, scale = 0.2, low = -10.0, high = 10.0 }\n",
    );
    bench.write("on.toml", "[plant.effects.fed]\nk = 1.0\n");
    let root = root();
    let at = |file: &str| root.join(file).to_str().unwrap().to_owned();
    let (config, experiment) = (at("config.toml"), at("experiments/identify.toml"));
    let fly = ["simulate", "--config", &config, "--effects", "fed.toml", "--experiment", &experiment, "--seed", "3"];
    for more in [&["--log", "plain.mcap"][..], &["--patch", "on.toml", "--log", "fed.mcap"]] {
        let said = bench.output(&[&fly[..], more].concat());
        assert!(said.contains(".mcap"), "{said}");
    }
    let ask = ["--config", &config, "--effects", "fed.toml"];
    let replay = |log: &str, patch: &[&str]| {
        let said = bench.output(&[&["replay", "--json", log], &ask[..], patch].concat());
        serde_json::from_str::<Value>(&said).unwrap()["error_mm"][2].as_f64().unwrap()
    };
    assert!(replay("fed.mcap", &["--patch", "on.toml"]) < 0.9 * replay("fed.mcap", &[]));
    assert!(replay("plain.mcap", &["--patch", "on.toml"]) > replay("plain.mcap", &[]));

    // The same rows without their setpoints.
    let rows = bench.output(&["log", "export", "fed.mcap"]);
    let column = rows.lines().next().unwrap().split(',').position(|name| name == "setpoint_mm").unwrap();
    let without = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(index, _)| *index != column).map(|(_, cell)| cell);
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    bench.write("bare.csv", rows.lines().map(without).collect::<String>());
    let ran = bench.run(&[&["diagnose", "bare.csv"], &ask[..]].concat());
    assert_eq!(ran.code, Some(2), "{}", ran.errors);
    let expected =
        "fed.toml:3: effect.fed.adds: `k * (setpoint - 300)`, column 6: `setpoint` is not known: bare.csv has none";
    assert!(ran.errors.contains(expected), "{}", ran.errors);
    let ran = bench.run(&[&["emulate", "--socket", "rig.socket", "--patch", "on.toml"], &ask[..]].concat());
    assert!(ran.code == Some(2) && ran.errors.contains("airball run --sim"), "{}", ran.errors);
}
