//! The text of a file: UTF-8, or UTF-16 with its byte order mark, as spreadsheets write it.

use crate::error::RowsError;
use std::borrow::Cow;

/// The text, without its byte order mark; `name` is the file's name in messages.
pub(crate) fn decoded<'a>(name: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, RowsError> {
    match bytes {
        [0xff, 0xfe, rest @ ..] => return utf16(name, rest, u16::from_le_bytes).map(Cow::Owned),
        [0xfe, 0xff, rest @ ..] => return utf16(name, rest, u16::from_be_bytes).map(Cow::Owned),
        _ => {}
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(Cow::Borrowed(text.trim_start_matches('\u{feff}'))),
        Err(error) => {
            let byte = error.valid_up_to();
            let line = 1 + bytes[..byte].iter().filter(|byte| **byte == b'\n').count();
            Err(RowsError::NotUtf8 { name: name.into(), line, byte })
        }
    }
}

fn utf16(name: &str, bytes: &[u8], unit: impl Fn([u8; 2]) -> u16) -> Result<String, RowsError> {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let mut text = String::with_capacity(bytes.len() / 2);
    for letter in char::decode_utf16(units) {
        let line = || 1 + text.matches('\n').count();
        let wrong = || RowsError::NotUtf16 { name: name.into(), line: line() };
        let letter = letter.map_err(|_| wrong())?;
        text.push(letter);
    }
    if bytes.len() % 2 == 1 {
        return Err(RowsError::NotUtf16 { name: name.into(), line: 1 + text.matches('\n').count() });
    }
    Ok(text)
}
