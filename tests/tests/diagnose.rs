//! The diagnosis from the command line: a verdict, a document, and a patch that corrects the simulator.

use serde_json::Value;
use system_tests::Bench;

const STUCK: &str = "[plant.effects.dead_zone]\nlower_percent = -0.3\nupper_percent = 0.3\n";

fn diagnose(bench: &Bench, arguments: &[&str]) -> Value {
    let flags = [&["diagnose", "--json"], arguments].concat();
    serde_json::from_str(&bench.output(&flags)).unwrap()
}

#[test]
fn a_simulated_flight_against_its_own_config_has_no_gap() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--seed", "4", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--patch-out", "mend.toml"]);
    assert_eq!((&found["verdict"], &found["config_patch"]), (&Value::from("no_gap"), &Value::from("")), "{found}");
    assert_eq!(bench.read("mend.toml"), "");
    assert!(bench.output(&["diagnose", "f.mcap"]).starts_with("No gap"));
}

#[test]
fn a_dead_zone_is_named_and_its_patch_closes_the_gap_in_replay() {
    let bench = Bench::default();
    bench.write("stuck.toml", STUCK);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--duration", "70", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--patch-out", "mended.toml"]);
    assert_eq!(found["verdict"], "effect", "{found}");
    let effect = &found["effects"][0];
    assert_eq!((&effect["name"], &effect["change"]), (&Value::from("dead_zone"), &Value::from("added")));
    let zone = &effect["parameters"];
    let of = |key: &str, end: &str| zone[key][end].as_f64().unwrap();
    // A shift of both edges is a shift of hover: only the width is identifiable.
    let width = of("upper_percent", "value") - of("lower_percent", "value");
    assert!((0.45..0.75).contains(&width), "{zone}");
    let (low, high) = (of("upper_percent", "low"), of("upper_percent", "high"));
    assert!(low < 0.3 && 0.3 < high && high - low < 0.7, "{zone}");
    assert!(found["gap"]["closed"]["value"].as_f64().unwrap() > 0.8, "{found}");
    assert_eq!(found["where"]["stage"][0]["name"], "actuator");

    let error = |flags: &[&str]| {
        let gap: Value =
            serde_json::from_str(&bench.output(&[&["replay", "f.mcap", "--json"], flags].concat())).unwrap();
        gap["error_mm"][2].as_f64().unwrap()
    };
    assert!(error(&["--patch", "mended.toml"]) < 0.7 * error(&[]));
    let _ = bench.output(&["simulate", "--patch", "mended.toml", "--duration", "5", "--log", "mended.mcap"]);
}

#[test]
fn a_rotor_that_coasts_down_slowly_takes_the_place_of_the_believed_lag_in_simulate_and_replay() {
    let bench = Bench::default();
    bench.write("spin.toml", "[plant.effects.spin_asymmetry]\nup_s = 0.12\ndown_s = 0.45\n");
    let flown = ["simulate", "--patch", "spin.toml", "--duration", "70", "--seed", "3", "--log", "f.mcap"];
    let _ = bench.output(&flown);
    let found = diagnose(&bench, &["f.mcap", "--patch-out", "mended.toml"]);
    let effect = &found["effects"][0];
    assert_eq!(
        (&found["verdict"], &effect["name"]),
        (&Value::from("effect"), &Value::from("spin_asymmetry")),
        "{found}"
    );
    let replayed: Value =
        serde_json::from_str(&bench.output(&["replay", "f.mcap", "--json", "--patch", "mended.toml"])).unwrap();
    let (error, floor) = (&replayed["error_mm"][2], &replayed["floor_mm"][2]);
    assert!(error.as_f64().unwrap() < 1.3 * floor.as_f64().unwrap(), "{replayed}");
    let _ = bench.output(&["simulate", "--patch", "mended.toml", "--duration", "5", "--log", "mended.mcap"]);
}

#[test]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let bench = Bench::default();
    bench.write("stuck.toml", STUCK);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--duration", "40", "--log", "f.mcap"]);
    let answer = |threads: &str| {
        let run = bench.airball(&["diagnose", "--json", "f.mcap"]).env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(run.status.success(), "{run:?}");
        String::from_utf8(run.stdout).unwrap()
    };
    let alone = answer("1");
    assert!(alone.contains("dead_zone"), "{alone}");
    assert_eq!(alone, answer("3"));
}

