//! Where the resources of an FMU are, as its caller says it.

use std::path::PathBuf;

/// The folder of a `file:` URI (RFC 8089), or of a plain path, which some tools give.
#[must_use]
pub fn folder(uri: &str) -> PathBuf {
    let Some(rest) = uri.strip_prefix("file:") else { return uri.into() };
    // Before the path there may be an empty host or the own one.
    let path = rest.strip_prefix("//localhost").or_else(|| rest.strip_prefix("//")).unwrap_or(rest);
    let path = decoded(path);
    // A path of Windows has a slash before its drive in a URI: /C:/rigs.
    let drive = cfg!(windows).then(|| path.strip_prefix('/').filter(|rest| rest[1..].starts_with(':'))).flatten();
    drive.map_or_else(|| path.as_str().into(), PathBuf::from)
}

/// The text with `%20` and other codes of bytes as what they stand for.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|two| u8::from_str_radix(std::str::from_utf8(two).ok()?, 16).ok());
        match code {
            Some(code) if byte == b'%' => {
                bytes.push(code);
                rest = &after[2..];
            }
            _ => {
                bytes.push(byte);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::folder;
    use std::path::Path;

    #[test]
    fn the_folder_of_a_uri_is_its_path_with_codes_decoded_and_a_plain_path_is_itself() {
        for uri in ["file:///rigs/a%20b", "file://localhost/rigs/a%20b", "file:/rigs/a%20b", "/rigs/a b"] {
            assert_eq!(folder(uri), Path::new("/rigs/a b"), "{uri}");
        }
        assert_eq!(folder("file:///50%"), Path::new("/50%"));
        assert_eq!(folder("file:///%zz"), Path::new("/%zz"));
        assert_eq!(folder("file:///r%C3%A9"), Path::new("/ré"));
        assert_eq!(folder("C:\\rigs"), Path::new("C:\\rigs"));
        assert_eq!(folder("file:///"), Path::new("/"));
    }
}
