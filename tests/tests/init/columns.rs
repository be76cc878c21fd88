//! Which column is the time, the input and the position, and in which unit.

use super::{Random, bare, cart, csv, names_the_friction, value};
use system_tests::Bench;

/// The table `[import]` that `init` wrote.
fn import(bench: &Bench) -> toml::Value {
    let config: toml::Table = toml::from_str(&bench.read("rig.toml")).unwrap();
    config["import"].clone()
}

/// Checks that an error asks for this key of `[import]` where the config lacks it.
fn is_asked_for(bench: &Bench, key: &str) {
    bench.write("raw.toml", bench.read("rig.toml").replace(&format!(", {key}"), ""));
    let raw = bench.run(&["diagnose", "log.csv", "--config", "raw.toml"]);
    assert!(raw.errors.contains(key), "{}", raw.errors);
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
    // The speed and the control error beside them fit better than any input, and drive nothing.
    let derived: String = rows
        .windows(11)
        .map(|around| {
            let ([t, u, y], speed) = (around[5], (around[10][2] - around[0][2]) / 0.1);
            format!("{t:.2},{speed:.4},{u:.3},{y:.5},{:.5}\n", 0.4 - y)
        })
        .collect();
    let found = import(&format!("a,b,c,d,e\n{derived}"), &[]);
    assert_eq!(three(&found), ["a", "c", "d"]);
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
fn a_commanded_position_is_the_setpoint_beside_the_one_that_is_read() {
    let bench = bare();
    let rows: String =
        cart().iter().map(|[t, u, y]| format!("{t:.3},{},{y:.5},{u:.3}\n", f64::from(*t > 3.0))).collect();
    for read in ["Encoder 1 Pos", "arm_m"] {
        bench.write("log.csv", format!("Time,Commanded Pos,{read},Control Effort\n{rows}"));
        let found = bench.output(&["init", "log.csv", "--force"]);
        let role = |column: &str| found.lines().find(|line| line.starts_with(&format!("`{column}`"))).unwrap_or("");
        assert!(role(read).contains("→ position"), "{found}");
        assert!(role("Commanded Pos").contains("→ setpoint"), "{found}");
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
    assert_eq!(import(&bench)["time_s"]["spread"].as_bool(), Some(true));
    names_the_friction(&bench.output(&["diagnose", "log.csv", "--config", "rig.toml", "--json"]));
    is_asked_for(&bench, "spread = true");
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
    let import = import(&bench);
    assert_eq!(import["duty_percent"]["column"].as_str(), Some("/cart_voltage/data"), "{import}");
    assert_eq!(import["duty_percent"]["hold"].as_bool(), Some(true), "{import}");
    assert_eq!(import["position_mm"]["column"].as_str(), Some("/cart_position/data"), "{import}");
    names_the_friction(&bench.output(&["diagnose", "log.csv", "--config", "rig.toml", "--json"]));
    is_asked_for(&bench, "hold = true");
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

/// A reading of first order: its static gain is 50, its time constant ten steps.
fn first_order(step_s: f64) -> Vec<[f64; 3]> {
    let (mut random, mut speed, mut u) = (Random(11), 0.0, 0.0);
    let row = |k: u32| {
        if k.is_multiple_of(40) {
            u = (200.0 * random.next()).round() - 100.0;
        }
        speed += (1.0 - (-0.1_f64).exp()) * (50.0 * u - speed);
        [step_s * f64::from(k), u, (speed + 20.0 * random.normal()).round()]
    };
    (0..600).map(row).collect()
}

#[test]
fn a_speed_among_columns_without_names_is_told_from_its_input_with_the_flag_to_give() {
    let bench = bare();
    let rows = first_order(0.018).into_iter().map(|[t, u, speed]| format!("{u},{speed},{:.0}\n", 1e3 * t));
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
    let rows = first_order(1.0).into_iter().map(|[t, u, temperature]| format!("{t},{u},{temperature}\n"));
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
