//! Reading the config: the file, then its patches, later wins; then every number is checked.
//!
//! Every error is found by its dotted key, and the file and line of that key are looked up in the file that set it
//! last.

use super::error::{CONFIG_FLAG, ConfigError};
use super::merge::put_over;
use super::plain_words::plain_words;
use super::tables::Tables;
use super::words::{self, Words};
use super::written::{self, OWN_EFFECT_ADVICE};
use plant::Unsound;
use rows::shown;
use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// A config that has been read and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Its tables.
    pub tables: Tables,
    /// What the rig calls its position and its input.
    pub words: Words,
    /// The file, for messages.
    path: PathBuf,
    /// It and its patches, for the places of keys.
    sources: Vec<Source>,
}

/// A file that has been read, for looking up lines.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    /// The error of a text that is no TOML, with the first letters of what stands there.
    fn syntax(&self, error: &toml::de::Error) -> ConfigError {
        let at = error.span().map(|span| span.start).filter(|at| self.text.is_char_boundary(*at)).unwrap_or(0);
        let line_start = self.text[..at].rfind('\n').map_or(0, |end| end + 1);
        let (line, column) = (self.text[..at].matches('\n').count() + 1, self.text[line_start..at].chars().count() + 1);
        let rest = self.text[at..].lines().next().unwrap_or_default();
        let here = if rest.is_empty() { "the end of the line".into() } else { format!("`{}`", shown(rest)) };
        let place = format!("{}:{line}:{column}", self.path.display());
        ConfigError::Syntax { place, message: format!("no TOML at {here}: {}", error.message()) }
    }
}

impl Config {
    /// Reads `path`, merges `patches` over it in their order and checks the result.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn read(path: &Path, patches: &[PathBuf]) -> Result<Self, ConfigError> {
        let mut sources = vec![read_source(path, CONFIG_FLAG)?];
        for patch in patches {
            sources.push(read_source(patch, "`--patch FILE` or `--effects FILE`")?);
        }
        Self::of(sources)
    }

    /// The files that it was read from: the config, then what is merged over it.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.sources.iter().map(|source| source.path.as_path())
    }

    /// The same of texts: a config and its patches, each with the name that stands for its file.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key.
    pub fn of_texts(texts: impl IntoIterator<Item = (String, String)>) -> Result<Self, ConfigError> {
        Self::of(texts.into_iter().map(|(name, text)| Source { path: name.into(), text }).collect())
    }

    /// Names and texts of the config and its patches.
    pub fn texts(&self) -> impl Iterator<Item = (String, String)> {
        self.sources.iter().map(|source| (source.path.display().to_string(), source.text.clone()))
    }

    /// This config with one more patch over it.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line and key; `name` stands for the patch.
    pub fn patched(&self, name: &str, text: &str) -> Result<Self, ConfigError> {
        let patch = Source { path: name.into(), text: text.into() };
        Self::of(self.sources.iter().cloned().chain([patch]).collect())
    }

    fn of(sources: Vec<Source>) -> Result<Self, ConfigError> {
        let path = sources.first().map(|source| source.path.clone()).unwrap_or_default();
        let mut merged = merged(&sources)?;
        let words = words::take(&mut merged).map_err(|(key, message)| {
            let place = place(&sources, &key);
            ConfigError::Key { place, key, message }
        })?;
        let values = written::take(&mut merged);
        let mut tables: Tables = typed(merged, &sources)?;
        tables.turn_of_an_angle();
        written::define(&mut tables, values).map_err(|(key, message)| {
            let place = place(&sources, &key);
            ConfigError::Key { place, key, message }
        })?;
        tables.check().map_err(|(table, error)| {
            let place = place(&sources, &format!("{table}.{}", error.key()));
            match error {
                Unsound::Range(error) => ConfigError::Range { place, table, error },
                Unsound::Contradiction { .. } | Unsound::Exclusive { .. } => {
                    ConfigError::Contradiction { place, message: format!("{table}: {error}") }
                }
            }
        })?;
        tables.check_words().map_err(|(key, message)| ConfigError::Contradiction {
            place: place(&sources, key),
            message: format!("{key}: {message}"),
        })?;
        Ok(Self { tables, words, path, sources })
    }

    /// The config in force with the words of the rig, as TOML.
    #[must_use]
    pub fn to_toml_with_words(&self) -> String {
        let mut table = toml::Table::try_from(&self.tables).unwrap_or_default();
        if let (false, Ok(words)) = (self.words.is_ball_pipe(), toml::Table::try_from(&self.words)) {
            let rig = table.entry("rig").or_insert_with(|| toml::Value::Table(toml::Table::new()));
            rig.as_table_mut().into_iter().for_each(|rig| rig.extend(words.clone()));
        }
        toml::to_string(&table).unwrap_or_default()
    }

    /// The config in force, as TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Every table serialises: its keys are strings and its values numbers, strings and tables.
        toml::to_string(&self.tables).unwrap_or_default()
    }

    /// The file, as messages name it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The first line of the file, not of its patches.
    #[must_use]
    pub fn first_line(&self) -> &str {
        self.sources.first().and_then(|source| source.text.lines().next()).unwrap_or_default()
    }

    /// The table that `command` needs.
    ///
    /// # Errors
    /// [`ConfigError::Missing`] names the table, the file and the command.
    pub fn need<'a, T>(
        &'a self,
        command: &'static str,
        table: &'static str,
        get: impl Fn(&'a Tables) -> Option<&'a T>,
    ) -> Result<&'a T, ConfigError> {
        get(&self.tables).ok_or_else(|| self.missing(command, table))
    }

    /// Refuses written effects that depend on the setpoint, where it is not known, and `why` it is not.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line, key and column of the first one that is on or `is_tried` by a search.
    pub fn refuse_setpoint(&self, why: &str, is_tried: impl Fn(&str) -> bool) -> Result<(), ConfigError> {
        match written::setpoint_use(&self.tables, why, is_tried) {
            Some((key, message)) => Err(ConfigError::Key { place: place(&self.sources, &key), key, message }),
            None => Ok(()),
        }
    }

    /// The error that the table which `command` needs is absent.
    #[must_use]
    pub fn missing(&self, command: &'static str, table: &'static str) -> ConfigError {
        ConfigError::Missing { path: self.path.clone(), table, command }
    }
}

