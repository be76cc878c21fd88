//! From somebody's CSV to a diagnosis without a config: what is guessed, what is asked, what is refused.

#[path = "init/columns.rs"]
mod columns;

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
    // A setpoint that is said is no input, whatever its name.
    bench.write("control.csv", log.replacen("t_s,command0_rad,position0_rad", "t_s,control,angle", 1));
    let said = bench.output(&["init", "control.csv", "--out", "control.toml", "--setpoint", "control"]);
    assert!(said.contains("`control`") && said.contains("→ input: a servo: its command minus its position"), "{said}");
    // Where the command is said to be the input, the message names the columns that are left.
    let refused = bench.run(&["init", "log.csv", "--out", "other.toml", "--input", "target pos (5)"]);
    assert!(refused.code == Some(1) && refused.errors.contains("as a servo follows"), "{}", refused.errors);
    assert!(refused.errors.contains("not used: `current (5)`; other columns are chosen with"), "{}", refused.errors);
}

#[test]
fn numbers_that_forecast_better_are_taken_before_those_of_the_greatest_likelihood() {
    let bench = bare();
    bench.write("log.csv", std::fs::read_to_string(root().join("data/quarter_drone/staircase.csv")).unwrap());
    let _ = bench.output(&["init", "log.csv"]);
    assert!(bench.read("rig.toml").contains("# fitted to forecasts of 1 to 3 s"), "{}", bench.read("rig.toml"));
    // With the numbers of the greatest likelihood the forecasts of 1 s are worse than those of an angle that stays put.
    let said = bench.output(&["replay", "log.csv", "--config", "rig.toml"]);
    assert!(said.contains("1 s ahead the error of the model is") && !said.contains("is of no use"), "{said}");
}

/// A loop that steers a cart to a setpoint: time, input, position, setpoint.
fn steered() -> Vec<[f64; 4]> {
    let mut random = Random(8);
    let (mut rows, mut y, mut v, mut r) = (Vec::new(), 300.0, 0.0, 300.0);
    for k in 0..3000_u32 {
        if k % 150 == 0 {
            r = 100.0 + 400.0 * random.next();
        }
        let u = 0.02 * (r - y) - 0.01 * v + 3.0 * (random.next() - 0.5);
        for _ in 0..20 {
            v += 1e-3 * (300.0 * u - 1.5 * v);
            y += 1e-3 * v;
        }
        rows.push([f64::from(k) * 0.02, u, y + random.next() - 0.5, r]);
    }
    rows
}

#[test]
fn an_input_with_an_unknown_name_is_found_beside_a_setpoint_and_is_no_servo() {
    let bench = bare();
    let rows = steered().into_iter().map(|[t, u, y, r]| format!("{t:.2},{u:.4},{y:.2},{r:.1}\n"));
    let rows: String = rows.collect();
    bench.write("boat.csv", format!("t,helm,depth_mm,depth_ref_mm\n{rows}"));
    let said = bench.output(&["init", "boat.csv"]);
    let input = said.lines().find(|line| line.starts_with("`helm`")).unwrap_or_default();
    assert!(input.contains("→ input: of the columns without a telling name") && !said.contains("servo"), "{said}");
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    assert_eq!(config["import"]["setpoint_mm"]["column"].as_str(), Some("depth_ref_mm"), "{config}");
}

#[test]
fn the_place_of_gravity_is_told_in_the_unit_of_the_log() {
    let bench = bare();
    bench.write("log.csv", std::fs::read_to_string(root().join("data/dfki_pendulum/ddp.csv")).unwrap());
    let said = bench.output(&["init", "log.csv"]);
    let place = said.split("gravity of ").nth(1).and_then(|rest| rest.split("about ").nth(1)).unwrap();
    let (number, unit) = place.split(';').next().and_then(|place| place.split_once(' ')).unwrap();
    // The pendulum hangs within 3 degrees of 0, and 1 rad is read as 1000 mm.
    assert!(unit == "rad" && number.parse::<f64>().unwrap().abs() < 0.05, "{said}");
}

/// A stage that sticks, steered to steps by a PD controller: time, input, position, setpoint.
fn sticking() -> Vec<[f64; 4]> {
    let mut random = Random(8);
    let (mut rows, mut y, mut v, mut r) = (Vec::new(), 0.0, 0.0_f64, 0.0);
    for k in 0..3000_u32 {
        if k % 300 == 0 {
            r = 60.0 * (random.next() - 0.5);
        }
        let u = (0.12 * (r - y) - 0.02 * v).clamp(-8.0, 8.0);
        for _ in 0..20 {
            let force = 600.0 * u - 3.0 * v;
            let friction = 300.0 * if v == 0.0 { force.signum() } else { v.signum() };
            let before = v;
            v += if v == 0.0 && force.abs() < 300.0 { 0.0 } else { 5e-4 * (force - friction) };
            v = if before * v < 0.0 { 0.0 } else { v };
            y += 5e-4 * v;
        }
        rows.push([f64::from(k) * 0.01, u, y + 0.01 * random.normal(), r]);
    }
    rows
}

#[test]
fn a_column_with_the_unit_of_a_drive_is_the_input_whatever_friction_leaves_of_its_effect() {
    let bench = bare();
    let rows: String = sticking()
        .into_iter()
        .map(|[t, u, y, r]| format!("{t:.2},{u:.4},12.{:.0},{y:.3},{r:.1}\n", 10.0 * u.abs()))
        .collect();
    bench.write("stage.csv", format!("time_s,coil_V,battery_V,stage_mm,setpoint_mm\n{rows}"));
    let said = bench.output(&["init", "stage.csv"]);
    let input = said.lines().find(|line| line.starts_with("`coil_V`")).unwrap_or_default();
    assert!(input.contains("→ input: by its unit") && !said.contains("servo"), "{said}");
}

#[test]
fn times_in_milliseconds_under_a_name_in_seconds_are_said_with_a_flag_that_mends_them() {
    let bench = bare();
    let rows: String = steered().into_iter().map(|[t, u, y, _]| format!("{:.0},{u:.4},{y:.2}\n", 1e3 * t)).collect();
    bench.write("boat.csv", format!("time_s,u,y\n{rows}"));
    let refused = bench.run(&["init", "boat.csv"]);
    assert!(refused.code == Some(1) && refused.errors.contains("--time-scale 0.001"), "{}", refused.errors);
    let _ = bench.output(&["init", "boat.csv", "--time-scale", "0.001"]);
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    assert_eq!(config["import"]["time_s"]["scale"].as_float(), Some(0.001), "{config}");
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
