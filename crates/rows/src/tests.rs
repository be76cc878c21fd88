//! Tables: ours, foreign ones, and invalid ones.

use crate::{Column, Import, RowsError, recording};
use diagnose::Recording;
use proptest::prelude::*;

fn parse(text: &str) -> Result<Recording, RowsError> {
    recording("rig.csv", text.as_bytes(), &Import::default())
}

fn complaint(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

/// A valid table of 40 rows in our columns.
fn table() -> Vec<String> {
    let rows = (0..40).map(|k| format!("{:.2},300,0.5,21.5,{}", 0.02 * f64::from(k), 200 + k));
    [String::from("time_s,setpoint_mm,control_percent,duty_percent,position_mm")].into_iter().chain(rows).collect()
}

/// The table with one line replaced, lines counting from 1 as in messages.
fn with_line(line: usize, text: &str) -> String {
    let mut lines = table();
    lines[line - 1] = text.into();
    lines.join("\n")
}

#[test]
fn time_duty_and_position_are_enough() {
    let rows = (0..30).map(|k| format!("{k},150.5,\n{k}.5,-3,{k}\n"));
    let log = parse(&format!("time_s,duty_percent,position_mm\n{}", rows.collect::<String>())).unwrap();
    let samples = log.samples();
    assert_eq!((samples[0].duty_percent, samples[0].position_mm, samples[0].setpoint_mm), (150.5, None, None));
    assert_eq!((samples[3].duty_percent, samples[3].position_mm), (-3.0, Some(1.0)));
    assert!(!log.has_fan_speed() && !log.has_second_position());
}

#[test]
fn a_mark_windows_line_ends_spaces_and_empty_lines_do_no_harm() {
    let plain = parse(&table().join("\n")).unwrap();
    let windows = format!("\u{feff}{}\r\n\r\n \r\n,,,,\r\n", table().join("\r\n"));
    assert_eq!(parse(&windows).unwrap(), plain);
    assert_eq!(parse(&table().join("\n").replace(',', " ; ")).unwrap(), plain);
    assert_eq!(parse(&table().join("\n").replace(',', "\t")).unwrap(), plain);
}

#[test]
fn a_row_that_is_written_twice_is_one_measurement_and_two_readings_at_one_time_are_two() {
    let plain = parse(&table().join("\n")).unwrap();
    let (header, rows) = (table()[0].clone(), table()[1..].to_vec());
    let doubled = |rows: &[String]| std::iter::once(&header).chain(rows).cloned().collect::<Vec<_>>().join("\n");
    let each_twice: Vec<String> = rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
    assert_eq!(parse(&doubled(&each_twice)).unwrap(), plain);
    let again = |row: &String| row.rsplit_once(',').map(|(rest, _)| format!("{rest},250")).unwrap();
    let two_readings: Vec<String> = rows.iter().flat_map(|row| [row.clone(), again(row)]).collect();
    assert_eq!(parse(&doubled(&two_readings)).unwrap().samples().len(), 80);
    // Without a time of its own, a row like the one before is a moment later.
    let import = Import { time_s: Column { scale: 0.02, ..Column::named("row") }, ..Import::default() };
    let still = format!("duty_percent,position_mm\n{}", "21.5,300\n".repeat(40));
    assert_eq!(recording("rig.csv", still.as_bytes(), &import).unwrap().samples().len(), 40);
}

#[test]
fn a_wrong_cell_is_named_by_line_column_and_value() {
    for (cell, words) in
        [("abc", "`abc` is no number"), ("21,5", "cells"), ("inf", "not finite"), ("-inf", "not finite")]
    {
        let said = complaint(&with_line(7, &format!("0.10,300,0.5,{cell},205")));
        assert!(said.starts_with("rig.csv, line 7") && said.contains(words), "{said}");
    }
    let said = complaint(&with_line(7, "0.10,300,0.5,,205"));
    assert!(said.starts_with("rig.csv, line 7, column `duty_percent`: the cell holds no reading"), "{said}");
    let decimal_comma = with_line(7, "0.10,300,0.5,x,205").replace(',', ";").replace('x', "21,5");
    assert!(complaint(&decimal_comma).contains("`21,5` is no number; write it with a decimal point"));
}

#[test]
fn a_cell_of_nan_is_no_reading_wherever_an_empty_one_is_none() {
    let empty = parse(&with_line(7, "0.10,,,21.5,")).unwrap();
    assert_eq!(empty.samples()[5].position_mm, None);
    for nan in ["NaN", "nan", "-nan", "NAN"] {
        assert_eq!(parse(&with_line(7, &format!("0.10,{nan},{nan},21.5,{nan}"))).unwrap(), empty, "{nan}");
        let said = complaint(&with_line(7, &format!("0.10,300,0.5,{nan},205")));
        assert!(said.starts_with("rig.csv, line 7, column `duty_percent`: the cell holds no reading"), "{said}");
    }
}

#[test]
fn a_held_input_and_what_is_subtracted_repeat_their_last_values_and_rows_without_a_new_value_are_left_out() {
    let command = Column { minus: Some("offset".into()), hold: true, ..Column::named("u") };
    let import = Import { duty_percent: command, ..Import::default() };
    // At 0.01 s the input is not known; at 0.04 s there is the other topic alone.
    let whole = (5..60).map(|k| format!("{:.2},{},,{}\n", 0.01 * f64::from(k), 20 + k, 300 + k));
    let rows =
        "0.00,,2,\n0.01,,,300\n0.02,30,,\n0.03,,,301\n0.04,,1,\n0.045,,,302\n".to_owned() + &whole.collect::<String>();
    let found = recording("rig.csv", format!("time_s,u,offset,position_mm\n{rows}").as_bytes(), &import).unwrap();
    let first = found.samples()[..4].iter().map(|row| (row.time_s, row.duty_percent, row.position_mm));
    let expected =
        [(0.02, 28.0, None), (0.03, 28.0, Some(301.0)), (0.045, 29.0, Some(302.0)), (0.05, 24.0, Some(305.0))];
    assert_eq!(first.collect::<Vec<_>>(), expected);
}

#[test]
fn a_wrong_cell_of_the_column_that_is_subtracted_is_named_by_that_column() {
    let error = Column { minus: Some("position_mm".into()), ..Column::named("setpoint_mm") };
    let import = Import { duty_percent: error, ..Import::default() };
    for cell in ["abc", "inf"] {
        let text = with_line(7, &format!("0.10,300,0.5,21.5,{cell}"));
        let said = recording("rig.csv", text.as_bytes(), &import).unwrap_err().to_string();
        assert!(said.contains("line 7, column `position_mm`") && said.contains(&format!("`{cell}`")), "{said}");
    }
}

#[test]
fn a_first_row_without_a_reading_is_a_row_and_no_header() {
    let rows: String = (1..60).map(|k| format!("{:.2},50,{}\n", 0.02 * f64::from(k), 100 + k)).collect();
    let sheet = crate::sheet("rig.csv", format!("0.00,50,\n{rows}").as_bytes()).unwrap();
    assert_eq!(
        sheet.columns.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(),
        ["column1", "column2", "column3"]
    );
    assert_eq!((sheet.columns[0].values.len(), sheet.columns[2].values[0]), (60, None));
}

#[test]
fn a_line_of_an_instrument_above_a_table_is_no_config_and_two_keys_are() {
    let table = table().join("\n");
    assert_eq!(parse(&format!("Model = TDS2024\n{table}")).unwrap(), parse(&table).unwrap());
    for config in ["a_key = 1\nanother = 2\n", "a_key = 1\n[table]\n", "# words\n[table]\na = 1\n"] {
        assert!(complaint(config).contains("a config (TOML)"), "{}", complaint(config));
    }
}

#[test]
fn text_of_a_file_is_shown_short_and_cannot_act_on_a_terminal() {
    let cell = format!("\u{1b}]0;title\u{7}\u{202e}{}", "x".repeat(10_000_000));
    let said = complaint(&with_line(7, &format!("0.10,300,0.5,{cell},205")));
    assert!(said.contains("`\\u001b]0;title\\u0007\\u202ex") && said.contains("x…`"), "{said}");
    let header: String = (0..200_000).map(|k| format!(",\u{1b}[31m{k}")).collect();
    let wide = complaint(&format!("time_s{header}\n0{}\n", ",0".repeat(200_000)));
    assert!(wide.contains("`\\u001b[31m18` and 199981 more"), "{wide}");
    for message in [said, wide] {
        assert!(message.chars().count() < 1000 && !message.chars().any(char::is_control), "{message}");
    }
    assert_eq!(crate::printable("a\tb\n\r\0"), "a\tb\n\\u000d\\u0000");
}

#[test]
fn lines_are_counted_with_the_empty_ones() {
    let said = complaint(&with_line(7, "\n\r\n0.10,300,0.5,abc,205"));
    assert!(said.starts_with("rig.csv, line 9,"), "{said}");
}

#[test]
fn a_ragged_row_is_named_with_its_cells() {
    let said = complaint(&with_line(12, "0.20,300,0.5"));
    assert!(said.starts_with("rig.csv, line 12: 3 cells where the header has 5"), "{said}");
}

#[test]
fn time_that_goes_backwards_is_named_with_both_lines() {
    let said = complaint(&with_line(20, "0.01,300,0.5,21.5,205"));
    assert!(said.starts_with("rig.csv, line 20: time goes backwards, from 0.34 s in line 19 to 0.01 s"), "{said}");
}

#[test]
fn a_missing_column_is_answered_with_those_that_are_there_and_with_import() {
    let said = complaint("time_s,speed,duty_percent\n0,1,2\n");
    assert!(said.contains("no column `position_mm`") && said.contains("`time_s`, `speed`, `duty_percent`"), "{said}");
    assert!(said.contains("[import] position_mm = {"), "{said}");
    let said = complaint("time_s,time_s,duty_percent,position_mm\n0,0,1,2\n");
    assert!(said.contains("2 columns are called `time_s`"), "{said}");
}

#[test]
fn empty_files_are_told_apart() {
    assert!(matches!(parse("").unwrap_err(), RowsError::Empty { .. }));
    assert!(matches!(parse("\u{feff} \n\r\n").unwrap_err(), RowsError::Empty { .. }));
    assert!(matches!(parse(&table()[0]).unwrap_err(), RowsError::HeaderOnly { .. }));
    let said = complaint(&table()[..11].join("\n"));
    assert!(said.starts_with("rig.csv: it has 10 readings, too few"), "{said}");
}

#[test]
fn bytes_that_are_no_text_are_named_by_line() {
    let error = recording("rig.csv", b"time_s,position_mm\n0,\xff\0\n", &Import::default()).unwrap_err();
    assert!(error.to_string().starts_with("rig.csv, line 2: byte 22 is no text"), "{error}");
}

#[test]
fn a_row_that_is_not_fresh_has_no_reading() {
    let rows = (0..60).map(|k| format!("{k},20,{k},{}\n", if k % 2 == 0 { "True" } else { "0" }));
    let log = parse(&format!("time_s,duty_percent,position_mm,fresh\n{}", rows.collect::<String>())).unwrap();
    assert_eq!(log.samples()[2].position_mm, Some(2.0));
    assert_eq!(log.samples()[3].position_mm, None);
    let said = complaint("time_s,duty_percent,position_mm,fresh\n0,20,1,maybe\n");
    assert!(said.contains("column `fresh`: `maybe` is neither"), "{said}");
}

#[test]
fn import_maps_scales_and_offsets() {
    let import: Import = toml::from_str(
        r#"time_s = { column = "t_ms", scale = 0.001 }
        position_mm = { column = "angle", scale = -2.0, offset = 100.0 }
        duty_percent = { column = "u" }
        fan_rpm = { column = "tacho", scale = 60.0 }"#,
    )
    .unwrap();
    let rows: String = (0..30).map(|k| format!("{},{},7,{k}\n", 20 * k, k)).collect();
    let log = recording("rig.csv", format!("t_ms,angle,u,tacho\n{rows}").as_bytes(), &import);
    let log = log.unwrap();
    let sample = log.samples()[10];
    assert!((sample.time_s - 0.2).abs() < 1e-12);
    assert_eq!((sample.position_mm, sample.duty_percent, sample.fan_rpm), (Some(80.0), 7.0, Some(600.0)));
    let missing = Import { position2_mm: Some(Column::named("second")), ..import };
    let said = recording("rig.csv", format!("t_ms,angle,u,tacho\n{rows}").as_bytes(), &missing);
    assert!(said.unwrap_err().to_string().contains("no column `second` for position2_mm"));
}

#[test]
fn a_speed_is_integrated_to_the_parabola_it_belongs_to() {
    // v = 3t is integrated exactly by trapezoids: x = 5 + 2·3t²/2, also across a missing reading.
    let speed = Column { scale: 2.0, offset: 5.0, integrate: true, ..Column::named("v") };
    let import = Import { position_mm: speed, ..Import::default() };
    let time_s = |k: i32| 0.1 * f64::from(k) + 0.003 * f64::from(k % 3);
    let cell = |k: i32| if k == 7 { String::new() } else { (3.0 * time_s(k)).to_string() };
    let rows: String = (0..40).map(|k| format!("{},20,{}\n", time_s(k), cell(k))).collect();
    let text = format!("time_s,duty_percent,v\n{rows}");
    let log = recording("rig.csv", text.as_bytes(), &import).unwrap();
    for (k, sample) in log.samples().iter().enumerate() {
        match sample.position_mm {
            Some(x) if k != 7 => assert!((x - 5.0 - 3.0 * sample.time_s.powi(2)).abs() < 1e-9, "row {k}: {x}"),
            other => assert!(k == 7 && other.is_none(), "row {k}: {other:?}"),
        }
    }
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "[0-9a-z,;\t\"\r\n. \u{feff}-]{0,200}") {
        let _ = parse(&text);
        let _ = parse(&format!("time_s,duty_percent,position_mm\n{text}"));
    }
}
