//! The files of a flight so far: for the writer, and for the summary before or after the last file is closed.

use crate::locked::locked;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

/// A list that its copies share. Never empty.
#[derive(Clone, Debug)]
pub struct Files(Arc<Mutex<Vec<PathBuf>>>);

impl Files {
    /// A flight that begins with this file.
    #[must_use]
    pub fn starting_with(first: &Path) -> Self {
        Self(Arc::new(Mutex::new(vec![first.to_owned()])))
    }

    /// The flight goes on in another file.
    pub fn add(&self, path: &Path) {
        self.held().push(path.to_owned());
    }

    /// All of them, the oldest first, including those that were deleted to free space.
    #[must_use]
    pub fn all(&self) -> Vec<PathBuf> {
        self.held().clone()
    }

    /// The file that is being written.
    #[must_use]
    pub fn current(&self) -> PathBuf {
        self.held().last().cloned().unwrap_or_default()
    }

    fn held(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        locked(&self.0)
    }
}
