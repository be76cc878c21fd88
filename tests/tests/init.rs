//! From somebody's CSV to a diagnosis without a config: what is guessed, what is asked, what is refused.

use serde_json::Value;
use system_tests::{Bench, root};

/// Numbers from 0 to 1, the same ones in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(self.0 >> 33).unwrap()) / f64::from(1_u32 << 31)
    }

    /// Of variance 1, nearly normal.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

/// A cart on a rail, in s, V and m: ẍ = 0.8·u − 5·ẋ less 0.35 m/s² of dry friction, a PID on a square wave with a
/// little shaking, 60 s at 100 Hz, 0.5 mm of noise. Equations of this test, not of the program.
fn cart() -> Vec<[f64; 3]> {
    let mut random = Random(7);
    let (mut x, mut v, mut sum, mut rows) = (0.3_f64, 0.0_f64, 0.0, Vec::new());
    let mut before = x;
    for k in 0..6000_u32 {
        let t = 0.01 * f64::from(k);
        let y = x + 0.0005 * random.normal();
        let target = if t % 6.0 < 3.0 { 0.5 } else { 0.3 };
        sum += 0.01 * (target - y);
        let shake = 1.5 * ((3.1 * t).sin() + (7.3 * t).sin());
        let u = (20.0 * (target - y) + 5.0 * sum - 1.0 * (y - before) / 0.01 + shake).clamp(-12.0, 12.0);
        before = y;
        rows.push([t, u, y]);
        for _ in 0..10 {
            let pull = 0.8 * u - 5.0 * v;
            if v == 0.0 && (0.8 * u).abs() < 0.35 {
                continue;
            }
            let against = if v == 0.0 { u.signum() } else { v.signum() };
            let next = v + 0.001 * (pull - 0.35 * against);
            v = if v * next < 0.0 { 0.0 } else { next };
            x += 0.001 * v;
        }
    }
    rows
}

fn csv(header: &str, rows: &[[f64; 3]]) -> String {
    let rows = rows.iter().map(|[t, u, y]| format!("{t:.2},{u:.3},{y:.5}\n"));
    format!("{header}\n{}", rows.collect::<String>())
}

/// A bench without the project's config.
fn bare() -> Bench {
    let bench = Bench::default();
    std::fs::remove_file(bench.path("config.toml")).unwrap();
    bench
}

fn value(config: &toml::Table, path: &[&str]) -> f64 {
    let (last, tables) = path.split_last().unwrap();
    let table = tables.iter().fold(config, |table, key| table[*key].as_table().unwrap());
    table[*last].as_float().unwrap()
}

/// The friction of the cart, found from its CSV alone.
fn names_the_friction(document: &str) {
    let found: Value = serde_json::from_str(document).unwrap();
    let first = &found["effects"][0];
    assert_eq!((&found["verdict"], &first["name"]), (&"effect".into(), &"wall_friction".into()), "{document}");
    let size = first["parameters"]["acceleration_mm_per_s2"]["value"].as_f64().unwrap();
    assert!((size / 350.0 - 1.0).abs() < 0.1, "{size} mm/s² of 350");
    let findings = found["check"]["findings"].to_string();
    assert!(findings.contains("a linear model of itself"), "{findings}");
}

