//! Tests of `load.rs`.

use super::{Config, ConfigError};
use std::path::PathBuf;

const GOOD: &str = "[plant]\ngain_mm_per_s2_per_percent = 827.2\ndrag_per_s = 3.896\n\
    hover_duty_percent = 21.4\npipe_length_mm = 583.0\n\n[plant.noise]\nsensor_mm = 2.5\n\
    acceleration_psd_mm2_per_s3 = 360.0\n";

struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    }
}

fn error_of(text: &str) -> String {
    let files = Files::new();
    let path = files.write("c.toml", text);
    let message = Config::read(&path, &[]).unwrap_err().to_string();
    message.replace(&files.0.path().display().to_string(), "")
}

#[test]
fn an_unknown_key_is_named_with_its_line_and_the_known_keys() {
    let message = error_of(&GOOD.replace("drag_per_s", "drag"));
    assert!(message.starts_with("/c.toml:3: plant.drag: unknown key `drag`"), "{message}");
    assert!(message.contains("`drag_per_s`"), "{message}");
    let message = error_of(&format!("{GOOD}\n[plant.effects.fan_lagg]\ntime_constant_s = 0.2\n"));
    assert!(message.starts_with("/c.toml:11: plant.effects.fan_lagg: unknown key"), "{message}");
    assert!(message.contains("`dead_zone`") && message.contains("`fan_lag`"), "{message}");
    assert!(message.ends_with("name the file that defines an effect of your own with `--effects FILE`"), "{message}");
    let message = error_of(&format!("{GOOD}\n[plant.effects.fan_lag]\ntau_s = 0.2\n"));
    assert!(message.contains("unknown key `tau_s`") && !message.contains("--effects"), "{message}");
}

#[test]
fn a_value_out_of_range_is_named_with_its_line_and_bounds() {
    let message = error_of(&GOOD.replace("3.896", "-1.0"));
    assert!(message.starts_with("/c.toml:3: plant.drag_per_s = -1 is outside 0 to 1000"), "{message}");
    let message = error_of(&GOOD.replace("360.0", "nan"));
    assert!(message.starts_with("/c.toml:9: plant.noise.acceleration_psd_mm2_per_s3 = NaN"), "{message}");
}

#[test]
fn what_contradicts_something_else_is_named_with_its_line() {
    let lags = "\n[plant.effects.fan_lag]\ntime_constant_s = 0.2\n\n[plant.effects.spin_asymmetry]\nup_s = 0.1\ndown_s = 0.2\n";
    let message = error_of(&format!("{GOOD}{lags}"));
    assert!(message.starts_with("/c.toml:14: plant.effects.spin_asymmetry: "), "{message}");
    assert!(message.contains("fan_lag") && message.contains("delete one"), "{message}");
    let stops = "\n[plant.effects.end_stop]\nbottom_mm = 400.0\ntop_mm = 300.0\nrestitution = 0.5\n";
    let message = error_of(&format!("{GOOD}{stops}"));
    assert!(message.starts_with("/c.toml:12: plant.effects.end_stop: bottom_mm is not below top_mm"), "{message}");
}

#[test]
fn a_patch_with_an_effect_that_contains_the_believed_one_takes_its_place_and_back() {
    let lag = "[plant.effects.fan_lag]\ntime_constant_s = 0.2\n";
    let spin = "[plant.effects.spin_asymmetry]\nup_s = 0.1\ndown_s = 0.2\n";
    let files = Files::new();
    for (name, believed, patch) in [("spin_asymmetry", lag, spin), ("fan_lag", spin, lag)] {
        let (config, patch) = (files.write("c.toml", &format!("{GOOD}\n{believed}")), files.write("p.toml", patch));
        let effects = Config::read(&config, &[patch]).unwrap().tables.plant.unwrap().effects;
        assert_eq!(effects.present().iter().map(|entry| entry.name).collect::<Vec<_>>(), [name]);
    }
    let patch = files.write("both.toml", &format!("{lag}{spin}"));
    let message = Config::read(&files.write("c.toml", GOOD), &[patch]).unwrap_err().to_string();
    assert!(message.contains("delete one of the two tables"), "{message}");
}

