//! The ladder: the held-out forecast errors as believed, with the numbers refitted, and with each effect added in turn.
//!
//! ```text
//! share(k)   = (E²(k−1) − E²(k)) / (E²(believed) − F²)      E: error at 1 s, held out; F: by noise alone
//! alone(k)   = (E²(refitted) − E²(refitted + effect k)) / (E²(believed) − F²)
//! dropped(k) = (E²(all but effect k) − E²(all)) / (E²(refitted) − F²)
//! ```
//!
//! An effect that changes the scatter and not the path has no share of the errors. So each rung has its gain of
//! held-out log-likelihood too.

use crate::fit::estimate::Fit;
use crate::gap::forecast_error::Gap;
use crate::gap::share_closed::{Closed, is_open};
use crate::select::forecast::{Evaluated, deviations};
use crate::select::formula::Formula;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect, Selection};
use plant::Entry;
use rayon::prelude::*;
use serde::Serialize;
use std::ops::Range;

/// What a rung adds to the one below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// The belief.
    Believed,
    /// Its numbers fitted to the record.
    Refitted,
    /// Believed effects left out.
    Removed,
    /// An effect.
    Effect,
    /// A formula for what no effect explains.
    Formula,
}

/// One rung of the ladder.
#[derive(Clone, Debug, Serialize)]
pub struct Rung {
    /// What it adds to the rung below.
    pub step: Step,
    /// The effect that it adds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<&'static str>,
    /// Held-out forecast errors at the horizons, mm.
    pub error_mm: [Option<f64>; 3],
    /// The same of free runs of 10 s, mm.
    pub free_run_10s_mm: Option<f64>,
    /// Share of the gap at 1 s that this step closes; `None`: it is the first, or there is no gap.
    pub share: Option<Closed>,
    /// The share that it would close on the refitted belief alone.
    pub alone: Option<f64>,
    /// Gain of held-out log-likelihood over the rung below, nats.
    pub held_out_gain: f64,
}

/// What dropping a named effect costs the forecasts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Dropped {
    /// Rise of the mean square error at 1 s, as a share of what can be closed beyond the refit, at most 1 either way.
    pub share: f64,
    /// The same rise in standard errors over the stretches of the record.
    pub deviations: f64,
}

/// What no effect explains.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rest {
    /// Its part of what can be closed beyond the refit; `None`: nothing can be closed.
    pub share: Option<f64>,
    /// Whether the residual tests find it.
    pub is_significant: bool,
    /// Whether it moves a forecast of 1 s by more than the larger of 5 % of the noise floor and 0.5 mm, or 1/1200 of a
    /// pipe shorter than 600 mm.
    pub matters: bool,
}

/// The rungs, the lowest first, and what dropping each added effect costs.
pub(crate) struct Ladder {
    pub(crate) rungs: Vec<Rung>,
    /// The models of the rungs: the belief, its refit, and so on.
    pub(super) models: Vec<Evaluated>,
    /// In the order of the added effects.
    pub(crate) dropped: Vec<Dropped>,
    /// Share of what can be closed beyond the refit that all effects together close; `None`: nothing can be closed.
    pub(crate) named_share: Option<f64>,
    /// Errors of the highest rung, and by noise alone.
    pub(crate) end: Gap,
}

impl Ladder {
    pub(crate) fn of(search: &Search<'_>, refitted: &Fit, found: &Selection) -> Self {
        let added = Added::of(search, found);
        let count = added.entries.len();
        let Steps { models, base, before } = Steps::of(search, refitted, found, &added);
        // The first effect alone is the rung above the base.
        let others = added.each(1..count, |only, k| k == only);
        let alone = |k: usize| if k == 0 { &models[base + 1] } else { &others[k - 1] };
        let last = &models[models.len() - 1];
        let end = last.gap_with_floor(search);
        let shares = Shares::of(&models, &end);
        let dropped = |k: usize| match count {
            1 => shares.dropped(&models[before], last),
            _ if k + 1 == count => shares.dropped(&models[base + k], last),
            2 => shares.dropped(alone(1), last),
            _ => shares.dropped(&added.kept(|other| other != k), last),
        };
        let dropped = (0..count).into_par_iter().map(dropped).collect();
        let rung = |at: usize| match (at, at.checked_sub(base + 1)) {
            (0, _) => shares.rung(Step::Believed, &models[0], None),
            (1, _) => shares.rung(Step::Refitted, &models[1], Some(&models[0])),
            (_, None) => shares.rung(Step::Removed, &models[at], Some(&models[at - 1])),
            (_, Some(k)) => Rung {
                name: Some(added.entries[k].name),
                alone: shares.of_gap(models[before].square() - alone(k).square()),
                ..shares.rung(Step::Effect, &models[at], Some(&models[if k == 0 { before } else { at - 1 }]))
            },
        };
        let shown = (0..=before).chain(base + 1..models.len());
        let rungs = shown.map(rung).collect();
        let named_share = shares.beyond_refit(models[1].square() - last.square());
        Self { rungs, dropped, named_share, end, models }
    }
}

