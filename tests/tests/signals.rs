//! A rig with a tachometer and a second sensor, from the command line.

use serde_json::Value;
use system_tests::Bench;

const SIGNALS: &str = "[rig.tachometer]
line = 24
pulses_per_revolution = 2
hover_rpm = 2000.0
stalled_after_s = 0.5

[rig.second_sensor]
xshut_line = 23
address = 0x30
to_bottom_mm = 583.0
disagree_mm = 80.0
disagree_s = 0.5

[rig.output_enable]
line = 4
";

#[test]
fn a_flight_with_all_signals_says_what_they_were_and_exports_them() {
    let bench = Bench::default();
    bench.write("signals.toml", SIGNALS);
    let flags = ["--patch", "signals.toml", "--duration", "20", "--log", "f.mcap", "--json"];
    let summary: Value = serde_json::from_str(&bench.output(&[&["simulate"][..], &flags].concat())).unwrap();
    let rpm = summary["fan"]["mean_rpm"].as_f64().unwrap();
    assert!((1900.0..2100.0).contains(&rpm), "{summary}");
    let apart = summary["second_sensor"]["mean_mm"].as_f64().unwrap();
    assert!(apart.abs() < 1.0, "{summary}");
    let exported = bench.output(&["log", "export", "f.mcap"]);
    assert!(
        exported
            .starts_with("time_s,setpoint_mm,control_percent,duty_percent,position_mm,fresh,position2_mm,fan_rpm\n")
    );
}

#[test]
fn a_line_that_is_not_there_is_named_before_the_fan_starts() {
    let bench = Bench::default();
    let config = bench.read("config.toml").replace("/dev/i2c-1", "/dev/null");
    bench.write("config.toml", config);
    bench.write("signals.toml", "[rig]\ngpio_chip = \"/dev/no-gpiochip\"\n[rig.tachometer]\nline = 24\npulses_per_revolution = 2\nhover_rpm = 2000.0\nstalled_after_s = 0.5\n");
    let ran = bench.run(&["run", "--patch", "signals.toml", "--log", "f.mcap"]);
    assert_eq!(ran.code, Some(1), "{}", ran.errors);
    assert!(ran.errors.contains("line 24 of /dev/no-gpiochip for [rig.tachometer]"), "{}", ran.errors);
}

#[test]
fn signals_that_get_in_each_others_way_are_named() {
    let bench = Bench::default();
    let refused = |patch: &str| {
        bench.write("bad.toml", SIGNALS.replace(patch.split("->").next().unwrap(), patch.split("->").nth(1).unwrap()));
        let ran = bench.run(&["config", "check", "--patch", "bad.toml"]);
        assert_eq!(ran.code, Some(2), "{patch}: {}", ran.errors);
        ran.errors
    };
    assert!(refused("line = 4\n->line = 24\n").contains("rig.tachometer.line has the same line"));
    assert!(refused("0x30->0x40").contains("rig.second_sensor.address: 0x40 is taken"));
    assert!(
        refused("hover_rpm = 2000.0->hover_rpm = 1.0").contains("rig.tachometer.hover_rpm = 1 is outside 10 to 100000")
    );
}
