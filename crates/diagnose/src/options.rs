//! How to search, and how far a search has come, for whoever waits for it.

use std::fmt;
use std::sync::Arc;

/// How to search.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Effects that the search may not name, as if the catalogue did not hold them.
    pub without: Vec<String>,
    /// Who is told how far the search has come.
    pub progress: Progress,
}

/// News of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressStep {
    /// So many fits more are to be made: what is found makes further ones worthwhile.
    Planned(usize),
    /// One of them has been made.
    Made,
}

/// Who is told; nobody by default. Told from several threads.
#[derive(Clone, Default)]
pub struct Progress(Option<Arc<dyn Fn(ProgressStep) + Send + Sync>>);

impl Progress {
    /// Tells `who`.
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