impl Ladder {
    /// The rung of a formula that was found on top of the model of rung `below`.
    pub(super) fn rung_of(&self, search: &Search<'_>, below: usize, formula: &Formula) -> Rung {
        let with = &formula.evaluated;
        let shares = Shares::of(&self.models, &with.gap_with_floor(search));
        shares.rung(Step::Formula, with, Some(&self.models[below]))
    }
}

/// The models of the rungs.
struct Steps {
    /// The belief, its refit, that without the effects that are removed if there are any, and that with each added
    /// effect.
    models: Vec<Evaluated>,
    /// The last one without any added effect.
    base: usize,
    /// The one below the first added effect on the ladder. Where the forecasts are worse without the effects that are
    /// removed, the added ones take their place: then both changes are one step, above the refit.
    before: usize,
}

impl Steps {
    fn of(search: &Search<'_>, refitted: &Fit, found: &Selection, added: &Added<'_>) -> Self {
        let count = added.entries.len();
        let belief = Evaluated::belief(search);
        let refit = Evaluated::refit(search, refitted, &belief);
        let mut models = vec![belief, refit];
        models.extend(found.effects.iter().any(is_removed).then(|| added.kept(|_| false)));
        let base = models.len() - 1;
        let in_exchange = count > 0 && models[base].square() > models[1].square();
        let before = if in_exchange { 1 } else { base };
        for (with, entry) in added.each(1..count + 1, |count, k| k < count).into_iter().zip(&added.entries) {
            models.push(with.or_with_numbers_kept(search, &models[models.len() - 1], entry));
        }
        Self { models, base, before }
    }
}

fn is_removed(named: &NamedEffect) -> bool {
    named.change == Change::Removed
}

/// The effects that were added to the belief.
struct Added<'a> {
    search: &'a Search<'a>,
    with_all: &'a Fit,
    entries: Vec<&'static Entry>,
}

impl<'a> Added<'a> {
    fn of(search: &'a Search<'a>, found: &'a Selection) -> Self {
        let added = found.effects.iter().filter(|named| named.change == Change::Added);
        Self { search, with_all: &found.fit, entries: added.map(|named| named.candidate.entry).collect() }
    }

    /// The fit with those effects alone, by their index, for which `keeps` holds.
    fn kept(&self, keeps: impl Fn(usize) -> bool) -> Evaluated {
        let dropped = self.entries.iter().enumerate().filter(|(k, _)| !keeps(*k));
        let dropped: Vec<&Entry> = dropped.map(|(_, entry)| *entry).collect();
        let all = dropped.is_empty();
        let fit = if all { self.with_all.clone() } else { self.search.without_effects(self.with_all, &dropped) };
        Evaluated::of(self.search, fit)
    }

    /// Such a fit for each number of a range.
    fn each(&self, range: Range<usize>, keeps: impl Fn(usize, usize) -> bool + Sync) -> Vec<Evaluated> {
        range.into_par_iter().map(|number| self.kept(|k| keeps(number, k))).collect()
    }
}

/// The mean squares at 1 s against which shares are measured, mm².
struct Shares<'a> {
    belief: &'a Evaluated,
    nominal: f64,
    refitted: f64,
    floor: Option<f64>,
}

impl<'a> Shares<'a> {
    fn of(models: &'a [Evaluated], end: &Gap) -> Self {
        let [nominal, refitted] = [0, 1].map(|at| models[at].square());
        Self { belief: &models[0], nominal, refitted, floor: end.floor_mm[2].map(|floor| floor * floor) }
    }

    /// A fall of the mean square as a share of the gap.
    fn of_gap(&self, fall: f64) -> Option<f64> {
        let floor = self.floor.filter(|floor| is_open(self.nominal, *floor))?;
        Some(fall / (self.nominal - floor))
    }

    /// The same of what can be closed beyond the refit.
    fn beyond_refit(&self, fall: f64) -> Option<f64> {
        let closable = self.refitted - self.floor?;
        (closable > 0.0).then(|| fall / closable)
    }

    fn dropped(&self, without: &Evaluated, with: &Evaluated) -> Dropped {
        let share = self.beyond_refit(without.square() - with.square()).unwrap_or(0.0).clamp(-1.0, 1.0);
        Dropped { share, deviations: deviations(&without.errors, &with.errors) }
    }

