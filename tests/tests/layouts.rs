//! The layouts for Foxglove and PlotJuggler match a log: it has every channel and field that they name, with a suitable
//! type.

use serde_json::Value;
use std::process::Command;
use system_tests::{Bench, Ran, root};

/// The types of the fields of every channel of a simulated flight, by the Python reader of MCAP.
fn channels() -> Value {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "4", "--log", "f.mcap"]);
    let python = root().join(".venv/bin/python");
    let output = Command::new(&python).arg(root().join("tests/read_mcap.py")).arg(bench.path("f.mcap")).output();
    let ran = Ran::from(output.unwrap_or_else(|error| panic!("{}: {error}; run scripts/test", python.display())));
    let log: Value = serde_json::from_str(&ran.output).unwrap_or_else(|error| panic!("{error}: {}", ran.errors));
    log["channels"].clone()
}

fn read(layout: &str) -> String {
    std::fs::read_to_string(root().join("layouts").join(layout)).unwrap()
}

/// The type of `channel` + `separator` + `field`.
fn kind(channels: &Value, path: &str, separator: char) -> Option<String> {
    let (channel, field) = path.split_once(separator)?;
    channels[channel]["types"][field].as_str().map(str::to_owned)
}

#[test]
fn every_path_of_the_foxglove_layout_is_in_a_log_with_a_type_that_its_panel_shows() {
    let channels = channels();
    let layout: Value = serde_json::from_str(&read("foxglove.json")).unwrap();
    let panels = layout["configById"].as_object().unwrap();
    let mut shown = 0;
    for (id, panel) in panels {
        assert!(layout["layout"].to_string().contains(&format!("\"{id}\"")), "{id} has no place");
        let fits: &[&str] = if id.starts_with("Plot!") { &["number"] } else { &["string", "boolean"] };
        for path in panel["paths"].as_array().into_iter().flatten() {
            let path = path["value"].as_str().unwrap();
            let found = kind(&channels, path, '.').unwrap_or_else(|| panic!("{id}: a log has no {path}"));
            assert!(fits.contains(&found.as_str()), "{id}: {path} is a {found}");
            shown += 1;
        }
        if let Some(topic) = panel["topicPath"].as_str() {
            assert!(channels[topic].is_object(), "{id}: a log has no channel {topic}");
        }
    }
    assert!(shown > 10 && panels.contains_key("RawMessages!event"), "{shown}");
}

#[test]
fn every_curve_of_the_plotjuggler_layout_is_a_number_in_a_log() {
    let channels = channels();
    let layout = read("plotjuggler.xml");
    let curves: Vec<&str> = layout.split("<curve name=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert!(curves.len() > 10, "{curves:?}");
    for curve in curves {
        assert_eq!(kind(&channels, curve, '/').as_deref(), Some("number"), "{curve}");
    }
}
