//! A config as a value.

use config::{Config, ConfigError};
use plant::Model;
use std::path::{Path, PathBuf};

/// A config that has been read and checked: the believed model of a rig, its loop, and how its logs are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief(pub(super) Config);

impl Belief {
    /// Reads a config, and patches over it.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn read(path: &Path, patches: &[PathBuf]) -> Result<Self, ConfigError> {
        Config::read(path, patches).map(Self)
    }

    /// The same of texts: a config and its patches, each with the name that stands for its file in messages.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn of_texts(texts: impl IntoIterator<Item = (String, String)>) -> Result<Self, ConfigError> {
        Config::of_texts(texts).map(Self)
    }

    /// Names and texts of the config and its patches.
    #[must_use]
    pub fn texts(&self) -> Vec<(String, String)> {
        self.0.texts().collect()
    }

    /// This config with a patch over it; `name` stands for the patch in messages.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn patched(&self, name: &str, text: &str) -> Result<Self, ConfigError> {
        self.0.patched(name, text).map(Self)
    }

    /// The config in force, as TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        self.0.to_toml_with_words()
    }

    /// The believed model, where the config has one.
    #[must_use]
    pub fn model(&self) -> Option<&Model> {
        self.0.tables.plant.as_ref()
    }

    /// Period of the control loop, seconds, where the config has it.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        self.0.tables.r#loop.map(|table| table.period_s)
    }

    /// The name of its file, as messages give it.
    #[must_use]
    pub fn name(&self) -> String {
        self.0.path().display().to_string()
    }
}
