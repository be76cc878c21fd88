//! The binary `manual`: manual pages of `airball` and completions of its command line for shells, for the packages.

use airball::cli::Cli;
use anyhow::{Context, Result};
use clap::{Command, CommandFactory, Parser};
use clap_complete::Shell::{Bash, Fish, Zsh};
use std::fs;
use std::path::{Path, PathBuf};

/// Write the manual pages of airball and the completions for bash, fish and zsh
#[derive(Debug, Parser)]
#[command(name = "manual", version, max_term_width = 100)]
struct Manual {
    /// Write the files here; older ones are replaced
    out: PathBuf,
}

fn main() -> Result<()> {
    write(&Manual::parse().out)
}

/// Writes a page for each command and subcommand, and a file for each shell.
fn write(out: &Path) -> Result<()> {
    fs::create_dir_all(out).with_context(|| format!("cannot make the folder {}", out.display()))?;
    clap_mangen::generate_to(command(), out).context("cannot write the manual pages")?;
    for shell in [Bash, Fish, Zsh] {
        clap_complete::generate_to(shell, &mut command(), "airball", out).context("cannot write the completions")?;
    }
    Ok(())
}

fn command() -> Command {
    Cli::command()
}

#[cfg(test)]
mod tests {
    use super::{command, write};
    use clap::Command;
    use std::path::Path;

    /// Checks the page of a command and those of its subcommands.
    fn has_page(folder: &Path, name: &str, of: &Command) {
        let page = std::fs::read_to_string(folder.join(format!("{name}.1"))).unwrap_or_default();
        let shown = of.get_arguments().filter(|argument| !argument.is_hide_set());
        for flag in shown.filter_map(|argument| argument.get_long()) {
            assert!(page.replace('\\', "").contains(&format!("--{flag}")), "{name}: --{flag}: {page}");
        }
        for below in of.get_subcommands().filter(|below| !below.is_hide_set()) {
            has_page(folder, &format!("{name}-{}", below.get_name()), below);
        }
    }

    #[test]
    fn every_command_has_a_page_with_its_flags_and_every_shell_knows_them() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path()).unwrap();
        has_page(folder.path(), "airball", &command());
        assert!(!folder.path().join("airball-guard.1").exists());
        for file in ["airball.bash", "airball.fish", "_airball"] {
            let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
            assert!(text.contains("critical-gain") && text.contains("patch-out"), "{file}");
        }
    }
}
