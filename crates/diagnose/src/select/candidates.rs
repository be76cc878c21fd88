//! The candidates: every effect of the catalogue is fitted together with the base parameters and scored by
//! cross-validation.
//!
//! ```text
//! cross-validated = Σ over folds of ( ln p(fold | effect) − ln p(fold | without) ) + Δ ln prior
//!                   each model fitted to the other folds
//! in sample       = ln p(record | effect) − ln p(record | without) + Δ ln prior − parameters
//! held-out gain   = min( cross-validated, in sample )
//! penalised gain  = held-out gain − (log-prior gained by moving the base parameters back to the belief,
//!                   beyond 2.5 nats)
//! ```
//!
//! The held-out gain ranks effects; a name needs penalised gain. A cross-validated gain above the gain in sample, less
//! Akaike's nat per parameter, is due to chance: the model without the effect happened to predict the folds badly.
//! Every effect is screened first ([`mod@crate::select::screening`]); the most promising ones are fitted in full.

use crate::fit::estimate::Fit;
use crate::fit::held_out::LogLikByFold;
use crate::select::nested::{remove_needless, simpler_starts};
use crate::select::optional::{is_within_bounds, other_forms, prefer_simple_forms};
use crate::select::plausibility::{cost_of_form, is_plausible};
use crate::select::posterior::Scored;
use crate::select::screening::{Screened, first, promising_gain, screen};
use crate::select::search::Search;
use crate::select::slow_starts::slow_starts;
use crate::thresholds::{COST_OF_A_PARAMETER, EQUIVALENT, FIRST_EFFECT, FULL_FITS, UNMOVED};
use plant::{Entry, Model};
use rayon::prelude::*;
use std::collections::HashSet;

/// An effect, and the gain with it.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The effect.
    pub entry: &'static Entry,
    /// Its model fitted to the whole record.
    pub fit: Fit,
    /// The models fitted without each fold; none where they are not needed.
    pub(crate) without_each_fold: Vec<Model>,
    /// Held-out log-likelihood gain plus the gain of log-prior, at most the gain in sample less its parameters, nats.
    pub held_out_gain: f64,
    /// The same less what base parameters nearer to the belief gain beyond a small allowance, nats.
    pub penalised_gain: f64,
}

impl Candidate {
    /// The number of its effect's values: a simpler form has fewer of them than the entry has parameters.
    pub(crate) fn value_count(&self) -> usize {
        self.fit.model.effects.values(self.entry.name).map_or(0, |values| values.len())
    }
}

/// Tests every effect that `so_far` lacks: the candidates, the best first, and the scores of all effects.
pub(crate) fn candidates(search: &Search<'_>, so_far: &Fit) -> (Vec<Candidate>, Vec<Scored>) {
    let before = search.problem.held_out(so_far);
    let known = search.problem.sensitivities_of(so_far, &first(search));
    let entries = search.entries();
    search.plan(entries.len());
    let screened = entries.par_iter().filter_map(|entry| search.planned(|| screen(search, so_far, &known, entry)));
    let mut screened: Vec<Screened> = screened.collect();
    screened.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let enough = promising_gain(&screened);
    let promising: Vec<&Screened> = screened.iter().take(FULL_FITS).filter(|one| one.gain > enough).collect();
    let simpler = simpler_starts(search, &promising, &screened, so_far);
    let slow = slow_starts(search, so_far, &entries, enough);
    let other = other_forms(search, &promising, so_far);
    let promising: Vec<&Screened> = promising.into_iter().chain(&simpler).chain(&slow).chain(&other).collect();
    search.plan(promising.len());
    let in_full = |one: &&Screened| search.planned(|| full_fit(search, one, so_far, &before));
    let mut all: Vec<Candidate> = promising.par_iter().map(in_full).collect();
    all.retain(|candidate| is_within_bounds(search, candidate) && is_plausible(search, candidate, so_far));
    all.sort_by(|a, b| b.held_out_gain.total_cmp(&a.held_out_gain));
    prefer_simple_forms(&mut all);
    let mut names = HashSet::new();
    all.retain(|candidate| names.insert(candidate.entry.name));
    remove_needless(search, &mut all, so_far);
    prefer_the_simple(&mut all);
    let scored = scored(&all, &screened);
    (all, scored)
}

/// Puts the simpler of two equivalent effects first if it explains enough: an effect with more parameters can imitate
/// it.
fn prefer_the_simple(all: &mut [Candidate]) {
    let Some(best) = all.first().map(|best| best.held_out_gain) else { return };
    let alike = all.partition_point(|candidate| candidate.held_out_gain > (best - EQUIVALENT).max(FIRST_EFFECT));
    all[..alike].sort_by_key(Candidate::value_count);
}

/// The scores of all effects: the candidates in their order, then those that were only screened.
fn scored(all: &[Candidate], screened: &[Screened]) -> Vec<Scored> {
    let fitted = all.iter().map(|Candidate { entry, held_out_gain, penalised_gain, .. }| Scored {
        name: entry.name,
        held_out_gain: *held_out_gain,
        penalised_gain: *penalised_gain,
        in_full: true,
    });
    let rest = screened.iter().filter(|one| !all.iter().any(|candidate| candidate.entry.name == one.entry.name));
    let screened_only = rest.map(|one| {
        let gain = one.gain.min(0.0);
        Scored { name: one.entry.name, held_out_gain: gain, penalised_gain: gain, in_full: false }
    });
    fitted.chain(screened_only).collect()
}

