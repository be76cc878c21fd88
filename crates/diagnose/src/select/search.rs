//! The problem that the selection of effects works on: a record, a belief, and the effects that may be named.

use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect, prior};
use crate::options::{Options, Progress, ProgressStep};
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::thresholds::FAR_FROM_BELIEF;
use plant::{Effects, Entry, Model, Noise};

/// A record, a belief, the folds, and the options of the search.
pub(crate) struct Search<'a> {
    pub(crate) problem: Problem<'a>,
    without: Vec<String>,
    /// Whether what no effect explains gets a formula.
    pub(crate) formula: bool,
    progress: Progress,
    /// Whether the noise of the belief hides what it lacks, see [`crate::select::slow_starts`].
    pub(crate) noise_hides: bool,
    /// The noise of its filter, if that is not fitted: the search is by forecasts.
    slow: Option<Noise>,
}

impl<'a> Search<'a> {
    pub(crate) fn new(belief: &'a Model, recording: &'a Recording, folds: &'a Folds, options: &Options) -> Self {
        let problem = Problem { recording, belief, folds, prior: Prior::Belief };
        let Options { without, without_formula, progress, .. } = options.clone();
        Self { problem, without, formula: !without_formula, progress, noise_hides: false, slow: None }
    }

    /// A search without options.
    pub(crate) fn of(problem: Problem<'a>) -> Self {
        Self {
            problem,
            without: Vec::new(),
            formula: true,
            progress: Progress::default(),
            noise_hides: false,
            slow: None,
        }
    }

    /// The same search without the effects for which `is_left_out` holds.
    pub(crate) fn without(&self, is_left_out: impl Fn(&Entry) -> bool) -> Self {
        let more = self
            .problem
            .belief
            .effects
            .catalogue()
            .filter(|entry| is_left_out(entry))
            .map(|entry| entry.name.to_owned());
        let without = self.without.iter().cloned().chain(more).collect();
        Self { without, progress: self.progress.clone(), ..*self }
    }

    /// The same search by forecasts: with a filter of this noise, and readings of the weight that `folds` gives them.
    pub(crate) fn by_forecasts<'b>(&'b self, folds: &'b Folds, noise: Noise) -> Search<'b> {
        let problem = Problem { folds, ..self.problem };
        Search { problem, slow: Some(noise), ..self.believing(self.problem.belief) }
    }

    /// The same search about another belief.
    pub(crate) fn believing<'b>(&'b self, belief: &'b Model) -> Search<'b> {
        let problem = Problem { belief, ..self.problem };
        Search { problem, without: self.without.clone(), progress: self.progress.clone(), ..*self }
    }

    /// The noise of a filter by forecasts; `None`: the search is by likelihood.
    pub(crate) fn slow_noise(&self) -> Option<Noise> {
        self.slow
    }

    /// Whether the search is by forecasts.
    pub(crate) fn is_by_forecasts(&self) -> bool {
        self.slow.is_some()
    }

    /// The model that forecasts: of a search by forecasts, with the noise that the owner believes.
    pub(crate) fn forecasting(&self, model: &Model) -> Model {
        let noise = if self.is_by_forecasts() { self.problem.belief.noise } else { model.noise };
        Model { noise, ..model.clone() }
    }

    /// The effects that may be named.
    pub(crate) fn entries(&self) -> Vec<&'static Entry> {
        let may = |entry: &&Entry| !self.without.iter().any(|name| name == entry.name);
        self.problem.belief.effects.catalogue().filter(may).collect()
    }

    /// Held-out log-likelihood plus log-prior of a fit, nats.
    pub(crate) fn held_out_total(&self, fit: &Fit) -> f64 {
        self.problem.held_out(fit).iter().sum::<f64>() + fit.log_prior
    }

    /// The fit without one of its effects, fitted again.
    pub(crate) fn removed(&self, fit: &Fit, entry: &Entry) -> Fit {
        self.without_effects(fit, &[entry])
    }

    /// The fit without some of its effects, fitted again.
    pub(crate) fn without_effects(&self, fit: &Fit, entries: &[&Entry]) -> Fit {
        let (model, parameters) = self.start_without(fit, entries);
        self.problem.fit(&model, &parameters)
    }

    /// The model and the parameters of a fit without some of its effects, from which it is fitted again.
    pub(crate) fn start_without(&self, fit: &Fit, entries: &[&Entry]) -> (Model, Vec<Parameter>) {
        let (mut model, mut parameters) = (fit.model.clone(), fit.parameters.clone());
        for entry in entries {
            model.effects.remove(entry.name);
            parameters.retain(|parameter| !parameter.is_of(entry.name));
            // The simpler effect that it contains and had replaced is restored.
            if let Some((part, values)) = entry
                .contains
                .and_then(|part| Some((Effects::built_in(part)?, self.problem.belief.effects.values(part)?)))
            {
                model.effects.set(part.name, &values);
                parameters.extend(parameters_of_effect(part, &values));
            }
        }
        (model, parameters)
    }

    /// Reports the number of fits to come.
    pub(crate) fn plan(&self, fits: usize) {
        self.progress.tell(ProgressStep::Planned(fits));
    }

    /// Runs a planned fit and reports it.
    pub(crate) fn planned<T>(&self, fit: impl FnOnce() -> T) -> T {
        let made = fit();
        self.progress.tell(ProgressStep::Made);
        made
    }

    /// Log-prior of gain, drag and hover.
    pub(crate) fn base_prior(&self, fit: &Fit) -> f64 {
        prior(&BASE[..3], &fit.model, self.problem.belief)
    }

    /// The model with gain, drag and hover of the belief.
    pub(crate) fn with_believed_base(&self, model: &Model) -> Model {
        Model { noise: model.noise, effects: model.effects.clone(), ..self.problem.belief.clone() }
    }

    /// Whether a fit moved the believed parameters further than owners are usually wrong. A belief that was fitted to
    /// the record knows nothing beyond the fit.
    pub(crate) fn is_far(&self, fit: &Fit) -> bool {
        if self.noise_hides {
            return false;
        }
        let moved: Vec<Parameter> = fit.parameters.iter().filter(|one| !one.is_noise()).copied().collect();
        prior(&moved, &fit.model, self.problem.belief) < -FAR_FROM_BELIEF
    }
}
