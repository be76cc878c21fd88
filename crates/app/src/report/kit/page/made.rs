//! How a page was made: what its head says, so that it can be made again.

use super::parts::command;
use crate::log::header::About;
use config::USUAL;
use config::words::Words;
use maud::{Markup, html};
use plant::Model;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Digits of the digest of a model: enough to tell two versions of a config apart.
const DIGITS: usize = 8;

/// The command, and what identifies its sources.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// The command line, as a shell reads it.
    command: String,
    /// Dates and seeds of the logs, version of the model.
    sources: Vec<String>,
    /// The flags that name the config, as a shell reads them, with a space before each.
    config: String,
    /// What the rig calls its position and its input.
    pub(super) words: Words,
}

impl Made {
    /// By these arguments of the program.
    #[must_use]
    pub fn by(arguments: impl Iterator<Item = String>) -> Self {
        Self { command: command_line(arguments), ..Self::default() }
    }

    /// With the words of the rig.
    #[must_use]
    pub fn in_words(self, words: &Words) -> Self {
        Self { words: words.clone(), ..self }
    }

    /// With the files of the config: the config, then what is merged over it. The commands that follow name them too;
    /// the usual config needs no flag.
    #[must_use]
    pub fn in_config(self, files: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        let flags = files.into_iter().enumerate().map(|(k, file)| match (k, file.as_ref().display().to_string()) {
            (0, config) if config == USUAL => String::new(),
            (0, config) => format!(" --config {}", shell_word(&config)),
            (_, patch) => format!(" --patch {}", shell_word(&patch)),
        });
        Self { config: flags.collect(), ..self }
    }

    /// A command that follows, with the config of this one: its flags stand before those of `line`, so that a patch of
    /// `line` wins.
    #[must_use]
    pub fn then(&self, line: &str) -> Markup {
        let (first, flags) = line.split_at(line.find(" --").unwrap_or(line.len()));
        command(&format!("{first}{}{flags}", self.config))
    }

    /// With the version of the model.
    #[must_use]
    pub fn of_model(mut self, model: &Model) -> Self {
        self.sources.push(version(model));
        self
    }

    /// With what a log says of itself. `name`: its name, where there are several.
    #[must_use]
    pub fn with_log(mut self, name: Option<&str>, about: &About) -> Self {
        let of = name.map_or(String::new(), |name| format!("{name}: "));
        // A simulated flight has no date of its own.
        let started = about.started.as_ref().filter(|_| about.seed.is_none());
        self.sources.extend(started.map(|started| format!("{of}flown {started}")));
        self.sources.extend(about.seed.map(|seed| format!("{of}seed {seed}")));
        self
    }

    #[cfg(test)]
    pub(super) fn command(&self) -> &str {
        &self.command
    }

    pub(super) fn sources(&self) -> &[String] {
        &self.sources
    }

    pub(super) fn head(&self) -> Markup {
        html! { p.made { "airball " (env!("CARGO_PKG_VERSION")) ": " (command(&self.command)) } }
    }
}

/// The version of a model: the beginning of a digest of its numbers, the same for the same numbers.
#[must_use]
pub fn version(model: &Model) -> String {
    let numbers = toml::to_string(model).unwrap_or_default();
    let digest: String = Sha256::digest(numbers).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("model {}", &digest[..DIGITS])
}

/// The command that makes the page again, as a shell reads it.
fn command_line(arguments: impl Iterator<Item = String>) -> String {
    let words = arguments.map(|word| shell_word(&word));
    std::iter::once("airball".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A word as a shell reads it.
pub fn shell_word(word: &str) -> String {
    let plain = !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "._-/:=+,%@".contains(c));
    if plain { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::Made;
    use crate::analysis::closed_loop::tests::project;
    use crate::log::header::About;

    #[test]
    fn the_head_says_the_command_the_seed_the_date_and_the_version_of_the_model() {
        let model = project().plant.unwrap();
        let about = About { seed: Some(7), started: Some("2026-01-02T03:04:05Z".into()), ..About::default() };
        let words = ["diagnose", "my log.csv", "it's"].map(String::from);
        let made = Made::by(words.into_iter()).of_model(&model).with_log(Some("a"), &about);
        assert_eq!(made.command, "airball diagnose 'my log.csv' 'it'\\''s'");
        assert_eq!(made.sources[1..], ["a: seed 7"]);
        let flown = Made::default().with_log(None, &About { seed: None, ..about });
        assert_eq!(flown.sources, ["flown 2026-01-02T03:04:05Z"]);
        let mut other = model.clone();
        other.drag_per_s += 0.1;
        let version = |model| Made::default().of_model(model).sources[0].clone();
        assert!(version(&model) == made.sources[0] && version(&other) != made.sources[0]);
    }

    #[test]
    fn commands_that_follow_name_the_config_and_its_patches_before_their_own() {
        let then = |files: &[&str]| {
            let line = Made::default().in_config(files).then("airball replay LOG --patch mended.toml").into_string();
            line.replace("<span>", "").replace("</span>", "")
        };
        let typed = |line: &str| format!("<code class=\"typed\">{line}</code>");
        assert_eq!(then(&["config.toml"]), typed("airball replay LOG --patch mended.toml"));
        assert_eq!(
            then(&["my rig.toml", "a.toml"]),
            typed("airball replay LOG --config 'my rig.toml' --patch a.toml --patch mended.toml")
        );
        assert_eq!(Made::default().then("airball simulate").into_string().matches("--config").count(), 0);
    }
}
