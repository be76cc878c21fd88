//! Flags of a command, given as words.

use crate::cli::{Cli, Command};
use crate::commands::Usage;
use anyhow::Result;
use clap::Parser;

/// The command that these words give.
///
/// # Errors
/// [`Usage`] with what clap says of the first word that is wrong.
pub(super) fn command(words: &[&str], flags: &[String]) -> Result<Command> {
    let all = std::iter::once("airball").chain(words.iter().copied()).chain(flags.iter().map(String::as_str));
    match Cli::try_parse_from(all) {
        Ok(cli) => Ok(cli.command),
        Err(error) => Err(Usage(said(&error.to_string())).into()),
    }
}

/// The first paragraph, without the word that begins it: what is wrong, and not the usage of the command.
fn said(text: &str) -> String {
    let first = text.split("\n\n").next().unwrap_or_default();
    let words = first.trim_start_matches("error:").split_whitespace().collect::<Vec<_>>();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::command;

    #[test]
    fn a_wrong_flag_is_told_without_the_usage_of_the_command() {
        let error = command(&["design", "lqr"], &["--control".into(), "much".into()]).unwrap_err().to_string();
        assert_eq!(error, "invalid value 'much' for '--control <R>': invalid float literal");
    }
}
