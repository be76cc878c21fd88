//! What changed on a rig between two records: one model with the effects of both, fitted to each with the same belief.
//!
//! ```text
//! d = b − a,  σ² = σ_a² + σ_b²        of every number; a change beyond chance: P(|N| > |d|/σ) < 0.05/numbers
//! ```
//!
//! The same parameters are fitted on both sides, because numbers of models with different effects cannot be compared: a
//! dead zone that one model lacks moves its gain. An effect that one side does not have is near its neutral value
//! there. The belief decides where a record knows two numbers only together, such as gain and lag of a slow loop. It is
//! the same on both sides, so that it makes no change. What single numbers do not show, they may show together:
//!
//! ```text
//! χ² = dᵀ·(C_a + C_b)⁻¹·d       d: differences of the base parameters and noises, in their own scales
//! ```

use crate::answer::diagnosis::Diagnosis;
use crate::fit::estimate::{Fit, Problem};
use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
use crate::gap::forecast_error::{FreeRun, Gap, free_runs};
use crate::record::decimate::Purpose;
use crate::record::folds::Folds;
use crate::record::prepare::Prepared;
use crate::record::recording::Recording;
use crate::select::stepwise::{Change, NamedEffect};
use crate::stats::chi_square::ln_chance;
use crate::thresholds::WIDER;
use nalgebra::DVector;
use plant::{Changes as Scatters, Effects, Entry, Model};

/// The chance of any change that is none, over all numbers together.
const CHANCE: f64 = 0.05;

/// A number of the rig before and after.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct NumberChange {
    /// The table of the config below `[plant]`: empty, `noise`, or the effect.
    pub table: String,
    /// Its key there.
    pub key: String,
    /// The value before.
    pub before: f64,
    /// The value after.
    pub after: f64,
    /// Standard deviation of the difference; `None`: a record does not determine the number.
    pub deviation: Option<f64>,
    /// Whether the difference is larger than chance makes it, all numbers that are compared together.
    pub is_beyond_chance: bool,
}

impl NumberChange {
    /// A number with its values before and after, and the standard deviation of each; not yet judged.
    #[must_use]
    pub fn new(table: &str, key: &str, [before, after]: [f64; 2], deviations: [Option<f64>; 2]) -> Self {
        let [a, b] = deviations.map(|one| one.unwrap_or(f64::NAN));
        let deviation = Some(a.hypot(b)).filter(|deviation| *deviation > 0.0 && deviation.is_finite());
        Self { table: table.into(), key: key.into(), before, after, deviation, is_beyond_chance: false }
    }

    /// Judges all numbers of a comparison: each has its share of the chance of a change that is none.
    pub fn judge(all: &mut [Self]) {
        let chance = CHANCE / all.len().max(1) as f64;
        for one in all {
            let beyond = |deviation: f64| two_sided((one.after - one.before) / deviation) < chance;
            one.is_beyond_chance = one.deviation.is_some_and(beyond);
        }
    }
}

/// A record, and the free runs and forecast errors of the models of both records on it.
#[derive(Clone, Debug)]
pub struct Side {
    /// The rows that were used.
    pub recording: Recording,
    /// Its own model.
    pub model: Model,
    /// Forecast errors of the model of before and of that of after, on this record.
    pub gaps: [Gap; 2],
    /// Free runs of the same two.
    pub runs: [Vec<FreeRun>; 2],
}

/// Two records of one rig.
#[derive(Clone, Debug)]
pub struct Changes {
    /// The numbers, base parameters first.
    pub changes: Vec<NumberChange>,
    /// Whether base parameters and noises changed beyond chance, all taken together.
    pub is_together_beyond_chance: bool,
    /// Before and after.
    pub sides: [Side; 2],
}

impl Changes {
    /// Compares two records of a rig, each with its diagnosis by `belief`.
    #[must_use]
    pub fn of(belief: &Model, found: [&Diagnosis; 2], recordings: [&[Recording]; 2]) -> Self {
        let entries = together(found);
        let prepared =
            recordings.map(|recordings| Prepared::of(recordings, belief, Purpose::Diagnosis).recording.into_owned());
        let starts = found.map(|one| with_effects(&one.mended.model, &entries, found));
        let [before, after] = &prepared;
        let fits = [fitted(belief, before, &starts), fitted(belief, after, &starts)];
        let changes = changes(&fits, &entries);
        let is_together_beyond_chance = together_beyond_chance(&fits);
        let models = fits.map(|fit| fit.model);
        let side = |at: usize| Side {
            recording: prepared[at].clone(),
            model: models[at].clone(),
            gaps: [0, 1].map(|model| Gap::measure(&models[model], &prepared[at])),
            runs: [0, 1].map(|model| free_runs(&models[model], &prepared[at])),
        };
        Self { changes, is_together_beyond_chance, sides: [side(0), side(1)] }
    }

