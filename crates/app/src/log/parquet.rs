//! Apache Parquet files as a table: a column for each column of single values, with the names of groups before its own.
//!
//! Times become seconds, decimals and flags numbers. Lists, maps, binary data and floats of 16 bits are left out.

use super::LogError;
use super::contained::contained;
use bytes::Bytes;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use std::cell::Cell;
use std::path::Path;

/// First bytes of a file.
const MAGIC: &[u8] = b"PAR1";
/// Values that are read at once.
const CHUNK: usize = 1 << 16;
/// Most cells of a table, 512 MB of numbers: a small file could otherwise fill the memory.
const MOST_CELLS: usize = 1 << 26;
/// Most bytes of text, half the size of the numbers: a dictionary repeats a long text for a byte or two.
const MOST_TEXT: usize = 1 << 28;

/// Whether the bytes are those of a Parquet file.
pub(super) fn is_parquet(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// The table of a Parquet file as CSV.
///
/// # Errors
/// [`LogError::Parquet`]: it is damaged, packed in a way that is not read, too large, or has no column of single
/// values.
pub(super) fn table(path: &Path, bytes: &[u8]) -> std::result::Result<Vec<u8>, LogError> {
    // The library checks what it reads, but not everything: some damaged files make it panic.
    let columns = contained(|| columns(bytes)).unwrap_or_else(|| Err(wrong("it is damaged")));
    columns.map(|columns| csv(&columns)).map_err(|error| LogError::Parquet { path: path.into(), cause: cause(&error) })
}

/// A column and its cells, empty where there is no value.
struct Column {
    name: String,
    cells: Cells,
}

enum Cells {
    /// NaN where there is no value.
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    fn cell(&self, row: usize) -> String {
        match self {
            Self::Numbers(numbers) => {
                numbers.get(row).filter(|number| !number.is_nan()).map(f64::to_string).unwrap_or_default()
            }
            Self::Texts(texts) => texts.get(row).cloned().unwrap_or_default(),
        }
    }
}

/// The cause without the library's name for its kind.
fn cause(error: &ParquetError) -> String {
    match error {
        ParquetError::General(cause) => cause.clone(),
        other => other.to_string(),
    }
}

fn wrong(cause: impl Into<String>) -> ParquetError {
    ParquetError::General(cause.into())
}

fn columns(bytes: &[u8]) -> Result<Vec<Column>> {
    let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes))?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let (mut columns, mut cells_left) = (Vec::new(), MOST_CELLS);
    let text_left = Cell::new(Some(MOST_TEXT));
    for (index, about) in schema.columns().iter().enumerate() {
        if about.max_rep_level() > 0 {
            continue;
        }
        let Some(mut cells) = none_yet(about) else { continue };
        for group in 0..reader.num_row_groups() {
            let values = reader.get_row_group(group)?.get_column_reader(index)?;
            read(values, about, &mut cells, cells_left, &text_left)?;
        }
        cells_left -= cells.len();
        columns.push(Column { name: about.path().string(), cells });
    }
    let rows = columns.first().map(|column| column.cells.len()).ok_or_else(|| wrong("no column of single values"))?;
    match columns.iter().find(|column| column.cells.len() != rows) {
        Some(other) => Err(wrong(format!("{rows} rows, but {} in the column {}", other.cells.len(), other.name))),
        None => Ok(columns),
    }
}

/// The cells before any is read; `None`: a column of binary data.
fn none_yet(about: &ColumnDescriptor) -> Option<Cells> {
    use parquet::basic::Type;
    let is_text =
        about.converted_type() == ConvertedType::UTF8 || matches!(about.logical_type_ref(), Some(LogicalType::String));
    match about.physical_type() {
        Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY if about.converted_type() == ConvertedType::DECIMAL => {
            Some(Cells::Numbers(Vec::new()))
        }
        Type::BYTE_ARRAY => is_text.then(|| Cells::Texts(Vec::new())),
        Type::FIXED_LEN_BYTE_ARRAY => None,
        _ => Some(Cells::Numbers(Vec::new())),
    }
}

