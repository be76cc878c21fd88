//! Any text as a config: refused with a place, or sound, reproducible from what a log keeps of it, and able to fly.
#![no_main]

use airball::fuzzing::{Experiment, Tables, parse_text};
use control::regulator::Regulator;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (tables, place) = match parse_text::<Tables>("c.toml", text) {
        Ok(read) => read,
        Err(error) => return assert!(error.to_string().contains("c.toml"), "{error}"),
    };
    assert!(place("plant.effects.fan_lag.time_constant_s").starts_with("c.toml"));
    if tables.check().is_err() || tables.check_words().is_err() {
        return;
    }
    let kept = toml::to_string(&tables).expect("the config in force is kept as TOML");
    assert_eq!(toml::from_str::<Tables>(&kept).expect("and can be read again"), tables);
    if let Some(controllers) = tables.controller {
        let period_s = tables.r#loop.map_or(0.02, |table| table.period_s);
        let _ = Regulator::new(controllers, tables.observer.as_ref(), period_s);
    }
    if let Some(safety) = tables.safety {
        let _ = Experiment::own("e.toml", text, &safety);
    }
});
