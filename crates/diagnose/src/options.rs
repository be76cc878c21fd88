//! Options of a search, and reports of its progress.

use std::fmt;
use std::sync::Arc;

/// Options of a search.
#[derive(Clone, Debug, Default, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Effects that the search must not consider, as if they were not in the catalogue.
    pub without: Vec<String>,
    /// Whether what no effect explains is left without a formula, whose search may take longer than all else.
    pub without_formula: bool,
    /// Whether the belief was fitted to a record of this rig, so that its noise contains what the model lacks.
    pub is_fitted: bool,
    /// The receiver of progress reports.
    #[serde(skip)]
    pub progress: Progress,
}

/// A report of progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressStep {
    /// This many further fits are planned: the results so far require them.
    Planned(usize),
    /// One of them is done.
    Made,
}

/// The receiver of progress reports; none by default. It is called from several threads.
#[derive(Clone, Default)]
pub struct Progress(Option<Arc<dyn Fn(ProgressStep) + Send + Sync>>);

impl Progress {
    /// Calls `who` at every step.
    pub fn new(who: impl Fn(ProgressStep) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(who)))
    }

    pub(crate) fn tell(&self, step: ProgressStep) {
        if let Some(who) = &self.0 {
            who(step);
        }
    }
}

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Progress(somebody)" } else { "Progress(nobody)" })
    }
}

#[cfg(test)]
mod tests {
    use super::{Progress, ProgressStep};
    use crate::tests_support::{model, record};
    use crate::{Options, diagnose};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_fit_that_was_planned_is_made() {
        let counts = Arc::new([AtomicUsize::new(0), AtomicUsize::new(0)]);
        let heard = Arc::clone(&counts);
        let progress = Progress::new(move |step| {
            let (which, by) = match step {
                ProgressStep::Planned(fits) => (0, fits),
                ProgressStep::Made => (1, 1),
            };
            heard[which].fetch_add(by, Ordering::Relaxed);
        });
        let found = diagnose(&model(), &record(&model(), 1, 30), &Options { progress, ..Options::default() });
        assert!(found.effects.is_empty());
        let [planned, made] = [&counts[0], &counts[1]].map(|count| count.load(Ordering::Relaxed));
        assert!(planned >= plant::Effects::CATALOGUE.len() && planned == made, "{made} of {planned}");
    }
}
