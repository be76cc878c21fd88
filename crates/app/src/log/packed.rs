//! Logs packed with zstd or gzip, recognised by their first bytes: a CSV packs to a quarter.

use super::LogError;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// First bytes of a zstd frame (RFC 8878).
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// First bytes of a gzip member (RFC 1952) that is packed by deflate, the only way there is.
const GZIP: [u8; 3] = [0x1f, 0x8b, 8];
/// Largest size of a log: a small file could otherwise unpack to fill the memory.
const MOST_BYTES: u64 = 1 << 30;

/// The unpacked bytes, or the bytes themselves if they are not packed.
pub(super) fn unpacked<'a>(path: &Path, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, LogError> {
    let wrong = |program: &'static str| move |cause: String| LogError::Packed { path: path.into(), program, cause };
    if bytes.starts_with(&GZIP) {
        return read(flate2::read::MultiGzDecoder::new(bytes)).map(Cow::Owned).map_err(wrong("gzip"));
    }
    if !bytes.starts_with(&MAGIC) {
        return Ok(Cow::Borrowed(bytes));
    }
    let decoder = zstd::Decoder::new(bytes).map_err(|error| error.to_string());
    decoder.and_then(read).map(Cow::Owned).map_err(wrong("zstd"))
}

fn read(decoder: impl Read) -> Result<Vec<u8>, String> {
    let mut unpacked = Vec::new();
    decoder.take(MOST_BYTES + 1).read_to_end(&mut unpacked).map_err(|error| error.to_string())?;
    if unpacked.len() as u64 > MOST_BYTES {
        return Err(format!("it holds more than {MOST_BYTES} bytes"));
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use super::unpacked;
    use std::io::Write;
    use std::path::Path;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packer.write_all(bytes).unwrap();
        packer.finish().unwrap()
    }

    #[test]
    fn what_was_packed_comes_back_and_what_was_not_stays() {
        let text = b"time_s,duty_percent,position_mm\n".repeat(100);
        let packed = zstd::encode_all(text.as_slice(), 19).unwrap();
        assert!(packed.len() < text.len() / 4);
        assert_eq!(*unpacked(Path::new("a.csv.zst"), &packed).unwrap(), text);
        assert_eq!(*unpacked(Path::new("a.csv.gz"), &gzip(&text)).unwrap(), text);
        assert_eq!(*unpacked(Path::new("a.csv"), &text).unwrap(), text);
    }

    #[test]
    fn a_packed_log_that_was_cut_short_is_named() {
        let packed = zstd::encode_all([7; 9000].as_slice(), 19).unwrap();
        let error = unpacked(Path::new("cut.csv.zst"), &packed[..packed.len() - 3]).unwrap_err().to_string();
        assert!(error.starts_with("cannot unpack cut.csv.zst (zstd)"), "{error}");
        let packed = gzip(&[7; 9000]);
        let error = unpacked(Path::new("cut.csv.gz"), &packed[..packed.len() - 3]).unwrap_err().to_string();
        assert!(error.starts_with("cannot unpack cut.csv.gz (gzip)"), "{error}");
    }
}
