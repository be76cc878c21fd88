//! How other programs write a CSV, and files of theirs that are none.

use crate::{Column, Import, RowsError, recording, recording_and_loss, sheet};
use diagnose::Recording;

/// Rows of time, duty and position that every dialect here holds.
fn numbers() -> impl Iterator<Item = [f64; 3]> {
    (0..40).map(|k| [0.25 * f64::from(k), 21.5, 200.0 + 0.5 * f64::from(k)])
}

/// The rows in a dialect.
fn table(header: &str, separator: &str, write: impl Fn(f64) -> String) -> String {
    let rows = numbers().map(|row| row.map(&write).join(separator) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}

fn plain() -> String {
    table("time_s,duty_percent,position_mm", ",", |value| value.to_string())
}

/// A line as Arduino's serial monitor writes it.
fn arrived((at, line): (usize, &str)) -> String {
    format!("12:03:{:02}.{:03} -> {line}\n", at / 4, 250 * (at % 4))
}

/// A row as Arduino's plotter wants it.
fn labelled(row: &str, separator: &str) -> String {
    let names = ["time_s", "duty_percent", "position_mm"];
    let cells: Vec<String> = row.split(',').zip(names).map(|(cell, name)| format!("{name}:{cell}")).collect();
    cells.join(separator)
}

fn read(bytes: &[u8]) -> Result<Recording, RowsError> {
    recording("rig.csv", bytes, &Import::default())
}

#[test]
fn every_dialect_reads_as_the_plain_table() {
    let expected = read(plain().as_bytes()).unwrap();
    let german = table("time_s;duty_percent;position_mm", ";", |value| value.to_string().replace('.', ","));
    let text = |value: f64| value.to_string();
    for (dialect, table) in [
        ("decimal comma", german.clone()),
        ("a spreadsheet's first line", format!("sep=;\r\n{}", german.replace('\n', "\r\n"))),
        ("comments", plain().replace("\n5,", "\n# a mark\n5,") + "# the end\n"),
        ("comments before the header", format!("% rig 7\n// monday\n{}", plain())),
        ("a commented header", format!("# rig 7\n# {}", plain())),
        ("a row of units", plain().replacen('\n', "\ns,%,mm\n", 1)),
        ("spaces", table("time_s  duty_percent position_mm", "   ", text)),
        ("a commented header with spaces", table("# time_s duty_percent position_mm", " ", text)),
        ("lines above the header", format!("Motor control v1.2\nrate,100\n\n{}", plain())),
        ("timestamps of Arduino", plain().lines().enumerate().map(arrived).collect()),
        (
            "timestamps of PlatformIO",
            plain().lines().enumerate().map(|line| arrived(line).replace("->", ">")).collect(),
        ),
        ("labels", plain().lines().skip(1).map(|row| labelled(row, ",") + "\n").collect()),
        ("labels and spaces", plain().lines().skip(1).map(|row| labelled(row, "  ") + "\n").collect()),
        (
            "quoted cells with decimal commas",
            table("time_s,duty_percent,position_mm", ",", |value| {
                format!("\"{}\"", format!("{value:.3}").replace('.', ","))
            }),
        ),
        ("spaces before each row", table("time_s duty_percent position_mm", " ", text).replace('\n', "\n  ")),
    ] {
        assert_eq!(read(table.as_bytes()).unwrap_or_else(|error| panic!("{dialect}: {error}")), expected, "{dialect}");
    }
    let little: Vec<u8> = format!("\u{feff}{german}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = format!("\u{feff}{german}").encode_utf16().flat_map(u16::to_be_bytes).collect();
    assert_eq!((read(&little).unwrap(), read(&big).unwrap()), (expected.clone(), expected.clone()));
    // A column that nobody asks for has a letter of Windows-1252 in its name.
    let rows: String = plain().lines().skip(1).map(|row| format!("{row},0\n")).collect();
    let western = format!("time_s,duty_percent,position_mm,Höhe\n{rows}");
    let western = encoding_rs::WINDOWS_1252.encode(&western).0;
    assert_eq!(read(&western).unwrap(), expected);
}

#[test]
fn moments_are_read_as_seconds() {
    let row = |k: u32| format!("2026-03-01T12:{:02}:{:02}.500+01:00,21.5,{k}\n", k / 60, k % 60);
    let text = format!("time_s,duty_percent,position_mm\n{}", (0..90).map(row).collect::<String>());
    let log = read(text.as_bytes()).unwrap();
    assert_eq!(log.duration_s(), 89.0);
}

#[test]
fn words_for_no_number_are_no_reading() {
    for word in ["NaN", "NA", "null", "None", "-", "#N/A"] {
        let text = plain().replace(",205\n", &format!(",{word}\n"));
        let log = read(text.as_bytes()).unwrap();
        assert_eq!(log.readings(), 39, "{word}");
    }
}

#[test]
fn columns_without_a_header_have_numbers_for_names() {
    let import = Import {
        time_s: Column::named("column1"),
        duty_percent: Column::named("column2"),
        position_mm: Column::named("column3"),
        ..Import::default()
    };
    let text = plain().split_once('\n').unwrap().1.to_owned();
    assert_eq!(recording("rig.csv", text.as_bytes(), &import).unwrap(), read(plain().as_bytes()).unwrap());
    let said = read(text.as_bytes()).unwrap_err().to_string();
    assert!(said.contains("`column1`, `column2`, `column3`"), "{said}");
}

#[test]
fn timestamps_of_a_serial_monitor_are_a_column_of_their_own() {
    let import = Import { time_s: Column::named("stamp"), ..Import::default() };
    let rows: String = plain().lines().enumerate().map(arrived).collect();
    let log = recording("rig.txt", rows.as_bytes(), &import).unwrap();
    assert!((log.samples()[39].time_s - log.samples()[0].time_s - 9.75).abs() < 1e-6);
    // A line is cut inside its timestamp.
    let said = recording("rig.txt", rows.replace("12:03:05.000 -> ", "12:0").as_bytes(), &import).unwrap_err();
    assert!(said.to_string().contains("rig.txt, line 21"), "{said}");
}

#[test]
fn a_table_without_a_time_has_the_number_of_the_row() {
    let import = Import { time_s: Column { scale: 0.25, ..Column::named("row") }, ..Import::default() };
    let rows: String = plain().lines().map(|line| line.split_once(',').unwrap().1.to_owned() + "\n").collect();
    assert_eq!(recording("rig.csv", rows.as_bytes(), &import).unwrap(), read(plain().as_bytes()).unwrap());
    // A column of this name comes first.
    let own = plain().replace("time_s", "row");
    let import = Import { time_s: Column::named("row"), ..Import::default() };
    assert_eq!(recording("rig.csv", own.as_bytes(), &import).unwrap(), read(plain().as_bytes()).unwrap());
}

#[test]
fn a_row_with_other_labels_or_a_header_of_another_width_is_no_data() {
    let rows: String = plain().lines().skip(1).map(|row| labelled(row, ",") + "\n").collect();
    let said = read(rows.replace("duty_percent:21.5,position_mm:205\n", "duty:21.5,position_mm:205\n").as_bytes());
    assert!(said.unwrap_err().to_string().contains("line 11"));
    let said = read(plain().replace("time_s,", "").as_bytes()).unwrap_err();
    assert!(matches!(said, RowsError::HeaderMismatch { line: 1, expected: 2, found: 3, .. }), "{said}");
}

#[test]
fn the_difference_of_two_columns_is_an_input() {
    let rows: String = (0..40).map(|k| format!("{k},{},{}\n", 3 * k, k)).collect();
    let error = Column { minus: Some("position_mm".into()), scale: 2.0, ..Column::named("command") };
    let import = Import { duty_percent: error, ..Import::default() };
    let log = recording("rig.csv", format!("time_s,command,position_mm\n{rows}").as_bytes(), &import).unwrap();
    assert_eq!(log.samples()[10].duty_percent, 40.0);
    let time = Import { time_s: Column { minus: Some("x".into()), ..Column::named("t") }, ..Import::default() };
    assert!(time.check().unwrap_err().to_string().starts_with("[import] time_s: minus = \"x\";"));
}

#[test]
fn files_of_other_formats_are_refused_by_their_name_and_with_the_way_to_a_csv() {
    for (bytes, words) in [
        (&b"MATLAB 5.0 MAT-file, Platform: GLNXA64"[..], "a MATLAB file"),
        (b"\0\0\0\0\x02\0\0\0\x01\0\0\0\0\0\0\0\x02\0\0\0t\0", "a MATLAB file"),
        (b"\0\0\x03\xe8\0\0\0\x02\0\0\0\x01\0\0\0\0\0\0\0\x02t\0", "a MATLAB file"),
        (b"\x89HDF\r\n\x1a\n\0\0", "HDF5"),
        (b"PK\x03\x04\x14", ".xlsx"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0", ".xls"),
        (b"PAR1\x15\x04", "Parquet"),
        (b"\x93NUMPY\x01", "numpy"),
        (b"#ROSBAG V2.0\n", "ROS 1"),
        (b"SQLite format 3\0", "ROS 2"),
        (b"ULog\x01\x12\x35\x01", "ULog"),
        (b"TDSm\x0e", "TDMS"),
        (b"%PDF-1.7", "PDF"),
        (b"{\"a\": 1}", "JSON"),
        (b"[{\"t\": 1}]", "JSON"),
        (b" [\n  [0.0, 21.5]]", "JSON"),
        (b"<svg xmlns=\"x\">", "SVG"),
        (b"# my rig\n\n[plant]\ndrag_per_s = 1\n", "TOML"),
        (b"[[steps]]\nat_s = 1\n", "TOML"),
        (b"title = \"steps\"\n", "TOML"),
    ] {
        let said = read(bytes).unwrap_err().to_string();
        assert!(said.starts_with("rig.csv is ") && said.contains(words) && said.contains("; "), "{words}: {said}");
    }
}

#[test]
fn a_sheet_holds_every_column_of_numbers_and_its_unit() {
    let found = sheet("rig.csv", b"t;u;note;y\ns;V;;m\n0;1,5;a;0,1\n1;;b;NaN\n").unwrap();
    let names: Vec<&str> = found.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!((names, found.rows), (vec!["t", "u", "note", "y"], 2));
    let values: Vec<_> = found.columns.iter().map(|column| column.values.clone()).collect();
    assert_eq!(values, [vec![Some(0.0), Some(1.0)], vec![Some(1.5), None], vec![], vec![Some(0.1), None]]);
    assert_eq!((found.columns[3].unit.as_deref(), found.columns[2].unit.as_deref()), (Some("m"), None));
}

#[test]
fn the_names_of_columns_stand_in_a_comment_also_behind_a_label_and_above_other_comments() {
    for text in [
        "# levitator\n# 2025-12-17T20:59\n# Columns: t u y\n#\n0\t1\t2\n0.1\t1\t2\n",
        "# t u y\n0 1 2\n0.1 1 2\n",
        "# log of a step\n# columns: t, u, y\n0,1,2\n0.1,1,2\n",
    ] {
        let found = sheet("rig.txt", text.as_bytes()).unwrap();
        let names: Vec<&str> = found.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!((names.as_slice(), found.rows), (&["t", "u", "y"][..], 2), "{text}");
    }
}

#[test]
fn names_with_single_spaces_within_them_stand_two_spaces_apart() {
    for text in ["Time (s)   arm angle (deg)  u\n0\t1\t2\n0.1\t1\t2\n", "t of run  y 1   u\r\n0 1 2\r\n0.1 1 2\r\n"] {
        let found = sheet("rig.txt", text.as_bytes()).unwrap();
        assert_eq!((found.columns.len(), found.rows, found.columns[2].values[1]), (3, 2, Some(2.0)), "{text}");
        assert!(found.columns[1].name.contains(' '), "{text}: {:?}", found.columns[1]);
    }
}

#[test]
fn half_a_row_at_the_end_of_a_file_is_left_out_and_said() {
    let cut = plain() + "10,21.5";
    let (recording, loss) = recording_and_loss("rig.csv", cut.as_bytes(), &Import::default()).unwrap();
    assert_eq!(recording.samples(), read(plain().as_bytes()).unwrap().samples());
    assert!(loss.unwrap().contains("its last line, 42, is an incomplete row"));
    // A whole row needs no end of line, and a short one with an end was not cut off.
    let whole = plain() + "10,21.5,220";
    let (recording, loss) = recording_and_loss("rig.csv", whole.as_bytes(), &Import::default()).unwrap();
    assert_eq!((recording.samples().len(), loss), (41, None));
    let short = read((plain() + "10,21.5\n").as_bytes()).unwrap_err().to_string();
    assert!(short.starts_with("rig.csv, line 42: 2 cells"), "{short}");
}

#[test]
fn a_header_of_other_width_than_all_rows_is_the_line_to_mend() {
    let error = sheet("rig.csv", b"time,data\n0,1,2,3\n1,1,2,3\n").unwrap_err().to_string();
    assert!(error.starts_with("rig.csv, line 1: the header has 2 names, and every row has 4 cells;"), "{error}");
    let error = sheet("rig.csv", b"time,data\n0,1\n1,1,2,3\n").unwrap_err().to_string();
    assert!(error.starts_with("rig.csv, line 3: 4 cells where the header has 2;"), "{error}");
}
