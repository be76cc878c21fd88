//! Logs that were cut, damaged or could not be written, by the binary.

use std::fs;
use std::process::Command;
use system_tests::{Bench, Ran};

#[test]
fn recover_says_by_its_exit_status_how_much_of_a_flight_is_left() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "5", "--log", "whole.mcap"]);
    let whole = fs::read(bench.path("whole.mcap")).unwrap();
    bench.write("cut.mcap", &whole[..whole.len() / 2]);
    bench.write("rubbish.mcap", [7; 5000]);

    let recover = |log: &str| bench.run(&["log", "recover", log]);
    let all = recover("whole.mcap");
    assert_eq!(all.code, Some(0), "{}", all.errors);
    let export = |log: &str| bench.output(&["log", "export", log]);
    assert_eq!(export("whole.recovered.mcap"), export("whole.mcap"));

    let some = recover("cut.mcap");
    assert!(some.code == Some(3) && some.errors.contains("some of the flight is lost"), "{some:?}");
    let (rest, before) = (export("cut.recovered.mcap"), export("whole.mcap"));
    assert!(rest.lines().count() > 50 && before.starts_with(&rest), "{}", rest.lines().count());

    let nothing = recover("rubbish.mcap");
    assert_eq!(nothing.code, Some(1), "{nothing:?}");
    assert!(!bench.path("rubbish.recovered.mcap").exists());
}

#[test]
fn a_flight_whose_log_cannot_be_written_goes_on_and_says_so() {
    let bench = Bench::default();
    let ran = bench.run(&["run", "--sim", "--duration", "1", "--log", "config.toml/f.mcap"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.errors.contains("flying without a log") && ran.errors.contains("flying \""), "{}", ran.errors);
}

#[test]
fn a_disk_that_fills_up_in_flight_is_said_at_once_and_costs_neither_the_flight_nor_what_was_written() {
    let bench = Bench::default();
    let airball = bench.airball(&["run", "--sim", "--duration", "8", "--log", "f.mcap"]);
    // A shell that limits files to 24 blocks of 512 bytes, and ignores the signal of the limit.
    let mut limited = Command::new("sh");
    limited.args(["-c", "trap '' XFSZ; ulimit -f 24; exec \"$@\"", "sh"]).arg(airball.get_program());
    limited.args(airball.get_args()).current_dir(airball.get_current_dir().unwrap());
    let ran = Ran::from(limited.output().unwrap());
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.errors.contains("f.mcap failed after") && ran.errors.contains("the flight goes on"), "{}", ran.errors);
    assert!(ran.output.contains("log       f.mcap"), "{}", ran.output);
    assert!(ran.errors.contains("cycles of the flight; the summary is of these"), "{}", ran.errors);
    let info = bench.run(&["log", "info", "f.mcap"]);
    assert!(info.code == Some(0) && info.output.contains("waiting → flying"), "{info:?}");
}