    fn rung(&self, step: Step, this: &Evaluated, below: Option<&Evaluated>) -> Rung {
        let share = |below: &Evaluated| Closed::of(&self.belief.errors, [&below.errors, &this.errors], self.floor?);
        let held_out_gain = below.map_or(0.0, |below| this.log_likelihood - below.log_likelihood);
        let Gap { error_mm, free_run_10s_mm, .. } = this.gap();
        let share = below.and_then(share);
        Rung { step, name: None, error_mm, free_run_10s_mm, share, alone: None, held_out_gain }
    }
}

#[cfg(test)]
mod tests {
    use super::Step;
    use crate::options::Options;
    use crate::tests_support::{model, record};
    use crate::{Change, Diagnosis, diagnose};
    use plant::effects::{SensorQuantisation, StaleSamples};
    use plant::{Effects, Model};

    /// A rig with a lag and a strong gradient, diagnosed with a belief without effects.
    fn two_effects() -> Diagnosis {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = model();
        rig.effects.set("height_dependent_flow", &[8.0]);
        diagnose(&belief, &record(&rig, 4, 80), &Options::default())
    }

    #[test]
    fn the_rungs_are_belief_refit_and_each_effect_and_their_shares_add_up_to_what_is_closed() {
        let found = two_effects();
        let names: Vec<&str> = found.effects.iter().map(|named| named.candidate.entry.name).collect();
        assert!(names.len() == 2 && found.effects.iter().all(|named| named.change == Change::Added), "{names:?}");
        let steps: Vec<_> = found.ladder.iter().map(|rung| (rung.step, rung.name)).collect();
        let effects = names.iter().map(|name| (Step::Effect, Some(*name)));
        let expected: Vec<_> = [(Step::Believed, None), (Step::Refitted, None)].into_iter().chain(effects).collect();
        assert_eq!(steps, expected);
        let shares: f64 = found.ladder.iter().filter_map(|rung| rung.share).map(|share| share.value).sum();
        let closed = found.closed.unwrap().value;
        assert!((shares - closed).abs() < 1e-9 && closed > 0.9, "{shares} of {closed}");
        // Each is needed: without it forecasts get worse, in nearly every stretch.
        for named in &found.effects {
            let evidence = named.evidence;
            assert!(evidence.dropped_share > 0.01 && evidence.dropped_deviations > 2.0, "{evidence:?}");
        }
        assert!(found.ladder[2..].iter().all(|rung| rung.held_out_gain > 5.0 && rung.alone.is_some()));
        let [first, second] = [2, 3].map(|at| found.ladder[at].error_mm[2].unwrap());
        assert!(found.ladder[1].error_mm[2].unwrap() > first && first > second, "{first} and {second} mm");
    }

    #[test]
    fn no_step_forecasts_worse_where_stale_readings_bias_the_refit() {
        let mut rig = model();
        rig.effects.set("stale_samples", &[0.11]);
        let found = diagnose(&model(), &record(&rig, 4, 80), &Options::default());
        let errors: Vec<f64> = found.ladder.iter().map(|rung| rung.error_mm[2].unwrap()).collect();
        assert!(found.effects.iter().any(|named| named.candidate.entry.name == "stale_samples"), "{errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]), "{errors:?}");
    }

    #[test]
    fn both_effects_of_a_coarse_and_slow_sensor_are_named_and_none_is_removed_once_they_are_believed() {
        let mut rig = model();
        rig.effects.stale_samples = Some(StaleSamples { hold_s: 0.1 });
        rig.effects.sensor_quantisation = Some(SensorQuantisation { step_mm: 12.0 });
        let recording = record(&rig, 4, 60);
        let found = diagnose(&model(), &recording, &Options::default());
        let names: Vec<&str> = found.effects.iter().map(|named| named.candidate.entry.name).collect();
        assert!(names.contains(&"stale_samples") && names.contains(&"sensor_quantisation"), "{names:?}");
        let found = diagnose(&rig, &recording, &Options::default());
        assert!(found.effects.is_empty(), "{:?}", found.effects.iter().map(|one| one.change).collect::<Vec<_>>());
    }

    #[test]
    fn the_floor_is_never_above_the_error() {
        let found = two_effects();
        let mended = &found.gaps[2];
        for (floor, error) in mended.floor_mm.iter().zip(&mended.error_mm) {
            assert!(floor.unwrap() <= error.unwrap(), "{mended:?}");
        }
        assert!(mended.floor_free_run_10s_mm <= mended.free_run_10s_mm, "{mended:?}");
    }
}
