//! The last fault, in a small file of JSON, so that it is known after a restart of the program or of the computer.

use crate::files;
use crate::flight::wall_clock::rfc3339;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Why the last flight that a fault ended has ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LastFault {
    /// Time in UTC, as RFC 3339 writes it.
    pub at: String,
    /// The fault in words, with the next step.
    pub fault: String,
    /// The log of that flight, if it had one.
    pub log: Option<PathBuf>,
    /// When the first flight without a fault after it has ended, as `at`; `None`: there was none so far.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acknowledged: Option<String>,
}

impl LastFault {
    /// A fault at the present time.
    #[must_use]
    pub fn now(fault: String, log: Option<&Path>) -> Self {
        Self { at: rfc3339(SystemTime::now()), fault, log: log.map(Path::to_owned), acknowledged: None }
    }

    /// The fault, acknowledged at the present time by a flight without one; `None` if an earlier flight has done so.
    #[must_use]
    pub fn acknowledged(self) -> Option<Self> {
        let now = || rfc3339(SystemTime::now());
        self.acknowledged.is_none().then(|| Self { acknowledged: Some(now()), ..self })
    }

    /// Writes the file, completely or not at all, and forces it onto the disk: a power cut may follow.
    ///
    /// # Errors
    /// What the system reported.
    pub fn keep(&self, path: &Path) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        files::write(path, self.json().as_bytes())
    }

    /// The stored fault, if there is one that can be read.
    #[must_use]
    pub fn read(path: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(path).ok()?).ok()
    }

    /// Its text in the file and on MQTT.
    #[must_use]
    pub fn json(&self) -> String {
        // Plain values always serialise.
        serde_json::to_string(self).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::LastFault;
    use std::path::Path;

    #[test]
    fn a_fault_that_was_kept_is_read_again_and_the_next_takes_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flights/last-fault.json");
        assert_eq!(LastFault::read(&path), None);
        let first = LastFault::now("the ball is stuck".into(), Some(Path::new("flights/a.mcap")));
        first.keep(&path).unwrap();
        assert_eq!(LastFault::read(&path), Some(first));
        let second = LastFault::now("no new range".into(), None);
        second.keep(&path).unwrap();
        assert_eq!(LastFault::read(&path), Some(second));
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(!text.contains("acknowledged"), "{text}");
        std::fs::write(&path, "half of a fi").unwrap();
        assert_eq!(LastFault::read(&path), None);
    }
}
