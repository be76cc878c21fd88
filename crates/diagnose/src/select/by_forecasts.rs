//! The search by forecasts: the same selection of effects with a filter so slow that its innovations are errors of
//! forecasts.
//!
//! ```text
//! ω⁴ = q/(r·Δt)          ω: bandwidth of the steady filter of a ball that a force of white noise moves
//! 1/w = 1 + 2·Σ ρ_k      w: weight of a reading; 1/w: integrated autocorrelation time of the innovations, in readings,
//!                        with ρ_k up to the first below 0
//! ```
//!
//! Where a model lacks something, the likelihood of the next reading raises the noise of the air, q, until the filter
//! corrects the model within a few readings: what the model says beyond these no longer counts, and the fit may be
//! useless for a forecast of a second. So ω is fixed instead, at 1/horizon (see [`HORIZONS_S`]), and q and the
//! variance r of a reading change by one factor: the innovations are then errors of forecasts about so far ahead. They
//! are correlated, so the log-likelihood of a reading is multiplied by w, the effective sample size per reading. A
//! right model has white innovations in a fast filter, and its likelihood is the better criterion; so this search
//! takes its place only where its forecasts are better.
//!
//! Sources: Ljung, *System Identification*, section 3.2 (a horizon of prediction is a choice of the noise model);
//! Bar-Shalom, Li and Kirubarajan, *Estimation with Applications to Tracking and Navigation*, section 6.5 (the steady
//! filter); Geyer, "Practical Markov chain Monte Carlo", Statistical Science 7 (1992) (the sum of autocorrelations);
//! Pauli, Racugno and Ventura, "Bayesian composite marginal likelihoods", Statistica Sinica 21 (2011) (the weight).

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::record::folds::Folds;
use crate::record::recording::Recording;
use crate::select::elimination::eliminate_by_forecasts;
use crate::select::forecast::{Evaluated, deviations_at_all_horizons, of_patch};
use crate::select::random_force::is_random_force;
use crate::select::screening::added;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect, Selection, is_of_path, select_further};
use crate::thresholds::BETTER_FORECAST;
use plant::{Changes, Entry, Model, Noise};

/// Horizons of the forecasts, seconds; the first at which a search finds better forecasts counts. Beyond the velocity's
/// memory, 1/drag, a forecast depends on forces alone; of rigs with drags of 0.3 to 4/s none forgets later than the
/// first. The second is the one at which the gap is measured, for a rig that is unstable somewhere, such as a pendulum
/// that is swung up: none forecasts it for longer. Its fits have more local maxima.
pub(crate) const HORIZONS_S: [f64; 2] = [3.0, 1.0];

/// A search by forecasts that was made, and forecasts better than the one by likelihood.
pub(crate) struct ByForecasts {
    /// The folds with the weight of a reading.
    folds: Folds,
    /// The noise of the filter.
    noise: Noise,
    /// The belief, refitted.
    pub(crate) refitted: Fit,
    /// The model of the search by likelihood.
    of_likelihood: Model,
}

impl ByForecasts {
    /// The search by forecasts beside one by likelihood that found `found` on `refitted`, with what it finds. `None`:
    /// its forecasts are not better than those of `refitted` and of `found` by more than chance.
    pub(crate) fn where_better(search: &Search<'_>, refitted: &Fit, found: &Selection) -> Option<(Self, Selection)> {
        HORIZONS_S.iter().find_map(|horizon_s| Self::over(*horizon_s, search, refitted, found))
    }

    /// The same over one horizon.
    fn over(horizon_s: f64, search: &Search<'_>, refitted: &Fit, found: &Selection) -> Option<(Self, Selection)> {
        let (by_forecasts, mut fit) = Self::beside(search, refitted, found, horizon_s);
        let slow = by_forecasts.search(search);
        let mut names: Vec<NamedEffect> = of_path(found).cloned().collect();
        eliminate_by_forecasts(&slow, &mut names, &mut fit);
        let again = select_further(&slow, fit, names, &found.misfit);
        // Each fit is held out by its own criterion.
        let errors = |of: &Search<'_>, fit: &Fit| of_patch(of, &of.problem.without_each_fold(fit));
        let end = errors(&slow, &again.fit);
        let is_better = |fit: &Fit| deviations_at_all_horizons(&errors(search, fit), &end) > BETTER_FORECAST;
        let better = [refitted, &found.fit].into_iter().all(is_better);
        better.then(|| (by_forecasts, beside_scatter(again, found)))
    }

