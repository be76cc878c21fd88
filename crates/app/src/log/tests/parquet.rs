//! Parquet files as logs: one that pandas wrote, and some that the library of the format writes.
//!
//! `tests/data/pandas.parquet` was written by pandas 3.1.1 and pyarrow 26.0.1 (packed with snappy) of a made-up table
//! of six rows: moments, single and double precision, a missing value, bytes, flags, texts, lists and a group.

use crate::log::{LogError, parquet, reader};
use ::parquet::basic::{Compression, GzipLevel, ZstdLevel};
use ::parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FixedLenByteArrayType, Int32Type};
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use ::parquet::schema::parser::parse_message_type;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

const BY_PANDAS: &[u8] = include_bytes!("../../../tests/data/pandas.parquet");

fn text(bytes: &[u8]) -> Result<String, LogError> {
    parquet::table(Path::new("run.parquet"), bytes).map(|csv| String::from_utf8(csv).unwrap())
}

/// Writes the next column of a group; `levels`: which rows have a value, where not all have.
fn write<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    levels: Option<&[i16]>,
) {
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<T>().write_batch(values, levels, None).unwrap();
    column.close().unwrap();
}

/// Sixty rows in two groups: time and position in double precision, the duty whole.
fn written(compression: Compression) -> Vec<u8> {
    let schema = "message log { required double time_s; required int32 duty_percent; optional double position_mm; }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties).unwrap();
    for group in 0..2 {
        let rows = 30 * group..30 * (group + 1);
        let mut of_group = writer.next_row_group().unwrap();
        let times: Vec<f64> = rows.clone().map(|row| 0.02 * f64::from(row)).collect();
        write::<DoubleType, _>(&mut of_group, &times, None);
        let duties: Vec<i32> = rows.clone().map(|row| 30 + row % 10).collect();
        write::<Int32Type, _>(&mut of_group, &duties, None);
        // Every third position is missing.
        let levels: Vec<i16> = rows.clone().map(|row| i16::from(row % 3 != 0)).collect();
        let positions: Vec<f64> = rows.filter(|row| row % 3 != 0).map(|row| 100.0 + f64::from(row)).collect();
        write::<DoubleType, _>(&mut of_group, &positions, Some(&levels));
        of_group.close().unwrap();
    }
    writer.close().unwrap();
    bytes
}

#[test]
fn a_table_of_pandas_has_its_single_values_with_times_in_seconds_and_groups_by_name() {
    let csv = text(BY_PANDAS).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some(r#""t","u","y","n","on","note","arm.angle","arm.speed""#));
    // 2026-11-26 10:00:00 UTC.
    assert_eq!(lines.next(), Some(r##"1795687200,40,100.5,1,1,"#start",0,1"##));
    assert_eq!(lines.next(), Some(r#"1795687200.02,41,"",2,0,"a, b",0.1,1"#));
    assert_eq!(lines.last(), Some(r#"1795687200.1,45,103,250,0,"e",0.5,1"#));
}

#[test]
fn packed_in_every_usual_way_and_in_two_groups_it_is_the_same_recording() {
    let gzip = Compression::GZIP(GzipLevel::default());
    let zstd = Compression::ZSTD(ZstdLevel::default());
    for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY, gzip, zstd, Compression::LZ4_RAW] {
        let log = reader::parse(Path::new("run.parquet"), &written(compression), None).unwrap();
        let samples = log.recording.samples();
        assert_eq!((samples.len(), log.recording.readings()), (60, 40), "{compression:?}");
        let at = |row: usize| (samples[row].time_s, samples[row].duty_percent, samples[row].position_mm);
        assert_eq!(at(30), (0.6, 30.0, None), "{compression:?}");
        assert_eq!(at(59), (1.18, 39.0, Some(159.0)), "{compression:?}");
    }
}

/// A file of one column with these values.
fn of_one_column<T: DataType>(schema: &str, values: &[T::T]) -> Vec<u8> {
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(WriterProperties::default())).unwrap();
    let mut group = writer.next_row_group().unwrap();
    write::<T, _>(&mut group, values, None);
    group.close().unwrap();
    writer.close().unwrap();
    bytes
}

#[test]
fn decimals_of_any_width_are_numbers() {
    let cells = |bytes: &[u8]| text(bytes).unwrap().lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    let wide = "message log { required fixed_len_byte_array(3) y (decimal(6, 2)); }";
    let values = [[0x01, 0x00, 0x02], [0xff, 0xff, 0xfe]].map(|value| ByteArray::from(value.to_vec()).into());
    assert_eq!(cells(&of_one_column::<FixedLenByteArrayType>(wide, &values)), ["655.38", "-0.02"]);
    let short = "message log { required binary y (decimal(6, 1)); }";
    let values = [vec![0x7f], vec![0xff, 0x00]].map(ByteArray::from);
    assert_eq!(cells(&of_one_column::<ByteArrayType>(short, &values)), ["12.7", "-25.6"]);
}

#[test]
fn a_small_file_of_much_text_is_refused_before_it_fills_the_memory() {
    let values = vec![ByteArray::from("x".repeat(1 << 15).as_str()); 10_000];
    let bytes = of_one_column::<ByteArrayType>("message log { required binary note (utf8); }", &values);
    assert!(bytes.len() < 1 << 20, "{}", bytes.len());
    let said = text(&bytes).unwrap_err().to_string();
    assert!(said.contains("it holds more than 268435456 bytes of text"), "{said}");
}

#[test]
fn a_damaged_file_is_named_with_the_way_to_a_csv() {
    let whole = written(Compression::SNAPPY);
    for (bytes, cause) in [(&whole[..whole.len() / 2], "Corrupt footer"), (b"PAR1", "too small")] {
        let said = text(bytes).unwrap_err().to_string();
        assert!(said.starts_with("cannot read run.parquet as Parquet: ") && said.contains(cause), "{said}");
        assert!(said.ends_with("pandas.read_parquet(FILE).to_csv('log.csv', index=False)"), "{said}");
    }
}

#[test]
fn no_flipped_byte_makes_a_panic() {
    for file in [written(Compression::SNAPPY), written(Compression::UNCOMPRESSED), BY_PANDAS.to_vec()] {
        for at in 0..file.len() {
            for flip in [0x01, 0x10, 0x80, 0xff] {
                let mut bytes = file.clone();
                bytes[at] ^= flip;
                let _ = text(&bytes);
            }
        }
    }
}
