//! Bad input: each case gets an error with the file, the line or the key, and the next step; no written file is lost.

use system_tests::{Bench, Ran};

/// Runs a command that must fail with `code` and print all of `words`.
fn refused(bench: &Bench, arguments: &[&str], code: i32, words: &[&str]) {
    let Ran { code: got, errors, output } = bench.run(arguments);
    assert_eq!(got, Some(code), "{arguments:?}: {errors}");
    for word in words {
        assert!(errors.contains(word), "{arguments:?}: no `{word}` in: {errors}");
    }
    assert!(!errors.contains("panicked") && output.is_empty(), "{errors}{output}");
}

/// A bench whose config has `from` replaced by `to`.
fn with_config(from: &str, to: &str) -> Bench {
    let bench = Bench::default();
    let config = bench.read("config.toml");
    assert!(config.contains(from), "{from}");
    bench.write("config.toml", config.replace(from, to));
    bench
}

const SIMULATE: [&str; 3] = ["simulate", "--duration", "1"];

#[test]
fn an_unknown_key_of_the_config_is_named_with_file_line_and_the_known_keys() {
    let bench = with_config("pipe_length_mm", "pipe_length_metres");
    refused(&bench, &SIMULATE, 2, &["config.toml:", "plant.pipe_length_metres", "unknown key", "`pipe_length_mm`"]);
    let bench = with_config("[plant.effects.fan_lag]", "[plant.effects.fan_lagg]");
    refused(&bench, &SIMULATE, 2, &["plant.effects.fan_lagg", "`dead_zone`", "`fan_lag`"]);
}

#[test]
fn a_value_out_of_range_is_named_with_its_bounds() {
    let bench = with_config("period_s = 0.02 ", "period_s = 0.0002 ");
    refused(&bench, &SIMULATE, 2, &["config.toml:", "loop.period_s = 0.0002 is outside 0.005 to 1"]);
    let bench = with_config("pipe_length_mm = 583.0", "pipe_length_mm = nan");
    refused(&bench, &SIMULATE, 2, &["plant.pipe_length_mm = NaN is outside"]);
}

#[test]
fn a_check_of_the_config_reads_the_experiments_on_offer_and_warns_of_a_loop_that_outruns_its_sensor() {
    let check = ["config", "check"];
    let bench = with_config("[mqtt]", "[mqtt]\nexperiments = [\"gone.toml\"]");
    refused(&bench, &check, 2, &["gone.toml", "[mqtt] experiments"]);
    let bench = with_config("period_s = 0.02 ", "period_s = 0.018 ");
    let ran = bench.run(&check);
    assert!(ran.code == Some(0) && ran.output.contains("is sound"), "{ran:?}");
    assert!(ran.errors.contains("warning: [loop] period_s = 0.018 is shorter"), "{ran:?}");
    assert!(!Bench::default().run(&check).errors.contains("warning"));
}

#[test]
fn a_setpoint_outside_the_pipe_is_refused_in_the_config_and_in_an_experiment() {
    let bench = with_config("high = 400.0", "high = 700.0");
    refused(&bench, &SIMULATE, 2, &["reference.setpoint_mm", "700", "30 to 550"]);
    let bench = Bench::default();
    bench.write("e.toml", "title = \"t\"\n[[segment]]\nduration_s = 5.0\nsetpoint_mm.constant = { value = 600.0 }\n");
    refused(&bench, &["simulate", "--experiment", "e.toml"], 2, &["e.toml:4", "600", "30 to 550"]);
}

#[test]
fn a_table_that_a_command_needs_is_named_with_the_command() {
    let bench = Bench::default();
    bench.write("thin.toml", "[safety]\nsetpoint_min_mm = 30.0\n");
    refused(&bench, &["simulate", "--config", "thin.toml"], 2, &["thin.toml:1", "safety", "missing key"]);
    bench.write("empty.toml", "");
    refused(&bench, &["simulate", "--config", "empty.toml"], 2, &["[loop]", "simulate", "empty.toml"]);
    bench.write("f.csv", "time_s,duty_percent,position_mm\n0,1,2\n");
    refused(&bench, &["replay", "f.csv", "--config", "empty.toml"], 2, &["[plant]", "replay"]);
}