/// Reads any other TOML file of ours, for instance an experiment.
///
/// Returns the value and a function that finds the file and line of a dotted key.
///
/// # Errors
/// [`ConfigError`] names file, line and key.
pub fn parse_file<T: DeserializeOwned>(
    path: &Path,
    flag: &'static str,
) -> Result<(T, impl Fn(&str) -> String + use<T>), ConfigError> {
    parse_source(read_source(path, flag)?)
}

/// The same of a text that the program holds; `name` stands for the file.
///
/// # Errors
/// [`ConfigError`] names file, line and key.
pub fn parse_text<T: DeserializeOwned>(
    name: &str,
    text: &str,
) -> Result<(T, impl Fn(&str) -> String + use<T>), ConfigError> {
    parse_source(Source { path: name.into(), text: text.into() })
}

fn parse_source<T: DeserializeOwned>(source: Source) -> Result<(T, impl Fn(&str) -> String + use<T>), ConfigError> {
    let sources = vec![source];
    let value = parse(&sources)?;
    Ok((value, move |key: &str| place(&sources, key)))
}

fn read_source(path: &Path, flag: &'static str) -> Result<Source, ConfigError> {
    let text =
        fs::read_to_string(path).map_err(|source| ConfigError::Unreadable { path: path.to_owned(), source, flag })?;
    Ok(Source { path: path.to_owned(), text })
}

fn parse<T: DeserializeOwned>(sources: &[Source]) -> Result<T, ConfigError> {
    typed(merged(sources)?, sources)
}

/// All sources in one table, later ones over earlier ones.
fn merged(sources: &[Source]) -> Result<toml::Table, ConfigError> {
    let mut merged = toml::Table::new();
    for (number, source) in sources.iter().enumerate() {
        let table: toml::Table = toml::from_str(&source.text).map_err(|error| source.syntax(&error))?;
        if number == 0 {
            // The first one has nothing below it to take away.
            merged = table;
            continue;
        }
        put_over(&mut merged, table).map_err(|(key, message)| {
            let place = place(std::slice::from_ref(source), &key);
            ConfigError::Key { place, key, message }
        })?;
    }
    Ok(merged)
}

fn typed<T: DeserializeOwned>(merged: toml::Table, sources: &[Source]) -> Result<T, ConfigError> {
    serde_path_to_error::deserialize(merged).map_err(|error| {
        let key = error.path().to_string();
        let mut message = plain_words(error.into_inner().message());
        let is_effect = key.strip_prefix("plant.effects.").is_some_and(|name| !name.contains('.'));
        if is_effect && message.starts_with("unknown key") {
            message = format!("{message}; {OWN_EFFECT_ADVICE}");
        }
        let place = place(sources, &key);
        // At the top of a file the path is a dot.
        if key == "." { ConfigError::Syntax { place, message } } else { ConfigError::Key { place, key, message } }
    })
}

/// `file:line` of a dotted key: where the longest part of it is found, and among equals in the last file.
fn place(sources: &[Source], key: &str) -> String {
    let steps: Vec<&str> = key.split(['.', '[', ']']).filter(|step| !step.is_empty()).collect();
    let found = sources.iter().filter_map(|source| Some((source, find(&source.text, &steps)?)));
    match found.max_by_key(|(_, (depth, _))| *depth) {
        Some((source, (_, line))) => format!("{}:{line}", source.path.display()),
        None => sources.first().map_or_else(String::new, |source| source.path.display().to_string()),
    }
}

/// The number of parts of the key that exist in `text`, and the line of the last of them. `None`: not even the first.
fn find(text: &str, steps: &[&str]) -> Option<(usize, usize)> {
    let parsed = DeTable::parse(text).ok()?;
    let mut here: Option<&DeTable<'_>> = Some(parsed.get_ref());
    let mut array: Option<&[toml::Spanned<DeValue<'_>>]> = None;
    let mut found = None;
    for (depth, step) in steps.iter().enumerate() {
        let (start, value) = match (here, array) {
            (Some(table), _) => {
                let Some((key, value)) = table.iter().find(|(key, _)| key.get_ref() == step) else { break };
                (key.span().start, value.get_ref())
            }
            (None, Some(items)) => {
                let Some(item) = step.parse::<usize>().ok().and_then(|index| items.get(index)) else { break };
                (item.span().start, item.get_ref())
            }
            (None, None) => break,
        };
        found = Some((depth + 1, text[..start].matches('\n').count() + 1));
        here = value.as_table();
        array = value.as_array().map(|items| &items[..]);
    }
    found
}

#[cfg(test)]
mod tests;
