//! What can be wrong with a config, with its place and the next thing to try.

use std::path::PathBuf;

/// What can be wrong with a config file or an experiment file.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}; name the file with {flag}{}", path.display(), or_init(flag))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// The flag that names such a file.
        flag: &'static str,
    },
    /// It is not TOML.
    #[error("{place}: {message}")]
    Syntax {
        /// File, line and column.
        place: String,
        /// What is wrong there, and the text there.
        message: String,
    },
    /// A key is unknown, missing or of the wrong type.
    #[error("{place}: {key}: {message}")]
    Key {
        /// File and line.
        place: String,
        /// The dotted key.
        key: String,
        /// What is wrong, and the known keys.
        message: String,
    },
    /// A number is outside its bounds.
    #[error("{place}: {table}.{error}; change it there")]
    Range {
        /// File and line.
        place: String,
        /// The dotted table.
        table: String,
        /// Key, value and bounds.
        error: control::OutOfRange,
    },
    /// A table that a command needs is absent.
    #[error(
        "{}: the table [{table}] is missing, and `airball {command}` needs it; {}",
        path.display(), where_from(table)
    )]
    Missing {
        /// The file.
        path: PathBuf,
        /// The table.
        table: &'static str,
        /// The command.
        command: &'static str,
    },
    /// A constraint between several keys does not hold.
    #[error("{place}: {message}")]
    Contradiction {
        /// File, and line where there is one.
        place: String,
        /// What contradicts what, and what to do.
        message: String,
    },
}

/// Where the owner of a config finds a table that it lacks.
fn where_from(table: &str) -> &'static str {
    match table {
        "plant" | "noise" => "`airball init LOG` proposes one for a log of the rig",
        _ => "copy it from the config.toml of the project, which the package holds too, and set it for the rig",
    }
}

/// How a config is made where there is none.
fn or_init(flag: &str) -> &'static str {
    if flag == CONFIG_FLAG { ", or let `airball init LOG` propose one for a log" } else { "" }
}

/// The flag that names a config.
pub(super) const CONFIG_FLAG: &str = "`--config FILE`";
