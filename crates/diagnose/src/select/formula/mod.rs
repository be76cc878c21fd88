//! The unexplained as a formula: the smallest sum of shapes that forecasts stretches to which it was not fitted.
//!
//! ```text
//! model → + best shape → + next shape …      each must gain held-out log-likelihood, lower the held-out error at 1 s,
//!                                            and not raise that of free runs by more than chance
//! ```
//!
//! The shapes are ranked by a score test over the places where they may act: one filter run for all of them. The best
//! ones are fitted, and the one that forecasts best is added.

mod shape;
mod shapes;
mod signals;

use crate::fit::derivatives::KnownSensitivities;
use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::Parameter;
use crate::residual::score_test::FilterRun;
use crate::select::forecast::{Evaluated, deviations, deviations_at_all_horizons, deviations_of_free_runs};
use crate::select::screening::added;
use crate::select::search::Search;
use crate::select::written_scan::{Linearised, Maximum};
use crate::thresholds::{
    BETTER_FORECAST, COST_OF_A_PARAMETER, ENOUGH_CLOSED, FIRST_EFFECT, FORMULA_FORECAST, MOST_SHAPES, SECOND_EFFECT,
};
use plant::{Definition, Entry, Model};
use rayon::prelude::*;
use shapes::shapes;
use signals::Signals;

/// How many shapes are fitted briefly from a place, and how many of these in full.
const BRIEFLY: usize = 4;
const IN_FULL: usize = 2;
/// Scoring steps of a brief fit.
const STEPS: usize = 2;

/// The shapes that were found, and the model with them.
pub(crate) struct Formula {
    pub(crate) shapes: Vec<&'static Definition>,
    pub(crate) evaluated: Evaluated,
    /// The named effects that the shapes make redundant, and that close less than half of what is closed.
    pub(crate) redundant: Vec<&'static Entry>,
    /// The named effects that a shape could stand for, and that are kept: they close at least half.
    pub(crate) matched: Vec<&'static Entry>,
}

/// The formula beyond `with_names`, which has the effects `named` on the refitted belief. A shape that alone is as
/// likely as all of these, and forecasts better, takes their place, unless they close at least half of what it closes:
/// a flexible shape follows any effect of its variables, and small unmodelled effects beside it. Shapes are added while
/// the forecasts get better by more than chance; then the effects that are redundant beside them are removed, by the
/// same rule. The formula has no shapes where none makes the forecasts better. `None`: the record is too short.
pub(crate) fn formula(
    search: &Search<'_>,
    refitted: &Evaluated,
    with_names: &Evaluated,
    named: &[&'static Entry],
) -> Option<Formula> {
    let problem = search.problem;
    let all = shapes(&Signals::of(&problem, &refitted.fit)?);
    let belief = with_known(problem.belief, &all);
    let search = &search.believing(&belief);
    let known = |of: &Evaluated| Evaluated {
        fit: Fit { model: with_known(&of.fit.model, &all), ..of.fit.clone() },
        ..of.clone()
    };
    let instead = if named.is_empty() { None } else { next_shape(search, &known(refitted), &all) };
    let beats_names = |alone: &Evaluated| {
        alone.log_likelihood > with_names.log_likelihood
            && deviations_at_all_horizons(&with_names.errors, &alone.errors) > BETTER_FORECAST
    };
    let names = Names { refitted, with_names, named };
    let instead = instead.filter(|(_, alone)| beats_names(alone));
    let matched = if instead.is_some() { named.to_vec() } else { Vec::new() };
    let mut found = match instead.filter(|(_, alone)| !names.close_half_of(alone)) {
        Some((shape, alone)) => {
            Formula { shapes: vec![shape], evaluated: alone, redundant: matched, matched: Vec::new() }
        }
        None => Formula { shapes: Vec::new(), evaluated: known(with_names), redundant: Vec::new(), matched },
    };
    found.extend(search, &all);
    found.remove_redundant(search, &names);
    Some(found)
}

/// The named effects, and the models without and with them.
struct Names<'a> {
    refitted: &'a Evaluated,
    with_names: &'a Evaluated,
    named: &'a [&'static Entry],
}

impl Names<'_> {
    /// Whether the named effects close at least half of what `model` closes of the mean square at 1 s.
    fn close_half_of(&self, model: &Evaluated) -> bool {
        let closed = |model: &Evaluated| self.refitted.square() - model.square();
        closed(self.with_names) >= ENOUGH_CLOSED * closed(model)
    }

    /// Whether one of them closes at least half of what `model` closes.
    fn closes_half_of(&self, search: &Search<'_>, entry: &Entry, model: &Evaluated) -> bool {
        let without = Evaluated::of(search, search.removed(&self.with_names.fit, entry));
        without.square() - self.with_names.square() >= ENOUGH_CLOSED * (self.refitted.square() - model.square())
    }
}

impl Formula {
    /// Adds shapes while the forecasts get better.
    fn extend(&mut self, search: &Search<'_>, all: &[&'static Definition]) {
        while self.shapes.len() < MOST_SHAPES {
            let Some((shape, evaluated)) = next_shape(search, &self.evaluated, all) else { break };
            self.shapes.push(shape);
            self.evaluated = evaluated;
        }
    }

    /// Removes the named effects without which the shapes explain as much, but keeps those that close half.
    fn remove_redundant(&mut self, search: &Search<'_>, names: &Names<'_>) {
        for entry in names.named.iter().filter(|_| !self.shapes.is_empty()) {
            if self.evaluated.fit.model.effects.values(entry.name).is_none() {
                continue;
            }
            let without = Evaluated::of(search, search.removed(&self.evaluated.fit, entry));
            if self.evaluated.log_likelihood - without.log_likelihood >= SECOND_EFFECT {
                continue;
            }
            if names.closes_half_of(search, entry, &self.evaluated) {
                if !self.matched.iter().any(|matched| matched.name == entry.name) {
                    self.matched.push(entry);
                }
            } else {
                self.redundant.push(entry);
                self.evaluated = without;
            }
        }
    }
}

