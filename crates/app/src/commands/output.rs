//! Standard output, which may be closed at any time: `println!` would panic. Standard error is in `standard_error`.

pub use crate::standard_error::fail;
pub(super) use crate::standard_error::{note, warn};

use crate::files;
use crate::report::kit::page::made::Made;
use crate::report::kit::{page, plot};
use crate::standard_error::for_reader;
use crate::started;
use anyhow::{Result, anyhow};
use std::fmt::Display;
use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};

/// A line of the result on standard output, control characters, which a log or an experiment may hold, escaped. On a
/// terminal it is wrapped.
pub(super) fn say(line: impl Display) -> Result<()> {
    let to = stdout().lock();
    let text = for_reader(&to, &line.to_string());
    Ok(writeln!({ to }, "{text}")?)
}

/// Announces the files that were written, each with what it is. Where standard output holds a document, on standard
/// error.
///
/// # Errors
/// A standard output that cannot be written.
pub(super) fn announce(json: bool, files: &[(&str, Option<&Path>)]) -> Result<()> {
    for (what, path) in files.iter().filter_map(|(what, path)| Some((what, (*path)?))) {
        if json {
            note(format_args!("wrote the {what} {}", path.display()));
        } else {
            say(format_args!("{what:<9} {}", path.display()))?;
        }
    }
    Ok(())
}

/// How a page is made: by the command as it was typed.
pub(super) fn typed() -> Made {
    Made::by(started::words().into_iter().skip(1))
}

/// An error, with those of its causes that its own text does not name.
#[must_use]
pub fn with_causes(error: &anyhow::Error) -> String {
    let in_a_line = |words: &str| words.split_whitespace().collect::<Vec<_>>().join(" ");
    error.chain().skip(1).map(|cause| in_a_line(&cause.to_string())).fold(error.to_string(), |said, cause| {
        if in_a_line(&said).contains(&cause) { said } else { format!("{said}; the cause: {cause}") }
    })
}

/// Flags that exclude each other: wrong usage, not a failed command.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Usage(pub String);

/// Refuses names for a picture and a page that another file has, and folders that cannot take these or the `others`,
/// each with what it is, before the computation begins.
///
/// # Errors
/// The file that is kept, or that cannot be written.
pub(super) fn may_write(
    picture: Option<&Path>,
    html: Option<&Path>,
    others: &[(&str, Option<&PathBuf>)],
) -> Result<()> {
    picture.map_or(Ok(()), plot::may_write)?;
    html.map_or(Ok(()), page::may_write)?;
    let asked: Vec<(&str, &PathBuf)> = others.iter().filter_map(|(what, path)| Some((*what, (*path)?))).collect();
    if let Some((what, path)) = asked.iter().find(|(_, path)| is_config(path)) {
        return Err(Usage(format!("{} is a config and is kept; give the {what} another name", path.display())).into());
    }
    asked.into_iter().try_for_each(|(what, path)| files::may_be_made(path).map_err(|error| failed(what, path, &error)))
}

/// Tables that a config has, and no patch.
const OF_CONFIG: [&str; 5] = ["import", "log", "loop", "rig", "safety"];

/// No config is so long, bytes.
const LONGEST_CONFIG: u64 = 1 << 20;

/// Whether a file is a config, which nobody wants to lose to a patch.
fn is_config(path: &Path) -> bool {
    // A device, as /dev/full, may never end.
    let is_text = std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() < LONGEST_CONFIG);
    let text = is_text.then(|| std::fs::read_to_string(path).ok()).flatten();
    let table = text.and_then(|text| text.parse::<toml::Table>().ok());
    table.is_some_and(|table| OF_CONFIG.iter().any(|key| table.contains_key(*key)))
}

/// Writes a requested file; `what` names it in the message.
///
/// # Errors
/// The file cannot be written; the message names it.
pub(super) fn write(what: &str, path: &Path, text: &str) -> Result<()> {
    files::write(path, text.as_bytes()).map_err(|error| failed(what, path, &error))
}

fn failed(what: &str, path: &Path, error: &std::io::Error) -> anyhow::Error {
    anyhow!("cannot write the {what} {}: {error}; check the folder", path.display())
}

/// Whether a command failed only because the reader of its output has closed it, as `head` does.
#[must_use]
pub fn reader_is_gone(error: &anyhow::Error) -> bool {
    let broken = |error: &std::io::Error| error.kind() == ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(broken))
}

#[cfg(test)]
mod tests {
    use super::{may_write, with_causes};
    use anyhow::anyhow;
    use std::path::Path;

    #[test]
    fn causes_that_an_error_does_not_name_follow_it_in_its_line_and_others_are_not_said_twice() {
        let innermost = anyhow!("no such\n  device");
        assert_eq!(
            with_causes(&innermost.context("bus 1 does not open").context("no flight; check the bus")),
            "no flight; check the bus; the cause: bus 1 does not open; the cause: no such device"
        );
        let named = anyhow!("no such\n  device").context("bus 1: no such device; check the wires");
        assert_eq!(with_causes(&named), "bus 1: no such device; check the wires");
    }

    #[test]
    fn a_folder_that_is_not_there_is_refused_for_every_kind_of_file() {
        let path = Path::new("nosuch/file");
        let (picture, page) = (may_write(Some(path), None, &[]), may_write(None, Some(path), &[]));
        let patch = may_write(None, None, &[("patch", Some(&path.to_owned()))]);
        for (what, refused) in [("picture", picture), ("page", page), ("patch", patch)] {
            let said = refused.unwrap_err().to_string();
            assert!(said.starts_with(&format!("cannot write the {what} nosuch/file: ")), "{said}");
        }
    }

    #[test]
    fn a_patch_takes_the_place_of_a_patch_and_not_of_a_config() {
        let folder = tempfile::tempdir().unwrap();
        let (config, patch) = (folder.path().join("rig.toml"), folder.path().join("mended.toml"));
        std::fs::write(&config, "[import]\ntime_s = { column = \"t\" }\n[plant]\ndrag_per_s = 1.0\n").unwrap();
        std::fs::write(&patch, "[plant]\ndrag_per_s = 1.0\n").unwrap();
        let said = may_write(None, None, &[("patch", Some(&config))]).unwrap_err().to_string();
        assert!(said.ends_with("rig.toml is a config and is kept; give the patch another name"), "{said}");
        assert!(may_write(None, None, &[("patch", Some(&patch))]).is_ok());
    }
}
