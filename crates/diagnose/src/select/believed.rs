//! Believed effects that the fit changed: retuned if their values differ, removed if the rig does not have them.

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::select::candidates::Candidate;
use crate::select::search::Search;
use crate::select::stepwise::Change;
use crate::thresholds::{EQUIVALENT, RETUNED};

use plant::{Entry, Model};

/// The believed effects whose values `fit` moved by more than [`RETUNED`]: the change, its gain, and the fit without
/// the effect if it is removed.
pub(crate) fn changed(search: &Search<'_>, fit: &Fit) -> Vec<(Change, Candidate, Option<Fit>)> {
    let present = search.problem.belief.effects.present();
    let moved = present.iter().filter(|entry| is_moved(search, fit, entry));
    moved.map(|entry| change(search, fit, entry)).collect()
}

/// Whether a value of a believed effect moved by more than the factor, or past its neutral value.
fn is_moved(search: &Search<'_>, fit: &Fit, entry: &Entry) -> bool {
    let values = |model: &Model| model.effects.values(entry.name).unwrap_or_default();
    let (believed, found) = (values(search.problem.belief), values(&fit.model));
    let neutral = entry.neutral(search.problem.belief);
    believed.iter().zip(&found).zip(&neutral).any(|((believed, found), neutral)| {
        let ratio = (found - neutral) / (believed - neutral);
        believed != neutral && !(1.0 / RETUNED..=RETUNED).contains(&ratio)
    })
}

fn change(search: &Search<'_>, fit: &Fit, entry: &'static Entry) -> (Change, Candidate, Option<Fit>) {
    let parameters: Vec<Parameter> =
        fit.parameters.iter().filter(|parameter| !parameter.is_of(entry.name)).copied().collect();
    let with = |values: &[f64]| {
        let mut model = fit.model.clone();
        model.effects.set(entry.name, values);
        search.problem.fit(&model, &parameters)
    };
    let total = |fit: &Fit| search.problem.total_of(fit);
    let as_believed = with(&search.problem.belief.effects.values(entry.name).unwrap_or_default());
    let absent = with(&entry.neutral(search.problem.belief));
    let removed = total(&absent) > total(fit) - EQUIVALENT;
    let gain = total(if removed { &absent } else { fit }) - total(&as_believed);
    let candidate =
        Candidate { entry, fit: fit.clone(), without_each_fold: Vec::new(), held_out_gain: gain, penalised_gain: gain };
    if removed { (Change::Removed, candidate, Some(absent)) } else { (Change::Retuned, candidate, None) }
}

#[cfg(test)]
mod tests {
    use crate::tests_support::{model, record};
    use crate::{Change, Options, Verdict, diagnose};
    use plant::effects::FanLag;
    use plant::{Effects, Model};

    fn changes(believed_s: f64, rig: &Model) -> Vec<(Change, &'static str)> {
        let lag = FanLag { time_constant_s: believed_s };
        let belief = Model { effects: Effects { fan_lag: Some(lag), ..Effects::default() }, ..model() };
        let found = diagnose(&belief, &record(rig, 3, 80), &Options::default());
        assert!(found.effects.is_empty() || found.verdict == Verdict::Effect);
        found.effects.iter().map(|named| (named.change, named.candidate.entry.name)).collect()
    }

    #[test]
    fn a_lag_that_is_half_as_long_as_it_is_is_retuned() {
        assert_eq!(changes(0.08, &model()), [(Change::Retuned, "fan_lag")]);
    }

    #[test]
    fn a_lag_that_is_not_there_is_removed() {
        let without = Model { effects: Effects::default(), ..model() };
        assert_eq!(changes(0.2, &without), [(Change::Removed, "fan_lag")]);
    }

    #[test]
    fn a_lag_that_is_nearly_right_stays() {
        assert_eq!(changes(0.21, &model()), []);
    }
}