    /// The changes beyond chance.
    pub fn beyond_chance(&self) -> impl Iterator<Item = &NumberChange> {
        self.changes.iter().filter(|change| change.is_beyond_chance)
    }
}

/// The effects that either side has or believes, without a second one that is another's twin or excludes it.
fn together(found: [&Diagnosis; 2]) -> Vec<&'static Entry> {
    let mut entries: Vec<&'static Entry> = Vec::new();
    let is_new = |entries: &[&'static Entry], entry: &'static Entry| {
        let like = |other: &&&'static Entry| {
            let twins = entry.twins.contains(&other.name) || other.twins.contains(&entry.name);
            other.name == entry.name || twins || Effects::exclude_each_other(other.name, entry.name)
        };
        !entries.iter().any(|other| like(&other))
    };
    let named = |one: &NamedEffect| one.change != Change::Removed;
    for one in found {
        let present = one.mended.model.effects.present().into_iter();
        for entry in one.effects.iter().filter(|one| named(one)).map(|one| one.candidate.entry).chain(present) {
            // The noise of the readings is a base parameter: a second one cannot be told from it.
            let is_noise = entry.acts.changes == Scatters::Scatter && !entry.acts.follows_any_force();
            if !is_noise && is_new(&entries, entry) {
                entries.push(entry);
            }
        }
    }
    entries
}