#[test]
fn one_command_leads_from_a_csv_to_its_diagnosis_where_there_is_no_config() {
    let bench = bare();
    bench.write("cart.csv", csv("t,u,y", &cart()));
    let ran = bench.run(&["diagnose", "cart.csv", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.errors);
    names_the_friction(&ran.output);
    for words in ["there is no belief", "`t`", "time", "`u`", "input", "`y`", "position", "rig.toml"] {
        assert!(ran.errors.contains(words), "no {words} in {}", ran.errors);
    }
    let text = bench.read("rig.toml");
    let config: toml::Table = toml::from_str(&text).unwrap();
    assert_eq!(value(&config, &["import", "position_mm", "scale"]), 1000.0);
    // 0.8 m/s² per V, less what the friction hides from a linear model; 10 % per V.
    let gain = value(&config, &["plant", "gain_mm_per_s2_per_percent"]);
    assert!((30.0..100.0).contains(&gain), "{gain}");
    assert!((value(&config, &["plant", "noise", "sensor_mm"]) - 0.5).abs() < 0.1);
    let commented = |line: &&str| line.contains(" = ") && !line.starts_with('#') && !line.contains(" # ");
    assert_eq!(text.lines().find(commented), None, "every number has its origin");
}

#[test]
fn the_messages_alone_lead_from_a_csv_beside_another_config_to_its_diagnosis_in_two_commands() {
    let bench = Bench::default();
    bench.write("cart.csv", csv("t,u,y", &cart()));
    let refused = bench.run(&["diagnose", "cart.csv"]);
    assert_eq!(refused.code, Some(1));
    let (_, command) = refused.errors.split_once("`airball ").unwrap();
    let (command, _) = command.split_once('`').unwrap();
    let arguments: Vec<&str> = command.split(' ').chain(["--json"]).collect();
    names_the_friction(&bench.output(&arguments));
}

#[test]
fn init_writes_a_config_once_and_names_the_next_command() {
    let bench = bare();
    bench.write("cart.csv", csv("t,u,y", &cart()));
    let said = bench.output(&["init", "cart.csv", "--out", "mine.toml"]);
    assert!(said.ends_with("wrote mine.toml; next: airball diagnose cart.csv --config mine.toml\n"), "{said}");
    assert_eq!(bench.output(&["config", "check", "--config", "mine.toml"]).lines().count(), 1);
    let again = bench.run(&["init", "cart.csv", "--out", "mine.toml"]);
    assert!(again.code == Some(2) && again.errors.contains("--force"), "{}", again.errors);
    let _ = bench.output(&["init", "cart.csv", "--out", "mine.toml", "--force", "--yes"]);
}

#[test]
fn columns_are_found_by_their_names_their_numbers_or_as_they_are_said() {
    let bench = bare();
    let rows = cart();
    let import = |table: &str, flags: &[&str]| {
        bench.write("log.csv", table);
        let _ = bench.output(&[&["init", "log.csv", "--force"], flags].concat());
        toml::from_str::<toml::Table>(&bench.read("rig.toml")).unwrap()["import"].clone()
    };
    // Names that say nothing: the pair that fits.
    let found = import(&csv("a,b,c", &rows), &[]);
    let column = |found: &toml::Value, key: &str| found[key]["column"].as_str().unwrap().to_owned();
    let three = |found: &toml::Value| ["time_s", "duty_percent", "position_mm"].map(|key| column(found, key));
    assert_eq!(three(&found), ["a", "b", "c"]);
    // Milliseconds, a row number before them and a decimal comma.
    let german: String = rows
        .iter()
        .enumerate()
        .map(|(k, [t, u, y])| {
            format!(
                "{k};{:.0};{};{}\n",
                1000.0 * t,
                format!("{u:.3}").replace('.', ","),
                format!("{y:.5}").replace('.', ",")
            )
        })
        .collect();
    let found = import(&format!(";Zeit [ms];Spannung [V];Weg [m]\n{german}"), &[]);
    assert_eq!(three(&found), ["Zeit [ms]", "Spannung [V]", "Weg [m]"]);
    assert_eq!(found["time_s"]["scale"].as_float(), Some(0.001));
    // A user's word comes first, and the sign of the input is turned where the record says so.
    let turned: Vec<[f64; 3]> = rows.iter().map(|[t, u, y]| [*t, -u, *y]).collect();
    let found = import(&csv("x,y,z", &turned), &["--time", "x", "--input", "y", "--position", "z"]);
    assert_eq!(three(&found), ["x", "y", "z"]);
    assert!(found["duty_percent"]["scale"].as_float().unwrap() < 0.0, "{found}");
    let refused = bench.run(&["init", "log.csv", "--force", "--input", "q"]);
    assert!(refused.code == Some(2) && refused.errors.contains("`x`, `y`, `z`"), "{}", refused.errors);
}

#[test]
fn columns_are_found_by_a_unit_or_by_a_name_in_another_language() {
    let bench = bare();
    for (header, position) in [
        ("tempo_s,tensao_V,posicao_m", "by its name"),
        ("tiempo,entrada,ángulo", "by its name"),
        ("t,u,arm_m", "by its unit"),
        ("t,u,shaft [rad]", "by its unit"),
    ] {
        bench.write("log.csv", csv(header, &cart()));
        let found = bench.output(&["init", "log.csv", "--force"]);
        let last = header.split(',').next_back().unwrap();
        let of_position = found.lines().find(|line| line.starts_with(&format!("`{last}`"))).unwrap();
        assert!(of_position.contains("→ position") && of_position.contains(position), "{found}");
    }
}

#[test]
fn a_log_of_distances_from_above_without_a_time_needs_its_period_and_a_scale_below_0() {
    let bench = bare();
    let rows = cart();
    let rows: String = rows.iter().map(|[_, u, y]| format!("{u:.3}\t{:.5}\n", 0.8 - y)).collect();
    bench.write("log.txt", format!("u\ty\n{rows}"));
    let refused = bench.run(&["init", "log.txt"]);
    assert!(refused.code == Some(2) && refused.errors.contains("--period SECONDS"), "{}", refused.errors);
    let wrong = bench.run(&["init", "log.txt", "--period", "-0.01"]);
    assert!(wrong.code == Some(2) && wrong.errors.contains("above 0"), "{}", wrong.errors);
    let _ = bench.output(&["init", "log.txt", "--period", "0.01", "--position-scale", "-1000"]);
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    // The cart has 800 mm/s² per V.
    let gain = value(&config, &["plant", "gain_mm_per_s2_per_percent"]);
    let scale = value(&config, &["import", "duty_percent", "scale"]);
    assert!((gain * scale / 800.0 - 1.0).abs() < 0.3, "{gain} times {scale}");
}

#[test]
fn rows_that_share_the_stamps_of_a_coarse_clock_are_spread_between_them() {
    let bench = bare();
    let rows = cart();
    let stamped = rows.iter().map(|[t, u, y]| {
        let seconds = (t + 0.35).floor() as u32;
        format!("2025-05-15 22:{:02}:{:02},{u:.3},{y:.5}\n", 10 + seconds / 60, seconds % 60)
    });
    bench.write("log.csv", format!("Timestamp,voltage_V,position_m\n{}", stamped.collect::<String>()));
    let said = bench.output(&["init", "log.csv"]);
    assert!(said.contains("rows 0.01 s apart, spread between the stamps of a coarse clock"), "{said}");
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    assert_eq!(config["import"]["time_s"]["spread"].as_bool(), Some(true));
    names_the_friction(&bench.output(&["diagnose", "log.csv", "--config", "rig.toml", "--json"]));
    // Without the spread, the log says what to write.
    bench.write("raw.toml", bench.read("rig.toml").replace(", spread = true", ""));
    let raw = bench.run(&["diagnose", "log.csv", "--config", "raw.toml"]);
    assert!(raw.errors.contains("spread = true"), "{}", raw.errors);
}

#[test]
fn an_input_on_a_clock_of_its_own_is_held_between_its_values_and_is_that_of_the_positions_part_of_the_rig() {
    let bench = bare();
    let mut random = Random(5);
    let topics = cart().into_iter().map(|[t, u, y]| {
        let (hoist, sway) = (random.normal(), 0.1 * random.normal());
        format!("{t:.4},,,{sway:.4},{u:.3},\n{:.4},{hoist:.3},,,,\n{:.4},,1.2,,,{y:.5}\n", t + 0.001, t + 0.002)
    });
    let names =
        ["/hoist_voltage/data", "/cable_length/data", "/sway_angle/data", "/cart_voltage/data", "/cart_position/data"];
    bench.write("log.csv", format!("__time,{}\n{}", names.join(","), topics.collect::<String>()));
    let said = bench.output(&["init", "log.csv"]);
    assert!(said.contains("held where its cell is empty"), "{said}");
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    let import = &config["import"];
    assert_eq!(import["duty_percent"]["column"].as_str(), Some("/cart_voltage/data"), "{import}");
    assert_eq!(import["duty_percent"]["hold"].as_bool(), Some(true), "{import}");
    assert_eq!(import["position_mm"]["column"].as_str(), Some("/cart_position/data"), "{import}");
    names_the_friction(&bench.output(&["diagnose", "log.csv", "--config", "rig.toml", "--json"]));
    // Without it the log says what to write.
    bench.write("raw.toml", bench.read("rig.toml").replace(", hold = true", ""));
    let raw = bench.run(&["diagnose", "log.csv", "--config", "raw.toml"]);
    assert!(raw.errors.contains("hold = true"), "{}", raw.errors);
}

#[test]
fn of_two_columns_of_one_name_the_one_with_a_unit_is_read() {
    let bench = bare();
    let rows = cart().into_iter().map(|[t, u, y]| {
        let [ms, pwm, mm] = [1e3 * t, 255.0 / 12.0 * u, (1e3 * y).round()];
        format!("{ms:.0};{mm};{pwm:.0};{t:.2};{y:.5};{u:.3}\n")
    });
    bench.write("log.csv", format!("Time;Pos;PWM;Time(s);Pos(m);PWM(V)\n{}", rows.collect::<String>()));
    let said = bench.output(&["init", "log.csv"]);
    for line in ["`Time(s)`", "`Pos(m)`", "`PWM(V)`"] {
        assert!(said.lines().any(|found| found.starts_with(line) && found.contains('→')), "no {line} in {said}");
    }
}

/// A reading that follows 50 times the input as a plant of first order does, in ten of its steps.
fn motor(step_s: f64) -> Vec<[f64; 3]> {
    let (mut random, mut speed, mut u) = (Random(11), 0.0, 0.0);
    let row = |k: u32| {
        if k.is_multiple_of(40) {
            u = (200.0 * random.next()).round() - 100.0;
        }
        speed += (1.0 - (-step_s / (10.0 * step_s)).exp()) * (50.0 * u - speed);
        [step_s * f64::from(k), u, (speed + 20.0 * random.normal()).round()]
    };
    (0..600).map(row).collect()
}

#[test]
fn a_speed_among_columns_without_names_is_told_from_its_input_with_the_flag_to_give() {
    let bench = bare();
    let rows = motor(0.018).into_iter().map(|[t, u, speed]| format!("{u},{speed},{:.0}\n", 1e3 * t));
    bench.write("log.csv", rows.collect::<String>());
    let refused = bench.run(&["init", "log.csv"]).errors;
    for words in ["`column1` as the input and column2 as the position", "first order", "--speed"] {
        assert!(refused.contains(words), "no {words} in {refused}");
    }
    let said = bench.output(&["init", "log.csv", "--speed", "column2"]);
    // The range is that of the speed, not of its integral.
    let of_speed = said.lines().find(|line| line.starts_with("`column2`")).unwrap();
    let lowest: f64 = of_speed.split("as said; ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let speeds = bench
        .read("log.csv")
        .lines()
        .map(|line| line.split(',').nth(1).unwrap().parse().unwrap())
        .collect::<Vec<f64>>();
    assert_eq!(lowest, speeds.into_iter().fold(f64::INFINITY, f64::min), "{of_speed}");
    assert!(said.lines().any(|line| line.starts_with("`column1`") && line.contains("→ input")), "{said}");
}

#[test]
fn whole_seconds_are_no_milliseconds_though_their_steps_are_1() {
    let bench = bare();
    let rows = motor(1.0).into_iter().map(|[t, u, temperature]| format!("{t},{u},{temperature}\n"));
    bench.write("log.csv", format!("t,heater,temperature\n{}", rows.collect::<String>()));
    let refused = bench.run(&["init", "log.csv"]).errors;
    assert!(refused.contains("first order, with a time constant of 10."), "{refused}");
}

#[test]
fn a_time_that_goes_backwards_once_is_named_though_no_name_says_that_it_is_the_time() {
    let bench = bare();
    let mut rows = cart();
    rows.rotate_left(2000);
    let rows: String = rows.iter().map(|[t, u, y]| format!("{t:.2},{u:.3},{y:.5}\n")).collect();
    bench.write("log.csv", rows);
    let refused = bench.run(&["init", "log.csv"]);
    assert!(refused.errors.contains("`column1` goes backwards in line 4001"), "{}", refused.errors);
}

#[test]
fn a_servo_is_one_also_where_it_measures_a_current_that_its_position_does_not_answer() {
    let bench = bare();
    let mut random = Random(5);
    let log = std::fs::read_to_string(root().join("data/so101_servo/step_response.csv")).unwrap();
    let rows = log.lines().skip(1).map(|row| format!("{row},{:.3}\n", random.next()));
    bench.write("log.csv", format!("t_s,target pos (5),pos (5),current (5)\n{}", rows.collect::<String>()));
    let said = bench.output(&["init", "log.csv"]);
    assert!(said.contains("`target pos (5)` → input: a servo: its command minus its position"), "{said}");
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    assert_eq!(config["import"]["duty_percent"]["minus"].as_str(), Some("pos (5)"));
}

#[test]
fn a_heater_is_refused_as_of_first_order() {
    let mut random = Random(3);
    let (mut level, mut power, mut rows) = (20.0, 0.0, Vec::new());
    for k in 0..6000_u32 {
        if k % 500 == 0 {
            power = 100.0 * random.next();
        }
        rows.push([0.1 * f64::from(k), power, level + 0.1 * random.normal()]);
        level += 0.1 * (0.03 * power - (level - 20.0) / 30.0);
    }
    let bench = bare();
    bench.write("heater.csv", csv("t,heater,temperature", &rows));
    for command in ["init", "diagnose"] {
        let refused = bench.run(&[command, "heater.csv"]);
        assert_eq!(refused.code, Some(1), "{}", refused.errors);
        for words in ["heater.csv", "`heater`", "temperature", "first order", "second order"] {
            assert!(refused.errors.contains(words), "no {words} in {}", refused.errors);
        }
    }
    assert!(!bench.path("rig.toml").exists());
}

#[test]
fn a_speed_is_integrated_and_an_angle_is_read_as_a_length() {
    let bench = bare();
    let data = root().join("data");
    let config = |file: &str| {
        let log = data.join(file);
        let _ = bench.output(&["init", log.to_str().unwrap(), "--force"]);
        toml::from_str::<toml::Table>(&bench.read("rig.toml")).unwrap()
    };
    let init = |file: &str| config(file)["import"].clone();
    let hoop = init("hoop_motor/fixed_steps.csv");
    assert_eq!(hoop["position_mm"]["integrate"].as_bool(), Some(true), "{hoop}");
    assert_eq!(hoop["duty_percent"]["scale"].as_float(), Some(100.0), "{hoop}");
    let arm_config = config("quarter_drone/steps.csv");
    let arm = arm_config["import"].clone();
    assert_eq!(arm["position_mm"]["column"].as_str(), Some("angle_deg"), "{arm}");
    assert_eq!(arm["setpoint_mm"]["column"].as_str(), Some("ref_deg"), "{arm}");
    // A scale of 1 is not written.
    assert_eq!(arm["position_mm"].get("scale").map_or(Some(1.0), toml::Value::as_float), Some(1.0), "{arm}");
    let rig = arm_config["rig"].clone();
    assert_eq!((rig["position"].as_str(), rig["position_unit"].as_str()), (Some("angle"), Some("deg")), "{rig}");
    assert_eq!(bench.output(&["config", "check", "--config", "rig.toml"]).lines().count(), 1);
}

#[test]
fn a_flight_of_our_own_brings_its_config() {
    let bench = Bench::default();
    let _ = bench.output(&["simulate", "--duration", "40", "--log", "f.mcap"]);
    std::fs::remove_file(bench.path("config.toml")).unwrap();
    let said = bench.output(&["init", "f.mcap"]);
    assert!(said.starts_with("f.mcap holds the config that it was flown with\n"), "{said}");
    let ran = bench.run(&["diagnose", "f.mcap", "--json"]);
    assert!(ran.output.contains("\"verdict\":\"no_gap\"") && ran.errors.contains("rig.toml is used"), "{}", ran.errors);
}

#[test]
fn units_are_written_as_they_are_usual_and_a_column_without_a_name_is_told_by_its_place() {
    let bench = bare();
    let rows = cart().into_iter().enumerate().map(|(k, [t, u, y])| format!("{k},{t:.2},{u:.3},{y:.5}\n"));
    let rows: String = rows.collect();
    for (head, said) in [
        (",t,u,y", &["; 1 is read as 10.0 %", "; 1 is read as 1000.0 mm", "not used: column 1 (without a name)"][..]),
        ("k,t,u [V],y [m]", &["; 1 V is read as 10.0 %", "; 1 m is read as 1000.0 mm", "not used: `k`"][..]),
    ] {
        bench.write("a.csv", format!("{head}\n{rows}"));
        let lines = bench.output(&["init", "a.csv", "--out", "a.toml", "--force"]);
        for words in said {
            assert!(lines.contains(words), "{words}: {lines}");
        }
    }
}
