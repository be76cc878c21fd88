//! The rivals of a named effect that a record does not tell from it where something else is missing.
//!
//! ```text
//! d_s = Σ ln p(record | named) − ln p(record | rival)      over stretch s, each with all other effects
//! t   = mean(d)/√(var(d)/n)                                compared with Student's t of n − 1
//! ```
//!
//! A difference in nats decides between two models if one of them is exact. Where the residual tests find that neither
//! is, and in the search by forecasts, Vuong's test over the stretches of the record decides: the rival is told apart
//! if the mean difference is positive by more than chance.
//! Source: Vuong, "Likelihood ratio tests for model selection and non-nested hypotheses", Econometrica 57 (1989).

use crate::fit::estimate::Fit;
use crate::record::folds::Folds;
use crate::select::candidates::{Candidate, candidates};
use crate::select::exchange::rivals_of;
use crate::select::forecast::standard_errors;
use crate::select::random_force::is_random_force;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect, Selection, is_of_path};
use crate::stats::student::student_975;
use plant::Entry;
use std::collections::BTreeMap;

/// Adds the rivals that the stretches do not tell from it to each added effect of the path. An effect of the scatter is
/// read off the readings themselves.
pub(crate) fn add_rivals_amid_misfit(search: &Search<'_>, found: &mut Selection) {
    let Selection { effects, rounds, fit, .. } = found;
    for named in effects.iter_mut().filter(|named| named.change == Change::Added) {
        let entry = named.candidate.entry;
        let rivals = rivals_of(search, entry, rounds);
        if rivals.len() > 1 && may_be_another(entry) {
            add_rivals(search, named, fit, &rivals);
        }
    }
}

fn may_be_another(entry: &Entry) -> bool {
    is_of_path(entry) && !is_random_force(entry)
}

/// Compares the effect with `rivals` in its place, beside all other effects of the fit.
fn add_rivals(search: &Search<'_>, named: &mut NamedEffect, fit: &Fit, rivals: &[&str]) {
    let entry = named.candidate.entry;
    let among = search.without(|other| !rivals.contains(&other.name) || !may_be_another(other));
    let (all, _) = candidates(&among, &search.removed(fit, entry));
    let Some(own) = all.iter().find(|one| one.entry.name == entry.name) else { return };
    let is_new = |one: &&Candidate| {
        let name = one.entry.name;
        name != entry.name && one.entry.contains != Some(entry.name) && !named.indistinguishable_from.contains(&name)
    };
    let is_rival =
        |one: &&Candidate| one.held_out_gain > 0.0 && !is_preferred(search.problem.folds, &own.fit, &one.fit);
    let more: Vec<&Candidate> = all.iter().filter(is_new).filter(is_rival).collect();
    named.indistinguishable_from.extend(more.iter().map(|one| one.entry.name));
    named.rivals.extend(more.iter().map(|one| one.fit.model.clone()));
}

/// Whether `this` is more likely than `that` over the stretches of the record by more than chance: a two-sided test at
/// 5 %, since neither model is the hypothesis.
fn is_preferred(folds: &Folds, this: &Fit, that: &Fit) -> bool {
    let mut differences = BTreeMap::<usize, f64>::new();
    for (fit, sign) in [(this, 1.0), (that, -1.0)] {
        for one in &fit.innovations {
            if let Some(stretch) = folds.stretch(one.row) {
                *differences.entry(stretch).or_default() += sign * one.log_density;
            }
        }
    }
    let freedom = differences.len() as f64 - 1.0;
    standard_errors(differences.into_values()) > student_975(freedom)
}

#[cfg(test)]
mod tests {
    use super::{add_rivals_amid_misfit, is_preferred};
    use crate::fit::estimate::{Fit, Problem};
    use crate::fit::parameter::{BASE, Prior};
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::select::stepwise::select_effects;
    use crate::select::tests_support::with_force;
    use crate::tests_support::{model, record};

    #[test]
    fn a_model_is_preferred_where_most_stretches_prefer_it_and_not_where_one_does() {
        let (belief, recording) = (model(), record(&model(), 1, 80));
        let folds = Folds::new(&belief, &recording);
        let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief };
        let this = problem.fit(&belief, &BASE);
        // The other model lacks this much at a reading, by its stretch.
        let worse = |nats: fn(usize) -> f64| {
            let mut that = this.clone();
            for one in &mut that.innovations {
                one.log_density -= folds.stretch(one.row).map_or(0.0, nats);
            }
            that
        };
        let preferred = |that: &Fit| is_preferred(&folds, &this, that);
        assert!(preferred(&worse(|stretch| if stretch % 4 == 0 { -0.01 } else { 0.02 })));
        assert!(!preferred(&worse(|stretch| if stretch == 3 { 1.0 } else { 0.0 })));
        assert!(!preferred(&worse(|stretch| if stretch % 2 == 0 { 0.11 } else { -0.1 })));
        // Equal models are not told apart.
        assert!(!preferred(&this));
    }

    #[test]
    fn a_lag_amid_an_unknown_force_stays_in_the_set_of_a_delay() {
        let mut rig = with_force("size * sin(2 * pi * x / 60)", 80.0);
        rig.effects.set("sensor_lag", &[0.1]);
        let (belief, recording) = (model(), record(&rig, 1, 80));
        let folds = Folds::new(&belief, &recording);
        let search =
            Search::of(Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief });
        let mut found = select_effects(&search, &refitted(&search));
        assert!(found.is_incomplete(), "{:?}", found.misfit);
        let whole = found.effects[0].indistinguishable_from.clone();
        found.effects[0].indistinguishable_from.clear();
        found.effects[0].rivals.clear();
        add_rivals_amid_misfit(&search, &mut found);
        let named = &found.effects[0];
        assert!(named.candidate.entry.acts.late.is_some() && named.indistinguishable_from.contains(&"sensor_lag"));
        assert_eq!(named.indistinguishable_from.len(), named.rivals.len());
        // The search has asked for them already.
        assert!(named.indistinguishable_from.iter().all(|name| whole.contains(name)), "{whole:?}");
    }
}
