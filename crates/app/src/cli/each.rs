//! The flags of `airball diagnose --each`.

use clap::Args;
use std::path::PathBuf;
use std::str::FromStr;

/// Diagnoses of many logs, each by itself.
#[derive(Clone, Debug, Default, Args)]
pub struct EachArgs {
    /// Diagnose each log by itself: a page and JSON each in --out, and one page and CSV of all; a folder stands for
    /// the logs in it. What is there already is not done again
    #[arg(long, requires = "out", conflicts_with_all = ["json", "html", "plot", "patch_out", "next_out", "missing_force", "init"])]
    pub each: bool,
    /// Folder of the reports of --each, created when missing
    #[arg(long, value_name = "DIR", requires = "each")]
    pub out: Option<PathBuf>,
    /// With --each: only the share I of N of the logs, so that N processes or machines do all of them
    #[arg(long, value_name = "I/N", requires = "each")]
    pub shard: Option<Shard>,
}

/// A share of some logs: the logs whose number is `index` modulo `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub index: usize,
    /// Number of shares.
    pub count: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || String::from("give I/N with I from 1 to N, for instance 3/40");
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let (index, count): (usize, usize) = index.parse().ok().zip(count.parse().ok()).ok_or_else(wrong)?;
        if (1..=count).contains(&index) { Ok(Self { index: index - 1, count }) } else { Err(wrong()) }
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn shares_are_counted_from_one() {
        assert_eq!("3/40".parse(), Ok(Shard { index: 2, count: 40 }));
        assert_eq!("1/1".parse(), Ok(Shard { index: 0, count: 1 }));
        for wrong in ["", "3", "0/4", "5/4", "-1/4", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