/// `model` with the shapes known, and none on.
fn with_known(model: &Model, shapes: &[&'static Definition]) -> Model {
    let mut model = model.clone();
    shapes.iter().for_each(|shape| model.effects.written.define(shape));
    model
}

/// A shape that may act, before it is fitted.
struct Promising {
    shape: &'static Definition,
    /// Where it may act, and the sizes there.
    at: Maximum,
    /// Gain by chance from the choice among places and shapes, nats.
    chance: f64,
}

impl Promising {
    /// Gain of log-likelihood by the score test, less what chance gains, nats.
    fn nats(&self) -> f64 {
        0.5 * self.at.square - self.chance - COST_OF_A_PARAMETER * self.shape.entry().params.len() as f64
    }
}

/// The shape that lowers the error of the forecasts most, and the model with it.
fn next_shape(
    search: &Search<'_>,
    so_far: &Evaluated,
    all: &[&'static Definition],
) -> Option<(&'static Definition, Evaluated)> {
    let places = places(search, &so_far.fit);
    let started: Vec<(Promising, Started)> = places.iter().flat_map(|place| best_started(search, place, all)).collect();
    let in_full = |start: &Started| Evaluated::of(search, search.problem.fit(&start.model, &start.parameters));
    let fitted: Vec<(&Promising, Evaluated)> = started.par_iter().map(|(one, start)| (one, in_full(start))).collect();
    let is_better = |one: &Promising, with: &Evaluated| {
        with.log_likelihood - so_far.log_likelihood - one.chance > FIRST_EFFECT
            && deviations(&so_far.errors, &with.errors) > 0.0
            && deviations_at_all_horizons(&so_far.errors, &with.errors) > FORMULA_FORECAST
            // What follows this record and no other lowers the errors of short forecasts, and not those of long ones.
            && deviations_of_free_runs(&so_far.errors, &with.errors) > -BETTER_FORECAST
    };
    let better = fitted.into_iter().filter(|(one, with)| is_better(one, with));
    let best = better.min_by(|a, b| a.1.square().total_cmp(&b.1.square()));
    best.map(|(one, with)| (one.shape, with))
}

/// Where the search for a shape begins: the fit, and the same effects with the base parameters of the belief if the fit
/// is far from it. A fit that followed the record without the shape may be a bad start: a gain of a third stands for a
/// saturation, and there no shape has a score.
fn places(search: &Search<'_>, so_far: &Fit) -> Vec<Fit> {
    let mut places = vec![so_far.clone()];
    if search.is_far(so_far) {
        let noise: Vec<Parameter> = so_far.parameters.iter().filter(|one| one.is_noise()).copied().collect();
        let believed = search.problem.fit(&search.with_believed_base(&so_far.model), &noise).model;
        places.push(search.problem.at(believed, &so_far.parameters));
    }
    places
}

/// The shapes that promise most from a place, after a few scoring steps.
fn best_started(search: &Search<'_>, place: &Fit, all: &[&'static Definition]) -> Vec<(Promising, Started)> {
    let mut promising = promising(&search.problem, place, all);
    promising.retain(|one| one.nats() > FIRST_EFFECT);
    promising.truncate(BRIEFLY);
    let known = search.problem.sensitivities_of(place, &place.parameters);
    let start = |one: Promising| {
        let started = briefly(search, place, &known, &one)?;
        Some((one, started))
    };
    let mut started: Vec<(Promising, Started)> = promising.into_par_iter().filter_map(start).collect();
    started.sort_by(|a, b| (b.1.total - b.0.chance).total_cmp(&(a.1.total - a.0.chance)));
    started.truncate(IN_FULL);
    started
}

/// The shapes that `fit` lacks, by their score, the best first.
fn promising(problem: &Problem<'_>, fit: &Fit, all: &[&'static Definition]) -> Vec<Promising> {
    let run = FilterRun::of(problem, fit.clone(), &|row| problem.folds.counts(row));
    let linear = Linearised::of(problem, fit, &run);
    let off = all.iter().filter(|shape| fit.model.effects.values(shape.entry().name).is_none());
    let scored = off.filter_map(|shape| {
        let maxima = linear.maxima(shape);
        let chance = ((maxima.len() * all.len()) as f64).ln();
        let at = maxima.into_iter().next()?;
        Some(Promising { shape, at, chance })
    });
    let mut promising: Vec<Promising> = scored.collect();
    promising.sort_by(|a, b| b.nats().total_cmp(&a.nats()));
    promising
}

/// A brief fit.
struct Started {
    model: Model,
    parameters: Vec<Parameter>,
    /// Log-likelihood and log-prior, nats.
    total: f64,
}

/// A few scoring steps from the best of some sizes, with the derivatives that are known.
fn briefly(search: &Search<'_>, so_far: &Fit, known: &KnownSensitivities, one: &Promising) -> Option<Started> {
    let starts = one
        .at
        .starts()
        .into_iter()
        .filter_map(|values| added(&so_far.model, &so_far.parameters, one.shape.entry(), &values));
    let rated =
        starts.map(|(model, parameters)| (search.problem.by_fold(&model).iter().sum::<f64>(), model, parameters));
    let (_, model, parameters) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let (model, total) = search.problem.fit_briefly_with(known, &model, &parameters, STEPS);
    Some(Started { model, parameters, total })
}

#[cfg(test)]
mod tests;
