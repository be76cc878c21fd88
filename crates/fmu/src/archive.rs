//! The file of an FMU.

use super::description::description;
use super::variables::variables;
use super::{IDENTIFIER, MODEL, Platform, period_s};
use config::{Config, ConfigError, Tables};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Why there is no FMU.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The config has no model.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The archive cannot be made.
    #[error("cannot pack the FMU: {0}")]
    Pack(#[from] zip::result::ZipError),
}

/// The bytes of the FMU of a config. `libraries`: the compiled `crates/fmu-c`, one for each platform. The same config
/// and libraries give the same bytes.
///
/// # Errors
/// A config without a model.
pub fn archive(config: &Config, libraries: Vec<(Platform, Vec<u8>)>) -> Result<Vec<u8>, ArchiveError> {
    let model = config.need("export fmu", "plant", |tables| tables.plant.as_ref())?;
    let resources = resources(&config.tables);
    let name = config.tables.rig.as_ref().map_or("rig", |rig| rig.name.as_str());
    let about = description(&variables(model), name, period_s(config), &resources);
    let mut parts = vec![("modelDescription.xml".to_owned(), about.into_bytes())];
    parts.extend(libraries.into_iter().map(|(platform, code)| {
        let (folder, ending) = platform.place();
        (format!("binaries/{folder}/{IDENTIFIER}.{ending}"), code)
    }));
    parts.push((format!("resources/{MODEL}"), resources.into_bytes()));
    Ok(packed(&parts)?)
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

#[cfg(test)]
mod tests {
    use super::{Platform, archive};
    use config::Config;
    use std::io::Cursor;
    use std::path::Path;
    use zip::ZipArchive;

    fn config() -> Config {
        Config::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config.toml"), &[]).unwrap()
    }

    fn names(bytes: Vec<u8>) -> Vec<String> {
        let archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
        archive.file_names().map(|name| name.unwrap().into_owned()).collect()
    }

    #[test]
    fn each_library_is_where_a_tool_of_its_platform_looks_for_it() {
        let libraries = vec![(Platform::Linux64, vec![1]), (Platform::Win64, vec![2])];
        let both = names(archive(&config(), libraries).unwrap());
        let wanted = ["binaries/linux64/airball.so", "binaries/win64/airball.dll", "resources/model.toml"];
        assert_eq!(both, [&["modelDescription.xml"], &wanted[..]].concat());
        let one = names(archive(&config(), vec![(Platform::Linux64, vec![1])]).unwrap());
        assert!(!one.iter().any(|name| name.contains("win64")), "{one:?}");
    }

    #[test]
    fn the_same_config_and_libraries_give_the_same_bytes() {
        let made = || archive(&config(), vec![(Platform::Win64, vec![2; 1000])]).unwrap();
        assert_eq!(made(), made());
    }
}
