//! The withheld data, after their publication: the truth, and the bounds of each record.

use crate::output::note;
use crate::work::Done;
use anyhow::{Context, Result, ensure};
use score::{Bounds, Case, CaseTruth, Kind, Truth};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A published truth.
pub(crate) struct Sealed {
    truths: Vec<CaseTruth>,
    bounds: BTreeMap<String, Bounds>,
}

impl Sealed {
    /// Reads the truth, and the bounds where there are any.
    pub(crate) fn open(truth: &Path, bounds: Option<&Path>) -> Result<Self> {
        let opened: Truth = read(truth)?;
        ensure!(
            opened.schema == Truth::SCHEMA,
            "{} is a truth of the form {:?}, and this program reads {:?}; score it with the version that it was made for",
            truth.display(),
            opened.schema,
            Truth::SCHEMA
        );
        let bounds: Vec<Bounds> = bounds.map_or_else(|| Ok(Vec::new()), read)?;
        let bounds = bounds.into_iter().map(|bounds| (bounds.case.clone(), bounds)).collect();
        Ok(Self { truths: opened.cases, bounds })
    }

    /// The truth of a case.
    pub(crate) fn truth(&self, case: &str) -> Option<&CaseTruth> {
        self.truths.iter().find(|truth| truth.case == case)
    }

    /// `count` of the cases whose rig has one effect that is not in its belief, spread evenly over the set. An effect
    /// of the belief cannot be removed from the search by leaving its name out.
    pub(crate) fn to_leave_out(&self, count: usize, known: impl Fn(&str) -> bool) -> BTreeMap<String, String> {
        let added =
            |truth: &&CaseTruth| truth.kind == Kind::Single && truth.effects.iter().all(|e| e.change == "added");
        let all: Vec<&CaseTruth> = self.truths.iter().filter(added).filter(|truth| known(&truth.case)).collect();
        let count = count.min(all.len());
        let chosen = (0..count).filter_map(|k| all.get(k * all.len() / count));
        chosen.filter_map(|truth| Some((truth.case.clone(), truth.effects.first()?.name.clone()))).collect()
    }

    /// Truth and answers, case by case. A case that is missing on one side is reported and not scored.
    pub(crate) fn joined(mut self, done: Vec<Done>) -> Vec<Case> {
        let answered: BTreeSet<&str> = done.iter().map(|done| done.case.as_str()).collect();
        let missing = self.truths.iter().filter(|truth| !answered.contains(truth.case.as_str())).count();
        if missing > 0 {
            note(format_args!(
                "{missing} cases of the truth are not in the folder and are not scored; check the folder"
            ));
        }
        let mut truths: BTreeMap<String, CaseTruth> =
            self.truths.drain(..).map(|truth| (truth.case.clone(), truth)).collect();
        let mut cases = Vec::new();
        for done in done {
            let Some(truth) = truths.remove(&done.case) else {
                note(format_args!(
                    "{}: not in the truth, not scored; check that the truth is that of this folder",
                    done.case
                ));
                continue;
            };
            cases.push(Case {
                truth,
                bounds: self.bounds.remove(&done.case),
                answer: done.answer.ok(),
                left_out: done.left_out,
                true_shares: done.true_shares,
                shown: done.shown,
                pipe_length_mm: done.pipe_length_mm,
            });
        }
        cases
    }
}

fn read<T: DeserializeOwned>(file: &Path) -> Result<T> {
    let text = std::fs::read(file).with_context(|| format!("cannot read {}; check the name", file.display()))?;
    serde_json::from_slice(&text).with_context(|| {
        format!("{} does not have the form that the world writes; check that it is the right file", file.display())
    })
}
