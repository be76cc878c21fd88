//! What the blind scoring of diagnoses needs of this crate: its log-likelihoods, and its measure of a gap.
//!
//! ```text
//! nats = ln p(record | rig) − max over rivals of ln p(record | rival)
//! ```
//!
//! The rig has its true parameters; only its two noises are fitted, as for the rivals. The rivals are fitted to the
//! whole record without a prior: the belief, with its other effects refitted and the departure as believed; and the
//! same with each effect of the catalogue added that is neither the true one nor a twin of it. Of two departures, each
//! is left out in turn while the other is present.
//!
//! The rivals come from the search under test: an effect that it does not find is no rival here either.

pub use crate::gap::share_closed::{is_open, share_closed};

use crate::fit::estimate::Problem;
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::record::folds::Folds;
use crate::record::prepare::prepared;
use crate::record::recording::Recording;
use crate::select::candidates::candidates;
use crate::select::refit::with_noise_that_fits;
use crate::select::search::Search;
use plant::{Entry, Model};

/// An effect by which a rig differs from its belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Departure<'a> {
    /// Its name.
    pub name: &'a str,
    /// Effects that imitate it, and so are no rivals of it.
    pub twins: &'a [&'a str],
}

/// The difference in log-likelihood, nats, between `rig` and its best rival on `recording`; with several departures,
/// the smallest. `None`: there is no departure.
#[must_use]
pub fn nats_above_rivals(
    belief: &Model,
    rig: &Model,
    departures: &[Departure<'_>],
    recording: &Recording,
) -> Option<f64> {
    let (_, recording) = prepared(std::slice::from_ref(recording), belief);
    let folds = Folds::new(belief, &recording);
    let problem = Problem { recording: &recording, belief, folds: &folds, prior: Prior::Nothing };
    let truly = problem.total_of(&problem.fit(rig, &[Parameter::SensorNoise, Parameter::AirNoise]));
    let above = |departure: &Departure<'_>| truly - best_rival(problem, rig, departures, departure);
    departures.iter().map(above).reduce(f64::min)
}

/// ln p of the best model in which `departure` is as believed, and the other departures as in `rig`.
fn best_rival(problem: Problem<'_>, rig: &Model, departures: &[Departure<'_>], departure: &Departure<'_>) -> f64 {
    let name = departure.name;
    let mut start = problem.belief.clone();
    for other in departures.iter().filter(|other| other.name != name) {
        match rig.effects.values(other.name) {
            Some(values) => start.effects.set(other.name, &values),
            None => start.effects.remove(other.name),
        };
    }
    let others = start.effects.present().into_iter().filter(|entry| entry.name != name);
    let of_effect =
        |entry: &'static Entry| parameters_of_effect(entry, &start.effects.values(entry.name).unwrap_or_default());
    let parameters: Vec<Parameter> = BASE.into_iter().chain(others.flat_map(of_effect)).collect();
    let search = Search::of(problem).without(|entry| entry.name == name || departure.twins.contains(&entry.name));
    start.noise = with_noise_that_fits(&problem, &parameters).noise;
    let as_believed = problem.fit(&start, &parameters);
    let rivals = candidates(&search, &as_believed).0;
    let rivals = rivals.iter().map(|rival| problem.total_of(&rival.fit));
    rivals.fold(problem.total_of(&as_believed), f64::max)
}
