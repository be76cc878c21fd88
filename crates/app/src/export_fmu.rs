//! Writes an FMU: reads the libraries that go into it, and writes the file.

use crate::files;
use config::Config;
use fmu::{ArchiveError, Platform};
use std::io;
use std::path::{Path, PathBuf};

/// Why there is no FMU.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The config has no model, or the archive cannot be made.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// A library of the FMU is not there.
    #[error("cannot read the library of the FMU {}: {source}; name it with --library FILE", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is a library for no platform of an FMU.
    #[error(
        "{} is no library for 64-bit Linux or 64-bit Windows on x86; name another one with --library FILE",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Two libraries are for the same platform.
    #[error("{} is a second library for {platform}; name one for each platform", path.display())]
    Twice {
        /// The second file.
        path: PathBuf,
        /// Their platform.
        platform: Platform,
    },
    /// The file exists.
    #[error("{} exists and is kept; give another name with --out", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be written.
    #[error("cannot write the FMU {}: {source}; check its folder", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Writes the rig of a config as an FMU. `libraries`: the compiled `crates/fmu-c` for each platform that is to load
/// it. Returns these platforms.
///
/// # Errors
/// A config without a model, a library that is none, a file that exists or cannot be written.
pub fn export(config: &Config, libraries: &[PathBuf], out: &Path) -> Result<Vec<Platform>, ExportError> {
    if out.exists() {
        return Err(ExportError::Exists { path: out.into() });
    }
    let mut found: Vec<(Platform, Vec<u8>)> = Vec::new();
    for path in libraries {
        let code = std::fs::read(path).map_err(|source| ExportError::Library { path: path.clone(), source })?;
        let platform = Platform::of(&code).ok_or_else(|| ExportError::Foreign { path: path.clone() })?;
        if found.iter().any(|(other, _)| *other == platform) {
            return Err(ExportError::Twice { path: path.clone(), platform });
        }
        found.push((platform, code));
    }
    found.sort_by_key(|(platform, _)| *platform);
    let platforms = found.iter().map(|(platform, _)| *platform).collect();
    files::write(out, &fmu::archive(config, found)?)
        .map_err(|source| ExportError::Write { path: out.into(), source })?;
    Ok(platforms)
}

/// The libraries in a folder: that for Linux, which has to be there, and that for Windows where it is.
#[must_use]
pub fn libraries_in(folder: &Path) -> Vec<PathBuf> {
    let place = |platform: Platform| folder.join(platform.library());
    let others = Platform::ALL.into_iter().filter(|platform| *platform != Platform::Linux64);
    std::iter::once(place(Platform::Linux64)).chain(others.map(place).filter(|path| path.exists())).collect()
}
