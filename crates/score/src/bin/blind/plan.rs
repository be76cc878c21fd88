//! The diagnoses that are to be made, for whoever makes them elsewhere.

use crate::cli::BlindArgs;
use crate::folder::Folder;
use crate::sealed::Sealed;
use crate::work::{LEFT_OUT, again, file};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A diagnosis to be made: `airball diagnose RECORD --config BELIEF --without EFFECT … --json`.
#[derive(Debug, Serialize)]
pub(crate) struct Planned<'a> {
    record: &'a Path,
    belief: PathBuf,
    /// Effects that are left out of the search.
    without: Vec<String>,
    /// Where it is to be written, in the folder of `--verdicts`.
    verdict: PathBuf,
}

/// The diagnoses of all cases, and those with an effect left out.
pub(crate) fn of<'a>(args: &BlindArgs, folder: &'a Folder, sealed: Option<&Sealed>) -> Vec<Planned<'a>> {
    let again = again(args, folder, sealed);
    let planned = |(case, record): (&String, &'a PathBuf)| {
        let belief = folder.belief(case);
        let all = Planned { record, belief, without: args.without.clone(), verdict: file(Path::new(""), case) };
        let left_out = again.get(case).map(|effect| Planned {
            record,
            belief: all.belief.clone(),
            without: [&args.without[..], std::slice::from_ref(effect)].concat(),
            verdict: file(Path::new(LEFT_OUT), case),
        });
        std::iter::once(all).chain(left_out)
    };
    folder.records.iter().flat_map(planned).collect()
}