fn full_fit(search: &Search<'_>, screened: &Screened, so_far: &Fit, before: &LogLikByFold) -> Candidate {
    let fit = search.problem.fit(&screened.model, &screened.parameters);
    let (without_each_fold, mut after) = search.problem.cross_validated(&fit);
    for (fold, after) in after.iter_mut().enumerate() {
        if let Some(other) = screened.chosen_without(fold) {
            *after = after.min(other);
        }
    }
    let held_out = after.iter().sum::<f64>() - before.iter().sum::<f64>();
    let cost = screened.cost + cost_of_form(search, screened.entry);
    let added = fit.parameters.len().saturating_sub(so_far.parameters.len());
    let in_sample = search.problem.total_of(&fit) - search.problem.total_of(so_far);
    let cross_validated = held_out + fit.log_prior - so_far.log_prior;
    let held_out_gain = cross_validated.min(in_sample - COST_OF_A_PARAMETER * added as f64) - cost;
    let unmoved = (search.base_prior(&fit) - search.base_prior(so_far) - UNMOVED).max(0.0);
    let penalised_gain = held_out_gain - unmoved;
    Candidate { entry: screened.entry, fit, without_each_fold, held_out_gain, penalised_gain }
}

#[cfg(test)]
mod tests {
    use super::{Candidate, Fit, candidates as search_candidates};
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::tests_support::{model, record, shaken};
    use plant::effects::DeadZone;
    use plant::{Effects, Model};

    fn candidates(belief: &Model, recording: &crate::Recording) -> Vec<Candidate> {
        let folds = Folds::new(belief, recording);
        let search = Search::new(belief, recording, &folds, &Options::default());
        search_candidates(&search, &refitted(&search)).0
    }

    #[test]
    fn recovers_the_fan_lag_it_was_given() {
        let rig = model();
        let belief = Model { effects: Effects::default(), drag_per_s: 1.95, ..rig.clone() };
        for seed in 0..4 {
            let found = candidates(&belief, &record(&rig, seed, 60));
            let lag = found.iter().find(|c| c.entry.name == "fan_lag").unwrap();
            // Only chance makes another effect better. Its near twin, a sensor lag, is almost as good.
            assert!(
                lag.held_out_gain > 20.0 && lag.held_out_gain > found[0].held_out_gain - 4.0,
                "{} and {}",
                lag.held_out_gain,
                found[0].entry.name
            );
            assert!(["fan_lag", "spin_asymmetry", "sensor_lag"].contains(&found[0].entry.name));
            let lag = lag.fit.model.effects.fan_lag.unwrap().time_constant_s;
            assert!((0.1..0.4).contains(&lag), "{lag} s of 0.2 s");
        }
    }

    #[test]
    fn recovers_the_dead_zone_it_was_given() {
        let zone = DeadZone { lower_percent: -0.3, upper_percent: 0.3 };
        let rig = Model { effects: Effects { dead_zone: Some(zone), ..model().effects }, ..model() };
        for seed in 0..4 {
            let found = candidates(&model(), &record(&rig, seed, 60));
            let width = found[0].fit.model.effects.dead_zone.map(|z| z.upper_percent - z.lower_percent).unwrap();
            assert!(
                found[0].held_out_gain > 5.0 && (0.3..0.9).contains(&width),
                "{} nats, {width} %",
                found[0].held_out_gain
            );
        }
    }

    #[test]
    fn finds_an_effect_far_smaller_than_usual_where_readings_have_almost_no_noise() {
        let quiet = plant::Noise { sensor_mm: 0.005, acceleration_psd_mm2_per_s3: 20.0 };
        let belief = Model { effects: Effects::default(), noise: quiet, ..model() };
        for (name, value) in [("fan_lag", 0.012), ("transport_delay", 0.006)] {
            let mut rig = belief.clone();
            rig.effects.set(name, &[value]);
            let found = candidates(&belief, &shaken(&rig, 1, 40));
            let own = found.iter().find(|candidate| candidate.entry.name == name).unwrap();
            assert!(
                own.held_out_gain > 10.0 && own.held_out_gain > found[0].held_out_gain - 3.0,
                "{name} {}, {} {}",
                own.held_out_gain,
                found[0].entry.name,
                found[0].held_out_gain
            );
            let value_found = own.fit.model.effects.values(name).unwrap()[0];
            assert!((value_found / value - 1.0).abs() < 0.1, "{name}: {value_found} of {value}");
        }
    }

    #[test]
    fn no_gain_is_evidence_beyond_that_fitted_less_a_nat_for_each_number() {
        let zone = DeadZone { lower_percent: -0.4, upper_percent: 0.4 };
        let rig = Model { effects: Effects { dead_zone: Some(zone), ..model().effects }, ..model() };
        let mut limited = 0;
        for seed in 0..4 {
            let record = record(&rig, seed, 60);
            let (belief, folds) = (model(), Folds::new(&model(), &record));
            let search = Search::new(&belief, &record, &folds, &Options::default());
            let so_far = refitted(&search);
            for found in search_candidates(&search, &so_far).0 {
                let numbers = (found.fit.parameters.len() - so_far.parameters.len()) as f64;
                let most = search.problem.total_of(&found.fit) - search.problem.total_of(&so_far) - numbers;
                assert!(found.held_out_gain < most + 1e-9, "{}: {} of {most}", found.entry.name, found.held_out_gain);
                assert!(found.penalised_gain <= found.held_out_gain);
                let others = |fit: &Fit| search.held_out_total(fit);
                limited += usize::from(others(&found.fit) - others(&so_far) > most);
            }
        }
        // The limit applies at least once.
        assert!(limited > 0);
    }

    #[test]
    fn blames_nothing_when_nothing_is_wrong() {
        for seed in 0..8 {
            let found = candidates(&model(), &record(&model(), seed, 60));
            for candidate in found {
                assert!(
                    candidate.held_out_gain < 3.0,
                    "seed {seed}: {} gains {}",
                    candidate.entry.name,
                    candidate.held_out_gain
                );
            }
        }
    }
}
