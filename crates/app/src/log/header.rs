//! Metadata of a log: version, command, seed, start, and the config in force.
//!
//! Two metadata records at the start of the file: `airball` (keys `version`, `command`, `seed`, `started`) and `config`
//! (key `toml`). A flight without a seed has no key `seed`. Metadata have no checksum in MCAP, so each record has its
//! own (key `crc32`), to detect a damaged config.

use crate::flight::wall_clock::rfc3339;
use std::{
    collections::BTreeMap,
    time::{SystemTime, UNIX_EPOCH},
};

/// Name of the metadata record about the flight.
pub(super) const ABOUT: &str = "airball";
/// Name of the metadata record with the config.
pub(super) const CONFIG: &str = "config";
/// Key of the config's text.
pub(super) const TOML: &str = "toml";

/// Key of a record's checksum.
const CHECKSUM: &str = "crc32";

/// Start of every simulated flight, so that the same seed gives the same file.
pub const SIMULATED_START: SystemTime = UNIX_EPOCH;

/// Metadata of a flight, as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Version of the program.
    pub version: String,
    /// The command line, as typed.
    pub command: String,
    /// Seed of the simulated rig's noise.
    pub seed: Option<u64>,
    /// Wall clock at time 0 of the flight; [`SIMULATED_START`] in virtual time.
    pub started: SystemTime,
    /// The config in force, as text.
    pub config_toml: String,
}

/// Metadata of a flight, as read. Values that a foreign or damaged file lacks are absent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// Version of the program that wrote the log.
    pub version: Option<String>,
    /// The command line.
    pub command: Option<String>,
    /// Seed of the simulated rig's noise.
    pub seed: Option<u64>,
    /// Wall clock at time 0, in UTC, as RFC 3339 writes it.
    pub started: Option<String>,
}

impl Header {
    /// The record [`ABOUT`].
    pub(super) fn about(&self) -> BTreeMap<String, String> {
        let mut about = BTreeMap::from([
            ("version".into(), self.version.clone()),
            ("command".into(), self.command.clone()),
            ("started".into(), rfc3339(self.started)),
        ]);
        about.extend(self.seed.map(|seed| ("seed".into(), seed.to_string())));
        sealed(about)
    }

    /// The record [`CONFIG`].
    pub(super) fn config(&self) -> BTreeMap<String, String> {
        sealed(BTreeMap::from([(TOML.into(), self.config_toml.clone())]))
    }
}

/// The entries with their checksum.
fn sealed(mut entries: BTreeMap<String, String>) -> BTreeMap<String, String> {
    entries.insert(CHECKSUM.into(), checksum(&entries));
    entries
}

/// Whether the entries are unchanged. Logs from before there was a checksum are accepted.
pub(super) fn is_intact(entries: &BTreeMap<String, String>) -> bool {
    entries.get(CHECKSUM).is_none_or(|sum| *sum == checksum(entries))
}

/// CRC-32 (as in zip) of the entries except the checksum, each text ended by a zero byte, in the order of the keys.
fn checksum(entries: &BTreeMap<String, String>) -> String {
    let mut hasher = crc32fast::Hasher::new();
    for (key, value) in entries.iter().filter(|(key, _)| *key != CHECKSUM) {
        for text in [key, value] {
            hasher.update(text.as_bytes());
            hasher.update(&[0]);
        }
    }
    format!("{:08x}", hasher.finalize())
}

impl From<&BTreeMap<String, String>> for About {
    fn from(about: &BTreeMap<String, String>) -> Self {
        let text = |key: &str| about.get(key).cloned();
        Self {
            version: text("version"),
            command: text("command"),
            seed: text("seed").and_then(|seed| seed.parse().ok()),
            started: text("started"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{About, Header, SIMULATED_START, is_intact, rfc3339};
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn moments_are_written_in_utc_and_none_is_too_early() {
        assert_eq!(rfc3339(UNIX_EPOCH + Duration::from_millis(951_782_400_250)), "2000-02-29T00:00:00.250Z");
        assert_eq!(rfc3339(UNIX_EPOCH - Duration::from_secs(1)), "1970-01-01T00:00:00.000Z");
    }

    #[test]
    fn a_record_with_another_letter_is_not_intact() {
        let header = Header {
            version: "1.2.3".into(),
            command: "airball run".into(),
            seed: None,
            started: SIMULATED_START,
            config_toml: "period_s = 0.02".into(),
        };
        let mut config = header.config();
        assert!(is_intact(&config) && is_intact(&header.about()));
        config.insert("toml".into(), "period_s = 0.12".into());
        assert!(!is_intact(&config));
        config.remove("crc32");
        assert!(is_intact(&config));
    }

    #[test]
    fn a_flight_without_a_seed_says_none() {
        let header = Header {
            version: "1.2.3".into(),
            command: "airball run".into(),
            seed: None,
            started: SIMULATED_START,
            config_toml: String::new(),
        };
        assert!(!header.about().contains_key("seed"));
        assert_eq!(About::from(&header.about()).seed, None);
        let seeded = Header { seed: Some(u64::MAX), ..header };
        assert_eq!(About::from(&seeded.about()).seed, Some(u64::MAX));
    }
}