/// A model with these effects: with its own values, or those of the side that has the effect.
fn with_effects(model: &Model, entries: &[&'static Entry], found: [&Diagnosis; 2]) -> Model {
    let mut with = model.clone();
    for entry in model.effects.present() {
        if !entries.iter().any(|other| other.name == entry.name) {
            with.effects.remove(entry.name);
        }
    }
    for entry in entries {
        let values = |one: &Diagnosis| {
            one.mended.model.effects.values(entry.name).or_else(|| one.with_effects.model.effects.values(entry.name))
        };
        if with.effects.values(entry.name).is_none()
            && let Some(values) = found.into_iter().find_map(values)
        {
            with.effects.set(entry.name, &values);
        }
    }
    with
}

/// The most likely model of a record from these initial values.
fn fitted(belief: &Model, recording: &Recording, starts: &[Model; 2]) -> Fit {
    let folds = Folds::new(belief, recording);
    let problem = Problem { recording, belief, folds: &folds, prior: Prior::Belief };
    let fit = |start: &Model| problem.fit(start, &parameters(start));
    let likelihood = |fit: &Fit| fit.log_likelihood(|row| folds.counts(row)) + fit.log_prior;
    let [a, b] = [fit(&starts[0]), fit(&starts[1])];
    if likelihood(&a) >= likelihood(&b) { a } else { b }
}

/// The base parameters and those of all effects.
fn parameters(model: &Model) -> Vec<Parameter> {
    let of = |entry: &'static Entry| parameters_of_effect(entry, &model.effects.values(entry.name).unwrap_or_default());
    BASE.into_iter().chain(model.effects.present().into_iter().flat_map(of)).collect()
}

/// A number of a model.
struct Number {
    table: &'static str,
    key: &'static str,
    of: Box<dyn Fn(&Model) -> f64>,
}

fn numbers(entries: &[&'static Entry]) -> Vec<Number> {
    let base = BASE.into_iter().map(|one| {
        let of = Box::new(move |model: &Model| one.value(model).unwrap_or(f64::NAN));
        Number { table: if one.is_noise() { "noise" } else { "" }, key: one.key(), of }
    });
    let of_effect = |entry: &&'static Entry| {
        let entry = *entry;
        let value = move |model: &Model, at: usize| {
            model.effects.values(entry.name).and_then(|values| values.get(at).copied()).unwrap_or(f64::NAN)
        };
        // Where the difference of two numbers is known far better than each, it alone is compared.
        let difference = entry.difference.map(|difference| {
            let [from, to] = difference.of;
            let of = Box::new(move |model: &Model| value(model, to) - value(model, from));
            Number { table: entry.name, key: difference.key, of }
        });
        let apart = entry.difference.map_or([usize::MAX; 2], |difference| difference.of);
        let each = entry.params.iter().enumerate().filter(|(at, _)| !apart.contains(at)).map(|(at, param)| {
            let of = Box::new(move |model: &Model| value(model, at));
            Number { table: entry.name, key: param.name, of }
        });
        difference.into_iter().chain(each.collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    base.chain(entries.iter().flat_map(of_effect)).collect()
}

fn changes(fits: &[Fit; 2], entries: &[&'static Entry]) -> Vec<NumberChange> {
    let change = |number: Number| {
        let values = fits.each_ref().map(|fit| (number.of)(&fit.model));
        let deviations = fits.each_ref().map(|fit| Some(WIDER * fit.deviation_of(&number.of)));
        NumberChange::new(number.table, number.key, values, deviations)
    };
    // A simpler form of an effect has fewer numbers than its entry has parameters.
    let has_value = |number: &Number| !(number.of)(&fits[0].model).is_nan();
    let mut all: Vec<NumberChange> = numbers(entries).into_iter().filter(has_value).map(change).collect();
    NumberChange::judge(&mut all);
    all
}

/// Whether the base parameters and noises of two fits differ beyond chance together.
fn together_beyond_chance(fits: &[Fit; 2]) -> bool {
    let [before, after] = fits;
    let [a, b] = fits.each_ref().map(|fit| fit.covariance().view((0, 0), (BASE.len(), BASE.len())).into_owned());
    let covariance = (a + b) * (WIDER * WIDER);
    let apart = BASE.map(|one| one.distance(&after.model, &before.model));
    let apart = DVector::from_row_slice(&apart);
    let solved = covariance.cholesky().map(|cholesky| apart.dot(&cholesky.solve(&apart)));
    solved.is_some_and(|square| square.is_finite() && ln_chance(square, BASE.len()) < CHANCE.ln())
}

/// The chance that a standard normal number is farther from 0.
fn two_sided(z: f64) -> f64 {
    libm::erfc(z.abs() / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::Changes;
    use crate::tests_support::{model, record, shaken};
    use crate::{Options, Recording, diagnose};
    use plant::Model;

    fn compared(before: &Model, after: &Model, seed: u64, fly: fn(&Model, u64, u32) -> Recording) -> Changes {
        let belief = model();
        let recordings = [vec![fly(before, seed, 60)], vec![fly(after, seed + 50, 60)]];
        let found = recordings.each_ref().map(|one| diagnose(&belief, one, &Options::default()));
        Changes::of(&belief, found.each_ref(), recordings.each_ref().map(Vec::as_slice))
    }

    #[test]
    fn two_flights_of_a_rig_that_did_not_change_differ_by_chance_alone() {
        for seed in 0..3 {
            let found = compared(&model(), &model(), seed, record);
            let beyond: Vec<_> = found.beyond_chance().collect();
            assert!(beyond.is_empty() && !found.is_together_beyond_chance, "seed {seed}: {beyond:?}");
        }
    }

    #[test]
    fn a_dead_zone_that_was_corrected_is_the_change_and_the_gain_is_none() {
        let mut before = model();
        before.effects.set("dead_zone", &[-0.4, 0.4]);
        let found = compared(&before, &model(), 3, record);
        let names: Vec<_> = found.beyond_chance().map(|change| (change.table.as_str(), change.key.as_str())).collect();
        assert_eq!(names, [("dead_zone", "width_percent")], "{:?}", found.changes);
        let width = found.beyond_chance().next().unwrap();
        assert!((width.before - 0.8).abs() < 0.25 && width.after < 0.2, "{width:?}");
        // Each model forecasts its own record best.
        let error = |side: usize, model: usize| found.sides[side].gaps[model].error_mm[2].unwrap();
        assert!(error(0, 0) < error(0, 1) && error(1, 1) < error(1, 0));
    }

    #[test]
    fn a_lost_part_of_the_gain_and_a_noisier_sensor_are_found_as_such() {
        let mut after = model();
        after.gain_mm_per_s2_per_percent *= 0.7;
        after.noise.sensor_mm *= 1.5;
        let found = compared(&model(), &after, 4, shaken);
        let keys: Vec<_> = found.beyond_chance().map(|change| change.key.as_str()).collect();
        assert!(keys.contains(&"gain_mm_per_s2_per_percent") && keys.contains(&"sensor_mm"), "{:?}", found.changes);
        assert!(found.is_together_beyond_chance && !keys.contains(&"hover_duty_percent"), "{:?}", found.changes);
    }
}
