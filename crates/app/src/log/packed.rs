//! Logs packed with zstd, recognised by their first bytes: a CSV packs to a quarter.

use super::LogError;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// First bytes of a zstd frame (RFC 8878).
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Largest size of a log: a small file could otherwise unpack to fill the memory.
const MOST_BYTES: u64 = 1 << 30;

/// The unpacked bytes, or the bytes themselves if they are not packed.
pub(super) fn unpacked<'a>(path: &Path, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, LogError> {
    if !bytes.starts_with(&MAGIC) {
        return Ok(Cow::Borrowed(bytes));
    }
    let wrong = |cause: String| LogError::Packed { path: path.into(), cause };
    let mut unpacked = Vec::new();
    let decoder = zstd::Decoder::new(bytes).map_err(|error| wrong(error.to_string()))?;
    decoder.take(MOST_BYTES + 1).read_to_end(&mut unpacked).map_err(|error| wrong(error.to_string()))?;
    if unpacked.len() as u64 > MOST_BYTES {
        return Err(wrong(format!("it holds more than {MOST_BYTES} bytes")));
    }
    Ok(Cow::Owned(unpacked))
}

#[cfg(test)]
mod tests {
    use super::unpacked;
    use std::path::Path;

    #[test]
    fn what_was_packed_comes_back_and_what_was_not_stays() {
        let text = b"time_s,duty_percent,position_mm\n".repeat(100);
        let packed = zstd::encode_all(text.as_slice(), 19).unwrap();
        assert!(packed.len() < text.len() / 4);
        assert_eq!(*unpacked(Path::new("a.csv.zst"), &packed).unwrap(), text);
        assert_eq!(*unpacked(Path::new("a.csv"), &text).unwrap(), text);
    }

    #[test]
    fn a_packed_log_that_was_cut_short_is_named() {
        let packed = zstd::encode_all([7; 9000].as_slice(), 19).unwrap();
        let error = unpacked(Path::new("cut.csv.zst"), &packed[..packed.len() - 3]).unwrap_err().to_string();
        assert!(error.starts_with("cannot unpack cut.csv.zst"), "{error}");
    }
}
