//! The columns of `[import]`, for findings that correct their conversion.

use diagnose::{SourceColumn, SourceColumns};
use rows::{Column, Import};

/// The columns that a record is read from.
pub(super) fn source_columns(import: &Import) -> SourceColumns {
    SourceColumns {
        time_s: source(&import.time_s),
        duty_percent: source(&import.duty_percent),
        position_mm: source(&import.position_mm),
    }
}

fn source(column: &Column) -> SourceColumn {
    let minus = column.minus.as_ref().map(|other| format!(", minus = {}", quoted(other)));
    let integrate = column.integrate.then(|| ", integrate = true".to_owned());
    let further_keys = [minus, integrate].into_iter().flatten().collect();
    SourceColumn {
        column: column.column.clone(),
        quoted: quoted(&column.column),
        scale: column.scale,
        offset: column.offset,
        further_keys,
    }
}

/// A word as TOML writes it.
#[must_use]
pub fn quoted(word: &str) -> String {
    toml::Value::String(word.into()).to_string()
}