#[test]
fn a_missing_key_and_a_wrong_type_point_at_their_table() {
    let message = error_of(&GOOD.replace("drag_per_s = 3.896\n", ""));
    assert!(message.starts_with("/c.toml:1: plant: missing key `drag_per_s`"), "{message}");
    let message = error_of(&GOOD.replace("3.896", "\"fast\""));
    assert!(
        message.starts_with("/c.toml:3: plant.drag_per_s: wrong type: the text \"fast\", expected a number"),
        "{message}"
    );
}

#[test]
fn a_text_that_is_no_toml_is_named_with_its_place_and_not_echoed_whole() {
    let message = error_of(&format!("{GOOD}\n[safety]\nb = \"open\n"));
    assert!(message.starts_with("/c.toml:12:10: no TOML at the end of the line: "), "{message}");
    let message = error_of(&format!("a = {}", "[".repeat(200_000)));
    assert!(message.starts_with("/c.toml:1:") && message.len() < 400, "{} letters: {message:.400}", message.len());
}

/// The project's config under a patch.
fn patched(patch: &str) -> Result<super::Tables, String> {
    let files = Files::new();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = Config::read(&root.join("config.toml"), &[files.write("p.toml", patch)]);
    read.map(|config| config.tables)
        .map_err(|error| error.to_string().replace(&files.0.path().display().to_string(), ""))
}

#[test]
fn a_patch_can_take_away_a_table_and_a_number() {
    let keys = ["controller.state_feedback.integral", "observer.believed.fan_lag_s", "plant.effects.fan_lag"];
    let tables = patched(&format!("remove = {keys:?}\n[safety]\nstall_s = 0.4\n")).unwrap();
    assert_eq!(tables.controller.unwrap().state_feedback.unwrap().integral, None);
    assert_eq!(tables.observer.unwrap().believed.fan_lag_s, None);
    assert!(tables.plant.unwrap().effects.present().is_empty());
    assert_eq!(tables.safety.unwrap().stall_s, 0.4);
}

#[test]
fn what_a_patch_cannot_take_away_is_named_with_its_line() {
    let message = patched("\nremove = [\"plant.effects.fan_lagg\"]\n").unwrap_err();
    assert!(message.starts_with("/p.toml:2: remove: `plant.effects.fan_lagg` is not in the config"), "{message}");
    for wrong in ["remove = \"plant\"", "remove = [1]"] {
        let message = patched(wrong).unwrap_err();
        assert!(message.starts_with("/p.toml:1: remove: it is no list of keys"), "{message}");
    }
    let message = error_of("remove = []\n");
    assert!(message.starts_with("/c.toml:1: remove: unknown key"), "{message}");
}

#[test]
fn another_variant_in_a_patch_takes_the_place_of_the_one_below() {
    let tables = patched("[controller.state_feedback.integral.in_place]\nti_s = 3.0\n").unwrap();
    let integral = tables.controller.unwrap().state_feedback.unwrap().integral;
    assert_eq!(integral, Some(control::state_feedback::Integral::InPlace { ti_s: 3.0 }));
    let tables = patched("[reference]\nsetpoint_mm.constant = { value = 250.0 }\n").unwrap();
    assert_eq!(tables.reference.unwrap().setpoint_mm, control::waveform::Waveform::Constant { value: 250.0 });
    let tables = patched("[reference]\nsetpoint_mm.square = { low = 250.0 }\n").unwrap();
    let square = control::waveform::Waveform::Square { low: 250.0, high: 400.0, period_s: 16.0 };
    assert_eq!(tables.reference.unwrap().setpoint_mm, square);
}

#[test]
fn gains_per_percent_behind_a_predistortion_are_refused_with_the_ones_that_are_meant() {
    let message = patched("[compensation]\npredistortion = {}\n").unwrap_err();
    assert!(message.contains("observer.believed.gain_mm_per_s2_per_control: 827.2 is of"), "{message}");
    assert!(message.contains("measure force-curve --patch-out"), "{message}");
    let message = patched(
        "remove = [\"observer\", \"controller.cascade\", \"controller.lqg\", \"controller.mpc\"]\n\
        [compensation]\npredistortion = {}\n",
    );
    assert!(message.unwrap_err().contains("controller.pid.kp_per_mm: 0.018 is of"));
}

