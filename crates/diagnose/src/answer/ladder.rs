//! The ladder: the held-out forecast errors as believed, with the numbers refitted, and with each effect added in turn.
//!
//! ```text
//! share(k)   = (E²(k−1) − E²(k)) / (E²(believed) − F²)      E: error at 1 s, held out; F: by noise alone
//! alone(k)   = (E²(refitted) − E²(refitted + effect k)) / (E²(believed) − F²)
//! dropped(k) = (E²(all but effect k) − E²(all)) / (E²(refitted) − F²)
//! ```
//!
//! An effect that changes the scatter and not the path has no share of the errors. So each rung has its gain of held-out
//! log-likelihood too.

use crate::answer::forecast::{held_out, of_belief, square, with_floor};
use crate::fit::estimate::Fit;
use crate::gap::forecast_error::{Gap, Tally};
use crate::gap::share_closed::{Closed, is_open};
use crate::select::search::Search;
use crate::select::stepwise::{Change, Selection};
use crate::thresholds::{PARAMETERS_MM, PARAMETERS_SHARE};
use plant::Entry;
use rayon::prelude::*;
use serde::Serialize;

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
    /// Whether it moves a forecast of 1 s by more than the larger of 5 % of the noise floor and 0.5 mm.
    pub matters: bool,
}

/// The rungs, the lowest first, and what dropping each added effect costs.
pub(crate) struct Ladder {
    pub(crate) rungs: Vec<Rung>,
    /// In the order of the added effects.
    pub(crate) dropped: Vec<Dropped>,
    /// The models of the rungs.
    pub(crate) fits: Vec<Fit>,
    /// Share of what can be closed beyond the refit that all effects together close; `None`: nothing can be closed.
    pub(crate) named_share: Option<f64>,
    /// Error at 1 s of the highest rung, and by noise alone, mm.
    pub(crate) end_mm: Option<[f64; 2]>,
}

/// A model with its held-out errors by stretch, and its held-out log-likelihood.
struct Tried {
    fit: Fit,
    errors: Vec<Tally>,
    total: f64,
}

impl Tried {
    fn of(search: &Search<'_>, fit: Fit) -> Self {
        let errors = held_out(search, &fit, |_| ());
        let total = search.held_out_total(&fit);
        Self { fit, errors, total }
    }

    fn square(&self) -> f64 {
        square(&self.errors)
    }
}

impl Ladder {
    /// Whether the errors that all effects leave exceed those by noise alone by enough to matter.
    pub(crate) fn rest_matters(&self) -> bool {
        self.end_mm.is_none_or(|[end, floor]| end - floor > (PARAMETERS_SHARE * floor).max(PARAMETERS_MM))
    }

    pub(crate) fn of(search: &Search<'_>, refitted: &Fit, found: &Selection) -> Self {
        let added: Vec<&'static Entry> = found
            .effects
            .iter()
            .filter(|named| named.change == Change::Added)
            .map(|named| named.candidate.entry)
            .collect();
        let believed = search.problem.fit(search.problem.belief, &[]);
        let total = search.held_out_total(&believed);
        let believed = Tried { errors: of_belief(search), fit: believed, total };
        let refitted = Tried::of(search, refitted.clone());
        let tried = |keeps: &dyn Fn(usize) -> bool| {
            let dropped: Vec<&Entry> = (0..added.len()).filter(|k| !keeps(*k)).map(|k| added[k]).collect();
            let fit = if dropped.is_empty() { found.fit.clone() } else { search.without_effects(&found.fit, &dropped) };
            Tried::of(search, fit)
        };
        let is_removed = found.effects.iter().any(|named| named.change == Change::Removed);
        let removed = is_removed.then(|| tried(&|_| false));
        let steps: Vec<Tried> = (1..=added.len()).into_par_iter().map(|count| tried(&|k| k < count)).collect();
        let others = |k: usize| if k == 0 { None } else { Some(tried(&|other| other == k)) };
        let alone: Vec<Option<Tried>> = (0..added.len()).into_par_iter().map(others).collect();
        let base = removed.as_ref().unwrap_or(&refitted);
        let last = steps.last().unwrap_or(base);
        let gap = Shares::of(search, &believed, &refitted, last);
        let below = |k: usize| if k == 0 { base } else { &steps[k - 1] };
        let on_top = |k: usize, only: bool| alone[k].as_ref().filter(|_| only).unwrap_or(&steps[0]);
        let dropped = |k: usize| match added.len() {
            count if k + 1 == count => gap.dropped(below(k), last),
            2 => gap.dropped(on_top(1, true), last),
            _ => gap.dropped(&tried(&|other| other != k), last),
        };
        let dropped: Vec<Dropped> = (0..added.len()).into_par_iter().map(dropped).collect();
        let mut rungs = vec![
            gap.rung((Step::Believed, None), &believed, None, None),
            gap.rung((Step::Refitted, None), &refitted, Some(&believed), None),
        ];
        rungs.extend(removed.as_ref().map(|one| gap.rung((Step::Removed, None), one, Some(&refitted), None)));
        for (k, (entry, step)) in added.iter().zip(&steps).enumerate() {
            let alone = gap.share(base.square() - on_top(k, true).square());
            rungs.push(gap.rung((Step::Effect, Some(entry.name)), step, Some(below(k)), alone));
        }
        let named_share = gap.beyond_refit(refitted.square() - last.square());
        let end_mm = gap.floor.map(|floor| [last.square().sqrt(), floor.sqrt()]);
        let fits = [believed.fit, refitted.fit].into_iter().chain(removed.map(|one| one.fit));
        let fits = fits.chain(steps.into_iter().map(|one| one.fit)).collect();
        Self { rungs, dropped, fits, named_share, end_mm }
    }
}