    /// The search before anything is selected, and the fit with the effects that were found by likelihood. The weight of
    /// a reading follows from the residual beside these.
    fn beside(search: &Search<'_>, refitted: &Fit, found: &Selection, horizon_s: f64) -> (Self, Fit) {
        let noise = slow_noise(search, refitted, horizon_s);
        let unweighted = search.by_forecasts(search.problem.folds, noise);
        let refitted = slow_fit(&unweighted, refitted, noise);
        // The likelihood of a slow filter has local maxima: the fit starts from both sides.
        let together = slow_fit(&unweighted, &found.fit, noise);
        let one_by_one = with_found_effects(&unweighted, refitted.clone(), found);
        let total = |fit: &Fit| unweighted.problem.total_of(fit);
        let with_found_effects = if total(&together) > total(&one_by_one) { together } else { one_by_one };
        let folds = search.problem.folds.weighted(weight(search, &with_found_effects));
        let weighted = search.by_forecasts(&folds, noise).problem;
        let [refitted, with_found_effects] =
            [refitted, with_found_effects].map(|fit| weighted.fit(&fit.model, &fit.parameters));
        (Self { folds, noise, refitted, of_likelihood: found.fit.model.clone() }, with_found_effects)
    }

    /// The search.
    pub(crate) fn search<'a>(&'a self, search: &'a Search<'a>) -> Search<'a> {
        search.by_forecasts(&self.folds, self.noise).without(|entry| !is_of_path(entry))
    }

    /// A fit by forecasts with the effects on the variance of readings that were found by likelihood, and with noise
    /// that is fitted to what then remains.
    pub(crate) fn with_noise(&self, search: &Search<'_>, fit: Fit) -> Fit {
        let mut model = Model { noise: self.of_likelihood.noise, ..fit.model };
        for entry in self.of_likelihood.effects.present().into_iter().filter(|entry| is_scatter(entry)) {
            model.effects.set(entry.name, &self.of_likelihood.effects.values(entry.name).unwrap_or_default());
        }
        let Fit { model, innovations, .. } = search.problem.fit(&model, &[Parameter::SensorNoise, Parameter::AirNoise]);
        Fit { model, innovations, ..fit }
    }
}

/// Time over which the filter with this noise forgets its model, seconds: 1/ω.
pub(crate) fn memory_s(recording: &Recording, noise: Noise) -> f64 {
    let Noise { sensor_mm, acceleration_psd_mm2_per_s3 } = noise;
    (sensor_mm * sensor_mm * recording.mean_reading_period_s() / acceleration_psd_mm2_per_s3).powf(0.25)
}

/// What was found by forecasts, with the effects that do not change the path as the search by likelihood found them.
fn beside_scatter(mut again: Selection, found: &Selection) -> Selection {
    let is_kept = |named: &&NamedEffect| {
        let entry = named.candidate.entry;
        named.change == Change::Added && !is_of_path(entry) && !is_random_force(entry)
    };
    let kept: Vec<NamedEffect> = found.effects.iter().filter(is_kept).cloned().collect();
    let added = again.effects.iter().take_while(|named| named.change == Change::Added).count();
    again.effects.splice(added..added, kept);
    again.rounds.splice(..0, found.rounds.iter().cloned());
    again
}

/// Whether an effect changes the variance of readings alone.
fn is_scatter(entry: &Entry) -> bool {
    entry.acts.changes == Changes::Scatter && !is_random_force(entry)
}

/// The noise of a filter with the bandwidth of the horizon, for errors of the size that `fit` forecasts with.
pub(crate) fn slow_noise(search: &Search<'_>, fit: &Fit, horizon_s: f64) -> Noise {
    let recording = search.problem.recording;
    let period_s = recording.mean_reading_period_s();
    let error_mm = Evaluated::of(search, fit.clone()).gap().error_mm[2].unwrap_or(0.0);
    let sensor_mm = error_mm.max(fit.model.noise.sensor_mm);
    Noise { sensor_mm, acceleration_psd_mm2_per_s3: horizon_s.powi(-4) * sensor_mm * sensor_mm * period_s }
}

/// A model without its effects on the variance of readings and its random forces, fitted by forecasts.
pub(crate) fn slow_fit(slow: &Search<'_>, fit: &Fit, noise: Noise) -> Fit {
    let mut model = Model { noise, ..fit.model.clone() };
    let scatter: Vec<&Entry> =
        model.effects.present().into_iter().filter(|entry| entry.acts.changes == Changes::Scatter).collect();
    for entry in scatter {
        model.effects.remove(entry.name);
    }
    let own = |one: &&Parameter| !one.is_noise() && one.entry().is_none_or(is_of_path);
    let mut parameters: Vec<Parameter> = fit.parameters.iter().filter(own).copied().collect();
    parameters.insert(parameters.iter().take_while(|one| one.entry().is_none()).count(), Parameter::NoiseLevel);
    slow.problem.fit(&model, &parameters)
}