#[test]
fn the_numbers_that_a_refused_predistortion_names_make_it_fly() {
    let message = patched("[compensation]\npredistortion = {}\n").unwrap_err();
    let numbers = message.split_once("by this curve: ").and_then(|(_, rest)| rest.split_once(". By the curve"));
    let (numbers, _) = numbers.unwrap_or_else(|| panic!("{message}"));
    let patch = format!("{}\ncompensation.predistortion = {{}}\n", numbers.replace(", ", "\n"));
    let there = patched(&patch).unwrap();
    let kp_per_mm = there.controller.unwrap().pid.unwrap().kp_per_mm;
    assert!(kp_per_mm > 1.0 && there.observer.unwrap().believed.gain_mm_per_s2_per_control < 10.0, "{patch}");
}

#[test]
fn what_two_tables_say_must_agree() {
    let safety = "[safety]\nsetpoint_min_mm = 30.0\nsetpoint_max_mm = 550.0\nduty_min_percent = 10.0\nduty_max_percent = 40.0\n\
        coast_s = 0.3\n";
    let message = error_of(&format!("{safety}[rig]\nname = \"r\"\nsensor_to_bottom_mm = 400.0\nfan_pwm_hz = 1526.0\n"));
    assert!(message.starts_with("/c.toml:3: safety.setpoint_max_mm = 550 is outside 0 to 400"), "{message}");
    let message = error_of(&format!("{safety}[compensation]\nhover_duty_percent = 60.0\n"));
    assert!(message.starts_with("/c.toml:8: compensation.hover_duty_percent = 60 is outside 10 to 40"), "{message}");
}

#[test]
fn a_name_that_fits_no_topic_and_a_scale_of_nothing_are_found_at_once() {
    let message = error_of("[rig]\nname = \"a/b\"\nsensor_to_bottom_mm = 583.0\nfan_pwm_hz = 1526.0\n");
    assert!(message.starts_with("/c.toml:2: rig.name"), "{message}");
    let message = error_of("[import]\nposition_mm = { column = \"y\", scale = 0.0 }\n");
    assert!(message.starts_with("/c.toml:1: import"), "{message}");
    let message = error_of("[mqtt]\nhost = \"h\"\nport = 0\n");
    assert!(message.starts_with("/c.toml:3: mqtt.port"), "{message}");
}

#[test]
fn a_password_in_the_config_is_refused_with_the_key_for_its_file_and_not_repeated() {
    let message = error_of("[mqtt]\nhost = \"h\"\nuser = \"u\"\npassword = \"s3cret\"\n");
    assert!(message.contains("`password_file`") && !message.contains("s3cret"), "{message}");
}

#[test]
fn a_stall_that_every_cycle_would_be_is_named_with_both_numbers() {
    let project = include_str!("../../../../config.toml");
    for (period, stall, refused) in [("0.5", "0.5", true), ("0.8", "0.5", true), ("0.02", "0.05", false)] {
        let text = project.replace("period_s = 0.02 ", &format!("period_s = {period} "));
        let text = text.replace("stall_s = 0.5 ", &format!("stall_s = {stall} "));
        let files = Files::new();
        let read = Config::read(&files.write("c.toml", &text), &[]);
        assert_eq!(read.is_err(), refused, "{period} {stall}: {read:?}");
        if let Err(error) = read {
            let said = error.to_string();
            assert!(
                said.contains("safety.stall_s: 0.5 s") && said.contains(&format!("period_s = {period} s")),
                "{said}"
            );
        }
    }
}

#[test]
fn broken_toml_is_shown_where_it_breaks() {
    let message = error_of("[plant]\ngain = = 3\n");
    assert!(message.starts_with("/c.toml:2:8: no TOML at `= 3`"), "{message}");
}

#[test]
fn a_missing_file_is_named_with_the_flag_that_names_it() {
    let message = Config::read(&PathBuf::from("nowhere.toml"), &[]).unwrap_err().to_string();
    assert!(message.contains("nowhere.toml") && message.contains("--config"), "{message}");
}

#[test]
fn a_missing_table_names_the_command_that_needs_it() {
    let files = Files::new();
    let config = Config::read(&files.write("c.toml", ""), &[]).unwrap();
    let error = config.need("replay", "plant", |tables| tables.plant.as_ref()).unwrap_err();
    assert!(matches!(error, ConfigError::Missing { table: "plant", command: "replay", .. }), "{error}");
}

