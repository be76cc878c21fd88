//! The program that is scored, run as a process: `airball diagnose --json` on one case.

use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Number of threads of a program that uses rayon.
const THREADS: &str = "RAYON_NUM_THREADS";
/// Exit status of a diagnosis whose record cannot answer.
const NO_ANSWER: i32 = 3;

/// A built `airball`.
pub(crate) struct Airball {
    program: PathBuf,
    /// Threads of each run.
    threads: usize,
}

impl Airball {
    /// The named program, or the one next to this program. Each run has `threads` threads.
    pub(crate) fn find(named: Option<&Path>, threads: usize) -> Result<Self> {
        let beside = || Ok::<_, std::io::Error>(std::env::current_exe()?.with_file_name("airball"));
        let program = named.map_or_else(beside, |named| Ok(named.to_owned()));
        let program = program.context("the folder of this program is not known; name the airball with --airball")?;
        ensure!(
            program.is_file(),
            "there is no program {}; build it with `cargo build --release --package airball`, or name another with --airball",
            program.display()
        );
        // A bare name would be searched in the PATH.
        let program = program.canonicalize().with_context(|| format!("cannot look at {}", program.display()))?;
        Ok(Self { program, threads })
    }

    /// The document of a diagnosis, as it was printed.
    pub(crate) fn diagnose(&self, record: &Path, belief: &Path, without: &[String]) -> Result<Vec<u8>> {
        let mut command = Command::new(&self.program);
        command.arg("diagnose").arg(record).arg("--config").arg(belief).arg("--json");
        without.iter().for_each(|name| _ = command.args(["--without", name]));
        command.env(THREADS, self.threads.to_string()).stdin(Stdio::null());
        let ran = command.output().with_context(|| format!("cannot run {}", self.program.display()))?;
        if ran.status.success() || ran.status.code() == Some(NO_ANSWER) {
            return Ok(ran.stdout);
        }
        let said = String::from_utf8_lossy(&ran.stderr);
        match said.trim().trim_start_matches("error: ") {
            "" => bail!("{} ended with {} and said nothing", self.program.display(), ran.status),
            reason => bail!("{reason}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Airball;
    use std::path::Path;

    #[test]
    fn a_program_that_is_not_there_is_answered_with_how_to_build_it() {
        let error = Airball::find(Some(Path::new("no/such/airball")), 1).err().unwrap().to_string();
        assert!(
            error.contains("no/such/airball") && error.contains("cargo build --release --package airball"),
            "{error}"
        );
    }
}
