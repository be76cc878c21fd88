//! Files of results: written beside their place and renamed, so that each appears whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;

/// Checks that a file can be made or replaced, before the computation whose result it holds. It leaves no trace.
///
/// # Errors
/// What the system said of the folder, or that a folder has this name.
pub fn may_be_made(path: &Path) -> io::Result<()> {
    match path.metadata() {
        Ok(found) if found.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => return Ok(()),
        _ => {}
    }
    let (_, unfinished) = begin(&place(path))?;
    fs::remove_file(unfinished)
}

/// Writes a file as a whole: on a failure, as of a full disk, an older file of this name stays as it was. A device or
/// a pipe is written directly.
///
/// # Errors
/// What the system said.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        return fs::write(path, bytes);
    }
    let place = place(path);
    let (mut file, unfinished) = begin(&place)?;
    let permissions = place.metadata().map(|older| older.permissions());
    let written = file
        .write_all(bytes)
        .and_then(|()| permissions.map_or(Ok(()), |older| file.set_permissions(older)))
        .and_then(|()| file.sync_all())
        .and_then(|()| fs::rename(&unfinished, &place));
    written.inspect_err(|_| {
        let _ = fs::remove_file(&unfinished);
    })
}

/// Where the file lies, if its name is a symbolic link, which is kept.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// An empty file beside the place, hidden and of this process alone.
fn begin(place: &Path) -> io::Result<(File, PathBuf)> {
    let name = place.file_name().ok_or(ErrorKind::InvalidFilename)?;
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}.part", process::id()));
    let unfinished = place.with_file_name(hidden);
    // One that a killed process of the same number left behind is replaced.
    let _ = fs::remove_file(&unfinished);
    Ok((OpenOptions::new().write(true).create_new(true).open(&unfinished)?, unfinished))
}

#[cfg(test)]
mod tests {
    use super::{may_be_made, write};
    use std::fs;

    #[test]
    fn a_file_is_replaced_by_renaming_and_is_never_seen_half_written() {
        let folder = tempfile::tempdir().unwrap();
        let (path, older) = (folder.path().join("p.svg"), folder.path().join("older"));
        fs::write(&path, "older").unwrap();
        // A second name of the old file shows whether its bytes were changed in place.
        fs::hard_link(&path, &older).unwrap();
        write(&path, b"newer").unwrap();
        assert_eq!((fs::read(&path).unwrap(), fs::read(&older).unwrap()), (b"newer".to_vec(), b"older".to_vec()));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_failed_file_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        assert!(write(&folder.path().join("nosuch/p.svg"), b"new").is_err());
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(write(&taken, b"new").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_place_is_judged_before_anything_is_written_and_without_a_trace() {
        let folder = tempfile::tempdir().unwrap();
        assert!(may_be_made(&folder.path().join("nosuch/p.svg")).is_err());
        assert!(may_be_made(folder.path()).is_err());
        may_be_made(&folder.path().join("p.svg")).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_is_kept_and_a_device_is_written_directly() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("p.toml"), folder.path().join("link"));
        fs::write(&path, "older").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write(&link, b"newer").unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"newer");
        let null = std::path::Path::new("/dev/null");
        may_be_made(null).unwrap();
        write(null, b"nothing").unwrap();
    }
}