/// Appends a column's values in one group of rows, until it has `most`, or its texts have taken `text_left` bytes.
fn read(
    reader: ColumnReader,
    about: &ColumnDescriptor,
    cells: &mut Cells,
    most: usize,
    text_left: &Cell<Option<usize>>,
) -> Result<()> {
    let unsigned = is_unsigned(about);
    #[expect(clippy::cast_precision_loss, reason = "a time of 2^53 ns and more is exact to better than 1 µs")]
    let long = |value: i64| if unsigned { value.cast_unsigned() as f64 } else { value as f64 };
    let int = |value: i32| if unsigned { f64::from(value.cast_unsigned()) } else { f64::from(value) };
    let append = Append { defined: about.max_def_level(), divisor: divisor(about), most };
    match (cells, reader) {
        (Cells::Texts(texts), ColumnReader::ByteArrayColumnReader(reader)) => {
            let text = |value: &ByteArray| {
                let text = value.as_utf8().unwrap_or_default();
                text_left.set(text_left.get().and_then(|left| left.checked_sub(text.len())));
                if text_left.get().is_some() { text.to_owned() } else { String::new() }
            };
            append.cells(reader, texts, |value| value.map(text).unwrap_or_default())?;
            match text_left.get() {
                Some(_) => Ok(()),
                None => Err(wrong(format!("it holds more than {MOST_TEXT} bytes of text"))),
            }
        }
        (Cells::Numbers(to), ColumnReader::ByteArrayColumnReader(reader)) => {
            append.numbers(reader, to, |value| integer(value.data()))
        }
        (Cells::Numbers(to), ColumnReader::FixedLenByteArrayColumnReader(reader)) => {
            append.numbers(reader, to, |value| integer(value.data()))
        }
        (Cells::Numbers(to), ColumnReader::BoolColumnReader(reader)) => {
            append.numbers(reader, to, |flag| u8::from(*flag).into())
        }
        (Cells::Numbers(to), ColumnReader::Int32ColumnReader(reader)) => {
            append.numbers(reader, to, |value| int(*value))
        }
        (Cells::Numbers(to), ColumnReader::Int64ColumnReader(reader)) => {
            append.numbers(reader, to, |value| long(*value))
        }
        // A moment as older programs write it; its scale is not stored.
        (Cells::Numbers(to), ColumnReader::Int96ColumnReader(reader)) => {
            append.numbers(reader, to, |moment| 1e-6 * long(moment.to_micros()))
        }
        (Cells::Numbers(to), ColumnReader::FloatColumnReader(reader)) => {
            append.numbers(reader, to, |value| f64::from(*value))
        }
        (Cells::Numbers(to), ColumnReader::DoubleColumnReader(reader)) => append.numbers(reader, to, |value| *value),
        (Cells::Texts(_), _) => Ok(()),
    }
}

/// The integer of a decimal: two's complement, the highest byte first.
fn integer(bytes: &[u8]) -> f64 {
    let Some((first, others)) = bytes.split_first() else { return f64::NAN };
    others.iter().fold(f64::from(first.cast_signed()), |sum, byte| 256.0 * sum + f64::from(*byte))
}

/// How stored values become cells.
struct Append {
    /// The definition level of a row that has a value.
    defined: i16,
    divisor: f64,
    /// Most cells of the column.
    most: usize,
}

impl Append {
    fn numbers<T: DataType>(
        &self,
        reader: ColumnReaderImpl<T>,
        numbers: &mut Vec<f64>,
        number: impl Fn(&T::T) -> f64,
    ) -> Result<()> {
        self.cells(reader, numbers, |value| value.map_or(f64::NAN, |value| number(value) / self.divisor))
    }

    /// Appends the cell of every row of one group.
    fn cells<T: DataType, C>(
        &self,
        mut reader: ColumnReaderImpl<T>,
        cells: &mut Vec<C>,
        cell: impl Fn(Option<&T::T>) -> C,
    ) -> Result<()> {
        let (mut values, mut levels) = (Vec::new(), Vec::new());
        loop {
            values.clear();
            levels.clear();
            let (rows, ..) = reader.read_records(CHUNK, Some(&mut levels), None, &mut values)?;
            if rows == 0 {
                return Ok(());
            }
            if cells.len() + rows > self.most {
                return Err(wrong(format!("it holds more than {MOST_CELLS} cells")));
            }
            let mut values = values.iter();
            if self.defined == 0 {
                cells.extend(values.map(|value| cell(Some(value))));
            } else {
                let has_value = levels.iter().map(|level| *level == self.defined);
                cells.extend(has_value.map(|has| cell(has.then(|| values.next()).flatten())));
            }
        }
    }
}

/// By how much a stored number is divided: how many of a time's unit are a second, the power of ten of a decimal, or 1.
fn divisor(about: &ColumnDescriptor) -> f64 {
    let of_unit = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => 1e3,
        TimeUnit::MICROS => 1e6,
        TimeUnit::NANOS => 1e9,
    };
    match (about.logical_type_ref(), about.converted_type()) {
        (Some(LogicalType::Timestamp(time)), _) => of_unit(&time.unit),
        (Some(LogicalType::Time(time)), _) => of_unit(&time.unit),
        (_, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS) => 1e3,
        (_, ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS) => 1e6,
        (_, ConvertedType::DECIMAL) => 10.0_f64.powi(about.type_scale()),
        _ => 1.0,
    }
}

fn is_unsigned(about: &ColumnDescriptor) -> bool {
    use ConvertedType::{UINT_8, UINT_16, UINT_32, UINT_64};
    matches!(about.logical_type_ref(), Some(LogicalType::Integer(whole)) if !whole.is_signed)
        || matches!(about.converted_type(), UINT_8 | UINT_16 | UINT_32 | UINT_64)
}

fn csv(columns: &[Column]) -> Vec<u8> {
    // Texts in quotes: none is taken for a comment.
    let mut writer = csv::WriterBuilder::new().quote_style(csv::QuoteStyle::NonNumeric).from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = writer.write_record(columns.iter().map(|column| &column.name));
    for row in 0..columns.first().map_or(0, |column| column.cells.len()) {
        let _ = writer.write_record(columns.iter().map(|column| column.cells.cell(row)));
    }
    writer.into_inner().unwrap_or_default()
}
