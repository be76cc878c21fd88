//! Writes an FMU.

use super::MODEL;
use super::description::{IDENTIFIER, description};
use super::variables::variables;
use crate::config::{Config, ConfigError, Tables};
use crate::files;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The library of an FMU, as it lies beside the program.
pub const LIBRARY: &str = "libairball_fmu.so";

/// Period of the loop where the config has none, seconds.
const PERIOD_S: f64 = 0.02;

/// Why there is no FMU.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The config has no model.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The library of the FMU is not there.
    #[error("cannot read the library of the FMU {}: {source}; name it with --library FILE", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is no library for 64-bit Linux.
    #[error("{} is no library for 64-bit Linux on x86; name another one with --library FILE", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
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
    /// The archive cannot be made.
    #[error("cannot pack the FMU: {0}")]
    Pack(#[from] zip::result::ZipError),
}

/// Writes the rig of a config as an FMU. `library`: the compiled `crates/fmu`. The same config and library give the
/// same bytes.
///
/// # Errors
/// A config without a model, a library that is none, a file that exists or cannot be written.
pub fn export(config: &Config, library: &Path, out: &Path) -> Result<(), ExportError> {
    if out.exists() {
        return Err(ExportError::Exists { path: out.into() });
    }
    let model = config.need("export fmu", "plant", |tables| tables.plant.as_ref())?;
    let code = std::fs::read(library).map_err(|source| ExportError::Library { path: library.into(), source })?;
    if !is_linux64(&code) {
        return Err(ExportError::Foreign { path: library.into() });
    }
    let resources = resources(&config.tables);
    let period_s = config.tables.r#loop.map_or(PERIOD_S, |table| table.period_s);
    let name = config.tables.rig.as_ref().map_or("rig", |rig| rig.name.as_str());
    let about = description(&variables(model), name, period_s, &resources);
    let parts = [
        ("modelDescription.xml".to_owned(), about.into_bytes()),
        (format!("binaries/linux64/{IDENTIFIER}.so"), code),
        (format!("resources/{MODEL}"), resources.into_bytes()),
    ];
    let bytes = packed(&parts).map_err(|error| match error {
        zip::result::ZipError::Io(source) => ExportError::Write { path: out.into(), source },
        other => other.into(),
    })?;
    files::write(out, &bytes).map_err(|source| ExportError::Write { path: out.into(), source })
}

/// Whether this begins as a library for Linux on x86-64 does: ELF, 64 bits, shared, machine 62.
fn is_linux64(code: &[u8]) -> bool {
    code.starts_with(b"\x7fELF\x02\x01") && code.get(16..20) == Some(&[3, 0, 62, 0])
}

/// The tables that the library needs, and no other: brokers and folders are nobody else's.
fn resources(tables: &Tables) -> String {
    let needed = Tables {
        rig: tables.rig.clone(),
        r#loop: tables.r#loop,
        plant: tables.plant.clone(),
        effect: tables.effect.clone(),
        ..Tables::default()
    };
    toml::to_string(&needed).unwrap_or_default()
}

fn packed(parts: &[(String, Vec<u8>)]) -> Result<Vec<u8>, zip::result::ZipError> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    for (name, bytes) in parts {
        archive.start_file(name, options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}