#[test]
fn a_missing_config_log_or_patch_is_named() {
    let bench = Bench::default();
    refused(&bench, &["simulate", "--config", "no.toml"], 2, &["no.toml", "--config"]);
    refused(&bench, &["simulate", "--patch", "no.toml"], 2, &["no.toml", "--patch"]);
    refused(&bench, &["simulate", "--experiment", "no.toml"], 2, &["no.toml", "--experiment"]);
    refused(&bench, &["replay", "no.mcap"], 1, &["no.mcap", "cannot read"]);
}

#[test]
fn what_the_system_says_of_a_folder_that_cannot_be_made_is_said_too_in_the_same_line() {
    let bench = Bench::default();
    let ran = bench.gallery(&["--out", "config.toml/gallery"]);
    let said = "gallery: cannot make the folder config.toml/gallery; check the permissions; the cause: Not a directory (os error 20)\n";
    assert_eq!((ran.code, ran.errors.as_str()), (Some(1), said));
}

#[test]
fn a_wrong_flag_is_wrong_usage() {
    refused(&Bench::default(), &["simulate", "--duration", "-5"], 2, &["--duration", "above 0"]);
    refused(&Bench::default(), &["simulat"], 2, &["simulate"]);
}

#[test]
fn a_bad_csv_is_named_with_file_line_and_column() {
    let bench = Bench::default();
    let rows = |bad: &str| {
        let good: String = (0..30).map(|k| format!("{:.2},21.4,{}\n", 0.02 * f64::from(k), 100 + k)).collect();
        format!("time_s,duty_percent,position_mm\n{good}{bad}")
    };
    for (file, words) in [
        (String::new(), &["f.csv is empty"][..]),
        ("time_s,duty_percent,position_mm\n".into(), &["f.csv has a header and no rows"]),
        ("t,u,y\n0,1,2\n".into(), &["f.csv, line 1", "`time_s`", "[import]"]),
        (rows("0.60,fast,130\n"), &["f.csv, line 32", "`duty_percent`", "fast"]),
        (rows("0.60,21.4,inf\n"), &["f.csv, line 32", "`position_mm`", "not finite"]),
        (rows("0.60,NaN,130\n"), &["f.csv, line 32", "`duty_percent`", "no reading"]),
        (rows("0.10,21.4,130\n"), &["f.csv, line 32", "time goes backwards", "0.58", "0.1"]),
        (rows("0.60,21.4\n"), &["f.csv, line 32", "2 cells"]),
    ] {
        bench.write("f.csv", file);
        refused(&bench, &["replay", "f.csv"], 1, words);
        refused(&bench, &["diagnose", "f.csv"], 1, words);
    }
    bench.write("f.csv", [0x74, 0x2C, 0xB5, 0x00]);
    refused(&bench, &["replay", "f.csv"], 1, &["f.csv, line 1", "UTF-8"]);
}

#[test]
fn a_truncated_log_is_replayed_up_to_its_last_whole_message_and_says_so() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "40", "--log", "f.mcap"]);
    let whole = std::fs::read(bench.path("f.mcap")).unwrap();
    bench.write("cut.mcap", &whole[..whole.len() / 2]);
    let ran = bench.run(&["replay", "cut.mcap"]);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    assert!(ran.errors.contains("cut.mcap: the log is not whole"), "{}", ran.errors);
    assert!(ran.output.contains("forecast ahead"), "{}", ran.output);
    // The recovered rows are a prefix of the flown ones.
    let csv = |log| bench.output(&["log", "export", log]);
    let (cut, all) = (csv("cut.mcap"), csv("f.mcap"));
    assert!(all.starts_with(&cut) && cut.lines().count() > 500, "{} lines", cut.lines().count());
}

#[test]
fn an_unreadable_log_is_an_error_that_names_it() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "4", "--log", "f.mcap"]);
    let whole = std::fs::read(bench.path("f.mcap")).unwrap();
    bench.write("stub.mcap", &whole[..40]);
    refused(&bench, &["replay", "stub.mcap"], 1, &["stub.mcap", "no readable message"]);
    let _ = bench.output(&["simulate", "--duration", "0.2", "--log", "short.mcap"]);
    refused(&bench, &["replay", "short.mcap"], 1, &["short.mcap", "too few"]);
}

#[test]
fn a_reader_that_leaves_early_is_no_failure() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--log", "f.mcap"]);
    let mut export = bench.airball(&["log", "export", "f.mcap"]);
    let mut child = export.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert_eq!((ran.code, ran.errors.as_str()), (Some(0), ""));
}