#[test]
fn later_patches_win_and_their_mistakes_are_found_in_their_own_file() {
    let files = Files::new();
    let base = files.write("c.toml", GOOD);
    let first = files.write("a.toml", "[plant]\ndrag_per_s = 2.0\nhover_duty_percent = 20.0\n");
    let second = files.write("b.toml", "[plant]\ndrag_per_s = 3.0\n[plant.effects.fan_lag]\ntime_constant_s = 0.1\n");
    let plant = Config::read(&base, &[first.clone(), second]).unwrap().tables.plant.unwrap();
    assert_eq!((plant.drag_per_s, plant.hover_duty_percent), (3.0, 20.0));
    assert!(plant.effects.fan_lag.is_some());

    let wrong = files.write("w.toml", "\n[plant]\ndrag_per_s = -3.0\n");
    let message = Config::read(&base, &[first, wrong]).unwrap_err().to_string();
    assert!(message.contains("w.toml:3: plant.drag_per_s = -3"), "{message}");
}

#[test]
fn the_config_in_force_reads_back_as_itself() {
    let files = Files::new();
    let config = Config::read(&files.write("c.toml", GOOD), &[]).unwrap();
    let again = Config::read(&files.write("again.toml", &config.to_toml()), &[]).unwrap();
    assert_eq!(again.tables, config.tables);
}

#[test]
fn an_observer_of_a_signal_that_the_rig_does_not_have_is_refused_with_the_table_that_is_missing() {
    let text = include_str!("../../../../config.toml");
    for (key, table) in [("tachometer", "rig.tachometer"), ("second_sensor_mm", "rig.second_sensor")] {
        let wanting = text.replace(&format!("# {key} = "), &format!("{key} = "));
        assert_ne!(wanting, text);
        let said = error_of(&wanting);
        assert!(said.contains(&format!("observer.{key}: ")) && said.contains(&format!("[{table}]")), "{said}");
    }
}

/// A config that knows one written effect; `values`: its table below `[plant.effects]`.
fn with_leak(definition: &str, values: &str) -> String {
    format!(
        "{GOOD}\n{values}\n[effect.leak]\nstage = \"air\"\nadds = \"{definition}\"\n\
         parameters.k = {{ neutral = 0.0, low = 0.0, high = 20.0 }}\n"
    )
}

#[test]
fn a_written_effect_is_switched_on_by_its_values_and_reads_back() {
    let files = Files::new();
    let text = with_leak("-k * max(x - 300, 0)", "[plant.effects.leak]\nk = 2");
    let config = Config::read(&files.write("c.toml", &text), &[]).unwrap();
    let plant = config.tables.plant.clone().unwrap();
    assert_eq!(plant.effects.values("leak"), Some(vec![2.0]));
    assert_eq!(plant.force_at_rest(350.0), -100.0);
    let again = Config::read(&files.write("again.toml", &config.to_toml()), &[]).unwrap();
    assert_eq!(again.tables, config.tables);
    // A patch from its own definition, as `diagnose` writes it, stands for the same effect.
    let definition = plant.effects.written.present().next().unwrap().to_string();
    let patch = files.write("p.toml", &format!("{definition}\n[plant.effects.leak]\nk = 2.0\n"));
    assert_eq!(Config::read(&files.write("g.toml", GOOD), &[patch]).unwrap().tables.plant.unwrap(), plant);
}

#[test]
fn a_wrong_definition_or_value_is_found_in_its_line_with_the_column_of_the_formula() {
    for (definition, values, part) in [
        ("-k * max(x - 300, 0", "", "effect.leak.adds: `-k * max(x - 300, 0`, column 6"),
        ("-k * high", "", "column 6"),
        ("k * x", "[plant.effects.leak]\nkk = 2.0", "plant.effects.leak.kk: unknown key `kk`; expected `k`"),
        ("k * x", "[plant.effects.leak]", "plant.effects.leak: the key `k` is missing"),
        ("k * x", "[plant.effects.leak]\nk = \"two\"", "is no number"),
        ("k * x", "[plant.effects.leak]\nk = 20.5", "k = 20.5"),
        ("k * x", "[plant.effects]\nleak = 3", "plant.effects.leak: must be a table with `k`"),
    ] {
        let message = error_of(&with_leak(definition, values));
        assert!(message.starts_with("/c.toml:") && message.contains(part), "{message}");
    }
}
