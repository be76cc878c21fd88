//! Believed effects that the fit changed: retuned if their values differ, removed if the rig does not have them.
//!
//! A new value may stand for an effect that the belief lacks: a longer lag of the fan for a delay beside the believed
//! lag. So it is compared with every effect beside the believed value.

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::select::addition::is_indistinguishable;
use crate::select::candidates::{Candidate, candidates};
use crate::select::search::Search;
use crate::select::stepwise::Change;
use crate::thresholds::{CHANGED, EQUIVALENT, RETUNED};

use plant::{Entry, Model};

/// The change of a believed effect.
pub(crate) struct BelievedChange {
    pub(crate) change: Change,
    /// The effect, and the gain of its change.
    pub(crate) candidate: Candidate,
    /// The fit without the effect, if it is removed.
    pub(crate) without: Option<Fit>,
    /// Effects that explain the record as well beside the believed values.
    pub(crate) rivals: Vec<Candidate>,
}

/// The believed effects whose values `fit` moved by more than [`RETUNED`], if that explains enough.
pub(crate) fn changed(search: &Search<'_>, fit: &Fit) -> Vec<BelievedChange> {
    let present = search.problem.belief.effects.present();
    let moved = present.iter().filter(|entry| is_moved(search, fit, entry));
    moved.filter_map(|entry| change(search, fit, entry)).collect()
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

fn change(search: &Search<'_>, fit: &Fit, entry: &'static Entry) -> Option<BelievedChange> {
    let parameters: Vec<Parameter> =
        fit.parameters.iter().filter(|parameter| !parameter.is_of(entry.name)).copied().collect();
    let total = |fit: &Fit| search.problem.total_of(fit);
    // Far from the values of the fit, its base parameters and its noise may lead to a lower maximum.
    let with = |values: &[f64]| {
        let mut found = fit.model.clone();
        found.effects.set(entry.name, values);
        let believed = Model { effects: found.effects.clone(), ..search.problem.belief.clone() };
        let [found, believed] = [found, believed].map(|start| search.problem.fit(&start, &parameters));
        if total(&believed) > total(&found) { believed } else { found }
    };
    let as_believed = with(&search.problem.belief.effects.values(entry.name).unwrap_or_default());
    let absent = with(&entry.neutral(search.problem.belief));
    let is_removed = total(&absent) > total(fit) - EQUIVALENT;
    let gain = total(if is_removed { &absent } else { fit }) - total(&as_believed);
    if gain <= CHANGED {
        return None;
    }
    let candidate =
        Candidate { entry, fit: fit.clone(), without_each_fold: Vec::new(), held_out_gain: gain, penalised_gain: gain };
    Some(if is_removed {
        BelievedChange { change: Change::Removed, candidate, without: Some(absent), rivals: Vec::new() }
    } else {
        let rivals = rivals(search, &candidate, &as_believed);
        BelievedChange { change: Change::Retuned, candidate, without: None, rivals }
    })
}

/// The effects that explain the record as well as the new value of a believed effect, beside its believed value.
fn rivals(search: &Search<'_>, retuned: &Candidate, as_believed: &Fit) -> Vec<Candidate> {
    let held_out_gain = search.held_out_total(&retuned.fit) - search.held_out_total(as_believed);
    let retuned = Candidate { held_out_gain, ..retuned.clone() };
    let (mut all, _) = candidates(search, as_believed);
    all.retain(|candidate| is_indistinguishable(candidate, &retuned));
    all
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

    #[test]
    fn a_lag_that_looks_longer_may_be_a_second_one() {
        let believed = FanLag { time_constant_s: 0.1 };
        let belief = Model { effects: Effects { fan_lag: Some(believed), ..Effects::default() }, ..model() };
        let mut rig = belief.clone();
        rig.effects.set("sensor_lag", &[0.12]);
        for seed in [1, 2] {
            let found = diagnose(&belief, &record(&rig, seed, 80), &Options::default());
            let named = &found.effects[0];
            assert_eq!((named.change, named.candidate.entry.name), (Change::Retuned, "fan_lag"));
            assert!(named.indistinguishable_from.contains(&"sensor_lag"), "{:?}", named.indistinguishable_from);
            assert_eq!(named.rivals.len(), named.indistinguishable_from.len());
        }
    }
}