/// The added effects on the path.
fn of_path(found: &Selection) -> impl Iterator<Item = &NamedEffect> {
    found.effects.iter().filter(|named| named.change == Change::Added && is_of_path(named.candidate.entry))
}

/// A fit by forecasts with the effects on the path that were found by likelihood, added one by one.
fn with_found_effects(slow: &Search<'_>, refitted: Fit, found: &Selection) -> Fit {
    of_path(found).map(|named| named.candidate.entry).fold(refitted, |fit, entry| {
        let values = found.fit.model.effects.values(entry.name).unwrap_or_default();
        added(&fit.model, &fit.parameters, entry, &values)
            .map_or(fit, |(model, parameters)| slow.problem.fit(&model, &parameters))
    })
}

/// The weight of a reading: the effective sample size of the innovations, per innovation.
fn weight(search: &Search<'_>, fit: &Fit) -> f64 {
    let counted = fit.innovations.iter().filter(|one| !one.repeat && search.problem.folds.counts(one.row));
    effective_sample_share(&counted.map(|one| one.standardised).collect::<Vec<f64>>())
}

/// The effective sample size of a series, per number of it.
fn effective_sample_share(all: &[f64]) -> f64 {
    let product = |lag: usize| all.iter().zip(&all[lag..]).map(|(a, b)| a * b).sum::<f64>();
    let power = product(0);
    let correlations = (1..all.len() / 2).map(|lag| product(lag) / power).take_while(|correlation| *correlation > 0.0);
    let sum = 1.0 + 2.0 * correlations.sum::<f64>();
    if sum.is_finite() { 1.0 / sum } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::{ByForecasts, HORIZONS_S, effective_sample_share, slow_noise};
    use crate::fit::parameter::Parameter;
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::select::stepwise::Selection;
    use crate::tests_support::{model, record};

    #[test]
    fn a_reading_counts_by_the_integrated_autocorrelation_of_the_innovations() {
        // A first-order autoregression has 1 + 2·Σρ^k = (1 + ρ)/(1 − ρ).
        for rho in [0.0_f64, 0.5, 0.9] {
            let (mut state, mut last) = (1_u64, 0.0);
            let mut noise = || {
                let uniform: f64 = (0..12)
                    .map(|_| {
                        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                        (state >> 11) as f64 / (1_u64 << 53) as f64
                    })
                    .sum();
                uniform - 6.0
            };
            let series: Vec<f64> = (0..20_000)
                .map(|_| {
                    last = rho * last + noise();
                    last
                })
                .collect();
            let (found, expected) = (effective_sample_share(&series), (1.0 - rho) / (1.0 + rho));
            assert!((found / expected - 1.0).abs() < 0.2, "rho {rho}: {found}, expected {expected}");
        }
        assert_eq!(effective_sample_share(&[0.0; 10]), 1.0);
    }

    #[test]
    fn the_level_of_the_noise_leaves_the_bandwidth_of_the_filter() {
        let (belief, recording) = (model(), record(&model(), 1, 12));
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let period_s = recording.mean_reading_period_s();
        let bandwidth =
            |noise: plant::Noise| (noise.acceleration_psd_mm2_per_s3 / (noise.sensor_mm.powi(2) * period_s)).powf(0.25);
        let [noise, _] = HORIZONS_S.map(|horizon_s| {
            let noise = slow_noise(&search, &refitted(&search), horizon_s);
            assert!((bandwidth(noise) * horizon_s - 1.0).abs() < 1e-12);
            noise
        });
        let louder = Parameter::NoiseLevel.stepped(&plant::Model { noise, ..belief.clone() }, 0.7).noise;
        assert!((louder.sensor_mm / noise.sensor_mm - 0.7_f64.exp()).abs() < 1e-12);
        assert!((bandwidth(louder) / bandwidth(noise) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn forecasts_of_a_right_model_are_better_after_another_fit_by_chance_alone() {
        let is_better = |seed: &u64| {
            // A weighted fit leans more on the belief, which a right one would favour.
            let belief = plant::Model { gain_mm_per_s2_per_percent: 280.0, ..model() };
            let recording = record(&model(), *seed, 60);
            let folds = Folds::new(&belief, &recording);
            let search = Search::new(&belief, &recording, &folds, &Options::default());
            let refitted = refitted(&search);
            ByForecasts::where_better(&search, &refitted, &Selection::nothing(&search, &refitted)).is_some()
        };
        // One in 20 is by chance over each horizon; three of six are in 2 of 100 such tests.
        assert!((0..6).filter(is_better).count() < 3);
    }
}
