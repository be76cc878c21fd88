//! The command line.

use clap::Parser;
use clap::builder::PossibleValuesParser;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Have airball diagnose a folder of withheld cases, and score the answers once the truth is known
#[derive(Debug, Parser)]
#[command(name = "blind", version, max_term_width = 100, args_override_self = true)]
#[command(after_help = "Exit status: 0 done, 1 failed, 2 wrong usage.")]
pub(crate) struct BlindArgs {
    /// Cases: case-NNN.csv or case-NNN.csv.zst, and case-NNN.toml with what the owner believes
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Write the diagnosis of each case here, as `airball diagnose --json` prints it
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Take the diagnoses from here, where --out wrote them, and make none
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "without", "jobs", "airball"])]
    pub(crate) verdicts: Option<PathBuf>,
    /// Score the answers against this truth (world.truth/1)
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
    /// What each record could tell at best: nats and Cramér–Rao deviations
    #[arg(long, value_name = "FILE", requires = "truth")]
    pub(crate) bounds: Option<PathBuf>,
    /// Never name this effect, as if the catalogue did not hold it; may be given again
    #[arg(long, value_name = "EFFECT", value_parser = effect())]
    pub(crate) without: Vec<String>,
    /// Diagnose so many of the rigs with one added effect again, that effect left out of the search
    #[arg(long, value_name = "N", default_value_t = 0, requires = "truth")]
    pub(crate) leave_out: usize,
    /// Threads [default: one a core]; the answers do not depend on it
    #[arg(long, value_name = "N")]
    pub(crate) jobs: Option<NonZeroUsize>,
    /// The program to be judged [default: the airball beside this program]
    #[arg(long, value_name = "FILE")]
    pub(crate) airball: Option<PathBuf>,
    /// Print the diagnoses that are to be made, each as a line of JSON, and make none: for --verdicts, made elsewhere
    #[arg(long, conflicts_with_all = ["out", "verdicts", "jobs", "airball", "json"])]
    pub(crate) plan: bool,
    /// Write the result as JSON, and nothing else, to standard output
    #[arg(long)]
    pub(crate) json: bool,
}

fn effect() -> PossibleValuesParser {
    PossibleValuesParser::new(plant::Effects::CATALOGUE.iter().map(|entry| entry.name))
}

#[cfg(test)]
mod tests {
    use super::BlindArgs;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        BlindArgs::command().debug_assert();
    }
}