#[test]
fn codes_of_a_sensor_without_a_target_count_as_empty_cells_everywhere() {
    let bench = Bench::default();
    bench.write("stuck.toml", STUCK);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--duration", "40", "--log", "f.mcap"]);
    let exported = bench.output(&["log", "export", "f.mcap"]);
    let column = exported.lines().next().unwrap().split(',').position(|name| name == "position_mm").unwrap();
    // Every sixth reading is lost: more than could be outside a pipe of the right length.
    let lost_as = |cell: &str| {
        let rows = exported.lines().enumerate().map(|(row, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if row > 0 && row % 6 == 0 {
                cells[column] = cell;
            }
            cells.join(",") + "\n"
        });
        rows.collect::<String>()
    };
    bench.write("codes.csv", lost_as("8190"));
    bench.write("empty.csv", lost_as(""));
    let (codes, empty) = (diagnose(&bench, &["codes.csv"]), diagnose(&bench, &["empty.csv"]));
    assert_eq!(empty["verdict"], "effect", "{empty}");
    for part in ["verdict", "effects", "parameters", "gap", "where", "next_experiment"] {
        assert_eq!(codes[part], empty[part], "{part}");
    }
    let replayed = |log: &str| bench.output(&["replay", log, "--json"]);
    assert_eq!(replayed("codes.csv"), replayed("empty.csv"));
    let said = codes["check"]["findings"].to_string();
    assert!(said.contains("8190 or 8191") && !said.contains("outside the model's pipe"), "{said}");
}

#[test]
fn a_record_that_cannot_answer_says_so_and_names_nothing() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let ran = bench.run(&["diagnose", "still.csv", "--json", "--html", "still.html"]);
    assert_eq!(ran.code, Some(3), "{}", ran.errors);
    let found: Value = serde_json::from_str(&ran.output).unwrap();
    assert_eq!(found["verdict"], "insufficient_data");
    // The page says why before anything else, and has no empty parts.
    let page = bench.read("still.html");
    let reason = page.find("the duty stays within").unwrap();
    assert!(reason < page.find("<nav").unwrap() && !page.contains("Which effect it is"), "{page}");
    assert_eq!(found["effects"], serde_json::json!([]));
    assert!(found["check"]["findings"].as_array().unwrap().len() >= 2, "{found}");
}

