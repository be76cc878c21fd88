//! What a log says about its flight: version, command, seed, start, and the config in force.
//!
//! Two metadata records at the start of the file: `airball` (keys `version`, `command`, `seed`, `started`) and
//! `config` (key `toml`). A flight without a seed has no key `seed`.

use std::{
    collections::BTreeMap,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

/// Name of the metadata record about the flight.
pub(super) const ABOUT: &str = "airball";
/// Name of the metadata record with the config.
pub(super) const CONFIG: &str = "config";
/// Key of the config's text.
pub(super) const TOML: &str = "toml";

/// When every simulated flight starts, so that the same seed gives the same file.
pub const SIMULATED_START: SystemTime = UNIX_EPOCH;

/// About a flight, as it is written.
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

/// About a flight, as it was read. What a foreign or damaged file does not say is absent.
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
        about
    }
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

/// A moment in UTC, to the millisecond. Before 1970 is 1970.
#[must_use]
pub fn rfc3339(moment: SystemTime) -> String {
    let since = moment.duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO);
    let (days, second) = (since.as_secs() / 86_400, since.as_secs() % 86_400);
    let (year, month, day) = civil(days);
    let (hour, minute, second, ms) = (second / 3600, second / 60 % 60, second % 60, since.subsec_millis());
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{ms:03}Z")
}

/// Year, month and day of a count of days since 1970-01-01, in the Gregorian calendar.
///
/// Years begin in March here, so that the leap day is the last of its year.
/// Source: Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms", `civil_from_days`.
fn civil(days_since_1970: u64) -> (u64, u64, u64) {
    let days = days_since_1970 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (era * 400 + year_of_era + u64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::{About, Header, SIMULATED_START, rfc3339};
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn moments_are_written_as_the_calendar_has_them() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_399, "2000-02-28T23:59:59.000Z"),
            (951_782_400, "2000-02-29T00:00:00.000Z"),
            (1_000_000_000, "2001-09-09T01:46:40.000Z"),
            (4_107_542_400, "2100-03-01T00:00:00.000Z"),
        ] {
            assert_eq!(rfc3339(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
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