/// The mean squares at 1 s against which shares are measured, mm².
struct Shares {
    believed: Vec<Tally>,
    nominal: f64,
    refitted: f64,
    floor: Option<f64>,
}

impl Shares {
    fn of(search: &Search<'_>, believed: &Tried, refitted: &Tried, last: &Tried) -> Self {
        Self {
            believed: believed.errors.clone(),
            nominal: believed.square(),
            refitted: refitted.square(),
            floor: with_floor(search, &last.fit, &last.errors).floor_mm[2].map(|floor| floor * floor),
        }
    }

    /// A fall of the mean square as a share of the gap.
    fn share(&self, fall: f64) -> Option<f64> {
        let floor = self.floor.filter(|floor| is_open(self.nominal, *floor))?;
        Some(fall / (self.nominal - floor))
    }

    /// The same of what can be closed beyond the refit.
    fn beyond_refit(&self, fall: f64) -> Option<f64> {
        let closable = self.refitted - self.floor?;
        (closable > 0.0).then(|| fall / closable)
    }

    fn dropped(&self, without: &Tried, with: &Tried) -> Dropped {
        let share = self.beyond_refit(without.square() - with.square()).unwrap_or(0.0).clamp(-1.0, 1.0);
        Dropped { share, deviations: deviations(&without.errors, &with.errors) }
    }

    fn rung(
        &self,
        (step, name): (Step, Option<&'static str>),
        this: &Tried,
        below: Option<&Tried>,
        alone: Option<f64>,
    ) -> Rung {
        let share = below.and_then(|below| Closed::of(&self.believed, [&below.errors, &this.errors], self.floor?));
        let held_out_gain = below.map_or(0.0, |below| this.total - below.total);
        let Gap { error_mm, free_run_10s_mm, .. } = Tally::sum(this.errors.iter()).gap();
        Rung { step, name, error_mm, free_run_10s_mm, share, alone, held_out_gain }
    }
}

/// By how many standard errors over the stretches the mean square at 1 s is larger in `these`; 0 where that cannot be
/// told.
pub(super) fn deviations(these: &[Tally], those: &[Tally]) -> f64 {
    let square = |tally: &Tally| tally.squares_at_1_s().map(|(square, _)| square);
    let gains: Vec<f64> =
        these.iter().zip(those).filter_map(|(this, that)| Some(square(this)? - square(that)?)).collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let deviations = mean / (variance / count).sqrt();
    if deviations.is_finite() { deviations } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::Step;
    use crate::options::Options;
    use crate::tests_support::{model, record};
    use crate::{Change, Diagnosis, diagnose};
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
    fn the_floor_is_never_above_the_error() {
        let found = two_effects();
        let mended = &found.gaps[2];
        for (floor, error) in mended.floor_mm.iter().zip(&mended.error_mm) {
            assert!(floor.unwrap() <= error.unwrap(), "{mended:?}");
        }
        assert!(mended.floor_free_run_10s_mm <= mended.free_run_10s_mm, "{mended:?}");
    }
}
