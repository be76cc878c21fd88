//! The text of a file: UTF-8; UTF-16 with its byte order mark; or Windows-1252 (and Latin-1, which is part of it), as
//! spreadsheets of western Europe write it.

use crate::error::RowsError;
use encoding_rs::{Encoding, UTF_8, WINDOWS_1252};
use std::borrow::Cow;

/// The text, without its byte order mark; `name` is the file's name in messages.
pub(crate) fn decoded<'a>(name: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, RowsError> {
    let (encoding, mark) = Encoding::for_bom(bytes).unwrap_or((UTF_8, 0));
    let bytes = &bytes[mark..];
    if let Some(text) = encoding.decode_without_bom_handling_and_without_replacement(bytes) {
        return Ok(text);
    }
    if encoding != UTF_8 {
        return Err(RowsError::NotUtf16 { name: name.into() });
    }
    // Each byte is a letter there, so that only control bytes tell a table from what is no text.
    match bytes.iter().position(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace()) {
        Some(byte) => {
            let line = 1 + bytes[..byte].iter().filter(|byte| **byte == b'\n').count();
            Err(RowsError::NotText { name: name.into(), line, byte })
        }
        None => Ok(WINDOWS_1252.decode_without_bom_handling(bytes).0),
    }
}
