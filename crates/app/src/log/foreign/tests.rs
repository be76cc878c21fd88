//! Tests of foreign MCAP files, which the library of the format writes.

use super::{Import, LogError, ros, table};
use crate::log::reader::{self, Undescribed};
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use proptest::prelude::*;
use rows::Column;
use serde_json::json;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

/// A channel: topic, encoding, name of the schema; and its messages with their times, ns.
type Channel<'a> = (&'a str, &'a str, &'a str, Vec<(u64, Vec<u8>)>);

fn file(channels: &[Channel<'_>]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(None).use_chunks(true);
    let mut writer = options.create(&mut bytes).unwrap();
    for (topic, encoding, schema, messages) in channels {
        let schema = writer.add_schema(schema, "ros2msg", b"").unwrap();
        let channel = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
        for (sequence, (time, data)) in (0..).zip(messages) {
            let header = MessageHeader { channel_id: channel, sequence, log_time: *time, publish_time: *time };
            writer.write_to_known_channel(&header, data).unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

/// What appends itself to a body.
type Part<'a> = &'a dyn Fn(&mut Vec<u8>);

/// Little-endian CDR: each part aligned to its size behind the head.
fn cdr(parts: &[Part<'_>]) -> Vec<u8> {
    let mut body = Vec::new();
    parts.iter().for_each(|part| part(&mut body));
    [&[0, 1, 0, 0][..], &body].concat()
}

fn aligned(body: &mut Vec<u8>, bytes: &[u8]) {
    while !body.len().is_multiple_of(bytes.len()) {
        body.push(0);
    }
    body.extend_from_slice(bytes);
}

fn word(value: u32) -> impl Fn(&mut Vec<u8>) {
    move |body| aligned(body, &value.to_le_bytes())
}

fn text(value: &'static str) -> impl Fn(&mut Vec<u8>) {
    move |body| {
        aligned(body, &(u32::try_from(value.len()).unwrap() + 1).to_le_bytes());
        body.extend_from_slice(value.as_bytes());
        body.push(0);
    }
}

fn doubles(values: &'static [f64]) -> impl Fn(&mut Vec<u8>) {
    move |body| {
        aligned(body, &u32::try_from(values.len()).unwrap().to_le_bytes());
        values.iter().for_each(|value| aligned(body, &value.to_le_bytes()));
    }
}

/// A cart: its position 50 times a second, its voltage 20 ms later than that and half as often.
fn cart() -> Vec<u8> {
    let y = |k: u64| (1_000_000_000 + 20_000_000 * k, json!({"y": 0.01 * k as f64, "ok": true, "name": "cart"}));
    let u = |k: u64| (1_005_000_000 + 40_000_000 * k, json!({"data": [k as f64, -1.0]}));
    let bytes = |(time, value): (u64, serde_json::Value)| (time, value.to_string().into_bytes());
    file(&[
        ("/cart/state", "json", "State", (0..50).map(y).map(bytes).collect()),
        ("/cart/input", "json", "Input", (0..25).map(u).map(bytes).collect()),
    ])
}

fn import() -> Import {
    Import {
        duty_percent: Column::named("/cart/input.data.0"),
        position_mm: Column { scale: 1000.0, ..Column::named("/cart/state.y") },
        ..Import::default()
    }
}

#[test]
fn a_foreign_file_is_read_by_topic_and_field_with_a_row_for_each_position() {
    let log = reader::parse(Path::new("cart.mcap"), &cart(), Some(&import())).unwrap();
    let rows = log.recording.samples();
    // The first position is before the first input, and has no row.
    assert_eq!(rows.len(), 49);
    assert!((rows[0].time_s - 0.02).abs() < 1e-9 && (rows[0].position_mm.unwrap() - 10.0).abs() < 1e-9);
    // An input holds until the next one.
    assert_eq!(rows[..4].iter().map(|row| row.duty_percent).collect::<Vec<_>>(), [0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn a_position_that_a_message_does_not_hold_is_no_reading_and_an_input_stays_in_force() {
    let state = |k: u64| {
        let y = if k.is_multiple_of(3) { json!(0.01 * k as f64) } else { json!(null) };
        let data = if k < 10 { json!({"y": y, "u": 7.0, "n": k}) } else { json!({"y": y, "n": k}) };
        (20_000_000 * k, data.to_string().into_bytes())
    };
    let bytes = file(&[("/rig", "json", "State", (0..60).map(state).collect())]);
    let columns = Import { duty_percent: Column::named("/rig.u"), position_mm: Column::named("/rig.y"), ..import() };
    let recording = reader::parse(Path::new("rig.mcap"), &bytes, Some(&columns)).unwrap().recording;
    assert_eq!((recording.samples().len(), recording.readings()), (60, 20));
    assert!(recording.samples().iter().all(|row| row.duty_percent == 7.0));
}

#[test]
fn a_column_that_is_not_there_is_named_beside_those_that_are() {
    let error = reader::parse(Path::new("cart.mcap"), &cart(), None).unwrap_err().to_string();
    for words in ["duty_percent", "/cart/state.y", "/cart/input.data.1", "time_s"] {
        assert!(error.contains(words), "no {words} in {error}");
    }
}

#[test]
fn without_a_description_it_is_a_table_of_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cart.mcap");
    std::fs::write(&path, cart()).unwrap();
    let Undescribed::Table(sheet, None) = reader::undescribed(&path).unwrap() else { panic!("a flight") };
    let names: Vec<&str> = sheet.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["time_s", "/cart/state.ok", "/cart/state.y", "/cart/input.data.0", "/cart/input.data.1"]);
    assert_eq!(sheet.rows, 50);
}

#[test]
fn messages_of_ros_are_decoded_by_their_type() {
    let joint = cdr(&[
        &word(12),
        &word(500_000_000),
        &text("base"),
        &word(1),
        &text("elbow"),
        &doubles(&[0.25]),
        &doubles(&[]),
        &doubles(&[3.5]),
    ]);
    let found = ros::value("sensor_msgs/msg/JointState", &joint).unwrap();
    assert_eq!(
        (&found["position"][0], &found["effort"][0], &found["header"]["stamp_s"]),
        (&json!(0.25), &json!(3.5), &json!(12.5))
    );
    let number = cdr(&[&|body| aligned(body, &7.5_f64.to_le_bytes())]);
    assert_eq!(ros::value("std_msgs/msg/Float64", &number), Some(json!({"data": 7.5})));
    let big = [&[0, 0, 0, 0][..], &7.5_f64.to_be_bytes()].concat();
    assert_eq!(ros::value("std_msgs/Float64", &big), Some(json!({"data": 7.5})));
    assert_eq!(ros::value("my_msgs/msg/Secret", &number), None);
    assert_eq!(ros::value("std_msgs/msg/Float64", &number[..9]), None);

    let bag = file(&[
        ("/joint_states", "cdr", "sensor_msgs/msg/JointState", vec![(0, joint.clone()), (20_000_000, joint)]),
        ("/effort", "cdr", "std_msgs/msg/Float64", vec![(0, number)]),
    ]);
    let import = Import {
        duty_percent: Column::named("/effort.data"),
        position_mm: Column::named("/joint_states.position.0"),
        ..Import::default()
    };
    let csv = String::from_utf8(table(Path::new("b.mcap"), &bag, Some(&import)).unwrap().unwrap().csv).unwrap();
    assert!(csv.lines().last().unwrap().starts_with("0.02,"), "{csv}");
    assert!(csv.starts_with("time_s,/joint_states.effort.0,/joint_states.header.stamp_s,"), "{csv}");
}

#[test]
fn an_odometry_is_decoded_across_its_covariances() {
    let numbers = |values: Vec<f64>| {
        move |body: &mut Vec<u8>| values.iter().for_each(|value| aligned(body, &value.to_le_bytes()))
    };
    let pose = numbers((0..7).map(f64::from).chain([9.0; 36]).collect());
    let twist = numbers((10..16).map(f64::from).chain([9.0; 36]).collect());
    let message = cdr(&[&word(12), &word(0), &text("odom"), &text("base"), &pose, &twist]);
    let found = ros::value("nav_msgs/msg/Odometry", &message).unwrap();
    assert_eq!(found["pose"]["pose"]["position"], json!({"x": 0.0, "y": 1.0, "z": 2.0}));
    assert_eq!(found["twist"]["twist"]["angular"], json!({"x": 13.0, "y": 14.0, "z": 15.0}));
    assert_eq!(found["pose"].get("covariance"), None);
}

#[test]
fn a_file_of_which_no_channel_can_be_read_says_how_they_are_written_and_which_are() {
    let bytes = file(&[("/cart", "protobuf", "Cart", vec![(0, vec![1, 2, 3])])]);
    let error = reader::parse(Path::new("p.mcap"), &bytes, None).unwrap_err();
    assert!(matches!(error, LogError::Foreign { .. }), "{error}");
    let error = error.to_string();
    assert!(error.contains("/cart (protobuf Cart)") && error.contains("JSON") && error.contains("CSV"), "{error}");
}

#[test]
fn channels_that_cannot_be_read_are_named_where_a_column_is_missing() {
    let readable = |at: u64| (at * 20_000_000, br#"{"effort": 1.5, "note": "text alone is no loss"}"#.to_vec());
    let secret = cdr(&[&|body| aligned(body, &7.5_f64.to_le_bytes())]);
    let bytes = file(&[
        ("/effort", "json", "Effort", (0..50).map(readable).collect()),
        ("/arm/state", "cdr", "my_msgs/msg/ArmState", vec![(0, secret)]),
        ("/words", "json", "Words", vec![(0, b"\"hello\"".to_vec())]),
        ("/silent", "protobuf", "Silent", vec![]),
    ]);
    let error = reader::parse(Path::new("arm.mcap"), &bytes, Some(&import())).unwrap_err().to_string();
    for words in ["/effort.effort", "/arm/state (cdr my_msgs/msg/ArmState)", "CSV"] {
        assert!(error.contains(words), "no {words} in {error}");
    }
    assert!(!error.contains("/words") && !error.contains("/silent"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.mcap");
    std::fs::write(&path, &bytes).unwrap();
    let Undescribed::Table(_, Some(unread)) = reader::undescribed(&path).unwrap() else { panic!("all was read") };
    assert!(unread.contains("/arm/state"), "{unread}");
}

proptest! {
    #[test]
    fn no_bytes_of_a_message_make_the_decoder_panic(
        data in prop::collection::vec(any::<u8>(), 0..200), order in 0..2_u8
    ) {
        let data = [&[0, order, 0, 0][..], &data].concat();
        for name in [
            "sensor_msgs/msg/JointState",
            "std_msgs/msg/Float64MultiArray",
            "geometry_msgs/msg/PoseStamped",
            "nav_msgs/msg/Odometry",
            "sensor_msgs/msg/Imu",
        ] {
            let _ = ros::value(name, &data);
        }
    }
}