#[test]
fn the_closed_loop_is_told_before_and_after_the_mend() {
    let bench = Bench::default();
    bench.write("late.toml", "[plant.effects.transport_delay]\ndelay_s = 0.12\n");
    let _ = bench.output(&["simulate", "--patch", "late.toml", "--duration", "70", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--next-out", "next.toml"]);
    let looped = &found["gap"]["closed_loop"];
    assert_eq!(looped["steps"], 9, "{looped}");
    let overshoot = |who: &str| looped["overshoot_percent"][who].as_f64().unwrap();
    assert!((overshoot("mended") - overshoot("recorded")).abs() < 5.0, "{looped}");
    assert!(overshoot("nominal") < overshoot("recorded") - 2.0, "{looped}");
    let critical = |who: &str| looped["critical_gain_ratio"][who].as_f64().unwrap();
    assert!(critical("mended") < 0.5 * critical("nominal"), "{looped}");
    // A delay of the duty and one of the reading are not distinguishable in any flight, and the output names no
    // experiment for it.
    let findings = found["check"]["findings"].as_array().unwrap();
    assert!(findings.iter().any(|finding| finding.as_str().unwrap().contains("fan_rpm")), "{findings:?}");
    assert!(found["next_experiment"].is_null() && !bench.path("next.toml").exists());
}

#[test]
fn the_next_experiment_of_a_record_that_cannot_answer_is_a_file_that_flies() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let ran = bench.run(&["diagnose", "still.csv", "--json", "--next-out", "next.toml"]);
    let found: Value = serde_json::from_str(&ran.output).unwrap();
    let next = &found["next_experiment"];
    assert_eq!(next["file"], bench.read("next.toml"), "{found}");
    assert!(
        next["expected_nats"].as_f64().unwrap() > 2.0 && !next["separates"].as_array().unwrap().is_empty(),
        "{next}"
    );
    let _ = bench.output(&["simulate", "--experiment", "next.toml", "--log", "next.mcap"]);
    assert!(bench.run(&["diagnose", "still.csv"]).output.contains("next: fly \""));
}

#[test]
fn several_logs_are_used_together_and_each_is_spoken_of_by_name() {
    let bench = Bench::default();
    bench.write("stuck.toml", STUCK);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--seed", "2", "--duration", "40", "--log", "a.mcap"]);
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--seed", "3", "--duration", "40", "--log", "b.mcap"]);
    let exported = bench.output(&["log", "export", "b.mcap"]);
    bench.write("b.csv", &exported);
    let rows: String = (0..500).map(|k| format!("{:.2},21.4,300\n", 0.02 * f64::from(k))).collect();
    bench.write("still.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let found = diagnose(&bench, &["a.mcap", "b.csv", "still.csv"]);
    assert_eq!((&found["verdict"], &found["effects"][0]["name"]), (&Value::from("effect"), &Value::from("dead_zone")));
    assert_eq!(found["check"]["logs"], 3);
    assert!((found["check"]["duration_s"].as_f64().unwrap() - 90.0).abs() < 0.5, "{}", found["check"]);
    let findings: Vec<&str> = found["check"]["findings"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(findings.iter().any(|f| f.starts_with("still.csv: this log is left out")), "{findings:?}");
    assert_eq!(found["gap"]["closed_loop"]["steps"], 10, "{found}");
    let turned = diagnose(&bench, &["still.csv", "b.csv", "a.mcap"]);
    assert_eq!((&turned["effects"], &turned["parameters"]), (&found["effects"], &found["parameters"]));
    let said = bench.output(&["diagnose", "a.mcap", "b.csv", "--html", "page.html"]);
    assert!(said.starts_with("2 logs together, 80.0 s\n"), "{said}");
    let page = bench.read("page.html");
    let (_, table) = page.split_once("Forecast error of each log").expect("a table of the logs");
    let (table, _) = table.split_once("</table>").unwrap();
    for log in ["a.mcap", "b.csv"] {
        let row = table.split("<tr").find(|row| row.contains(log)).unwrap_or_else(|| panic!("no {log} in {table}"));
        // Of either log the dead zone takes most of the error away.
        let cells: Vec<f64> = row.split(['<', '>']).filter_map(|cell| cell.trim().parse().ok()).collect();
        assert!(matches!(cells[..], [before, after, _] if after < 0.8 * before), "{row}");
    }

    let twice = bench.airball(&["diagnose", "b.mcap", "a.mcap", "b.mcap"]).output().unwrap();
    let said = String::from_utf8(twice.stderr).unwrap();
    assert!(!twice.status.success() && said.contains("b.mcap and b.mcap hold the same flight; name it once"), "{said}");
    let config = bench.read("config.toml").replace("name = \"rig1\"", "name = \"rig2\"");
    bench.write("other.toml", config);
    let _ = bench.output(&["simulate", "--config", "other.toml", "--duration", "20", "--log", "other.mcap"]);
    let mixed = bench.airball(&["diagnose", "a.mcap", "other.mcap"]).output().unwrap();
    let said = String::from_utf8(mixed.stderr).unwrap();
    assert!(mixed.status.code() == Some(1) && said.contains("a.mcap is of rig1, other.mcap of rig2"), "{said}");
}

#[test]
fn a_recorded_fan_speed_names_one_of_two_twins_and_says_so() {
    let bench = Bench::default();
    bench.write("late.toml", "[plant.effects.transport_delay]\ndelay_s = 0.12\n");
    let _ = bench.output(&["simulate", "--patch", "late.toml", "--duration", "70", "--log", "f.mcap"]);
    // The rotor of the config, six rows behind the duty, and a tachometer with a resolution of ten.
    let (mut rotor, mut duties) = (21.4, Vec::new());
    let with_speed = |(number, line): (usize, &str)| {
        if number == 0 {
            return format!("{line},fan_rpm\n");
        }
        let seen = duties.iter().rev().nth(6).copied().unwrap_or(0.0);
        rotor += (1.0 - (-0.02_f64 / 0.257).exp()) * (seen - rotor);
        duties.push(line.split(',').nth(3).unwrap().parse::<f64>().unwrap());
        format!("{line},{:.0}\n", 10.0 * (300.0 + 14.0 * (rotor - 21.4)).round())
    };
    let table: String = bench.output(&["log", "export", "f.mcap"]).lines().enumerate().map(with_speed).collect();
    bench.write("f.csv", table);
    let found = diagnose(&bench, &["f.csv"]);
    let effect = &found["effects"][0];
    assert_eq!(
        (&effect["name"], &effect["indistinguishable_from"]),
        (&Value::from("transport_delay"), &serde_json::json!([]))
    );
    // Alone, and in its own local optimum: another one is at 0.03 s with another lag and another gain.
    let delay_s = effect["parameters"]["delay_s"]["value"].as_f64().unwrap();
    assert!((delay_s - 0.12).abs() < 0.005, "{effect}");
    assert_eq!((&found["verdict"], found["effects"].as_array().unwrap().len()), (&Value::from("effect"), 1), "{found}");
    let findings = found["check"]["findings"].to_string();
    assert!(findings.contains("the recorded `fan_rpm` tells that it is transport_delay"), "{findings}");
}

#[test]
fn a_dead_zone_is_found_whole_behind_a_correction_and_the_mend_is_its_new_numbers() {
    let bench = Bench::default();
    let half = "[compensation.dead_zone]\nlower_percent = -0.15\nupper_percent = 0.15\n";
    bench.write("stuck.toml", format!("{STUCK}\n{half}"));
    let _ = bench.output(&["simulate", "--patch", "stuck.toml", "--duration", "120", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap"]);
    assert_eq!(found["effects"][0]["name"], "dead_zone", "{found}");
    let edge = |key: &str| found["effects"][0]["parameters"][key]["value"].as_f64().unwrap();
    let width = edge("upper_percent") - edge("lower_percent");
    assert!((0.45..0.75).contains(&width), "{width}");
    let said = bench.output(&["diagnose", "f.mcap"]);
    assert!(said.contains("[compensation.dead_zone] was on with -0.15 to 0.15 %: set lower_percent = -0."), "{said}");
}

/// A flight whose positions are in metres, as a CSV.
fn in_metres(bench: &Bench) {
    let _ = bench.output(&["simulate", "--duration", "40", "--log", "f.mcap"]);
    let exported = bench.output(&["log", "export", "f.mcap"]);
    let mut lines = exported.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let [time, duty, position] = ["time_s", "duty_percent", "position_mm"].map(at);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let metres = cells[position].parse().map_or(String::new(), |mm: f64| format!("{}", mm / 1000.0));
        format!("{},{},{metres}\n", cells[time], cells[duty])
    };
    bench.write("m.csv", format!("time_s,duty_percent,position_mm\n{}", lines.map(row).collect::<String>()));
}

#[test]
fn page_and_terminal_ask_for_the_same_where_a_unit_is_wrong() {
    let bench = Bench::default();
    in_metres(&bench);
    let ran = bench.run(&["diagnose", "m.csv", "--html", "m.html"]);
    let (said, page) = (ran.output, bench.read("m.html"));
    let advice = "Correct units, signs or columns as said above, and diagnose it again.";
    assert!(said.contains(advice) && page.contains(advice), "{said}");
    assert!(!page.contains("Fly at least 30 s") && !page.contains("No further experiment is needed"));
    // A fit that was not judged is not ticked.
    assert!(page.contains("not checked: </span>gain and drag within"), "{page}");
    // Without an answer no loop is compared.
    assert!(!said.contains("closed loop"), "{said}");
}

#[test]
fn a_loop_without_a_gap_has_no_mended_margin_and_a_screened_search_no_empty_table() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--seed", "4", "--log", "f.mcap"]);
    let found = diagnose(&bench, &["f.mcap", "--html", "f.html"]);
    assert_eq!(found["verdict"], "no_gap");
    let margin = &found["gap"]["closed_loop"]["critical_gain_ratio"];
    assert!(margin["nominal"].is_number() && margin["mended"].is_null(), "{margin}");
    assert!(!bench.read("f.html").contains("<tbody></tbody>"));
}

#[test]
fn what_is_typed_nearly_right_is_answered_with_what_to_run() {
    let bench = Bench::default();
    std::fs::create_dir(bench.path("logs")).unwrap();
    let said = bench.run(&["diagnose", "logs"]).errors;
    assert!(said.contains("airball diagnose --each logs --out reports"), "{said}");
    let ran = bench.run(&["identify", "x.csv"]);
    assert!(ran.code == Some(2) && ran.errors.contains("airball identify grey-box x.csv"), "{}", ran.errors);
}

#[test]
fn a_hole_in_the_time_has_no_more_digits_than_it_needs() {
    let bench = Bench::default();
    let rows: String = (0..500).map(|k| format!("{},21.4,300\n", 562.499_999_9 + 20_000.1 * f64::from(k))).collect();
    bench.write("us.csv", format!("time_s,duty_percent,position_mm\n{rows}"));
    let said = bench.run(&["diagnose", "us.csv"]).errors;
    assert!(said.contains("no row for 20000.1 s before row 2, 0.0 s after the first row"), "{said}");
}
