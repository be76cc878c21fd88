//! Nested effects: one that contains a simpler one, as a fan of two time constants contains one of a single time
//! constant.
//!
//! The richer effect has a parameter more, and where something else is missing, that parameter follows it. So the
//! richer effect is a candidate only if it gains more beyond the simpler one than the omitted terms of the score test
//! do: otherwise these, and not the additional parameter, are what is missing.

use crate::fit::estimate::Fit;
use crate::residual::misfit::Misfit;
use crate::select::candidates::Candidate;
use crate::select::screening::{Screened, added};
use crate::select::search::Search;
use crate::thresholds::{SECOND_EFFECT, SHARE_OF_EXPLAINED};
use plant::Entry;

/// The starts of the simpler effects that promising ones contain: those of their own screening, and others at the base
/// parameters of the richer effect, where its values are equal. Alone, the simpler one may stop at a lower maximum.
pub(crate) fn simpler_starts(
    search: &Search<'_>,
    promising: &[&Screened],
    screened: &[Screened],
    so_far: &Fit,
) -> Vec<Screened> {
    let richer = promising.iter().filter(|rich| rich.entry.contains.is_some());
    let own = |rich: &Screened| screened.iter().find(|one| Some(one.entry.name) == rich.entry.contains).cloned();
    let is_new = |one: &Screened| !promising.iter().any(|other| other.entry.name == one.entry.name);
    richer.flat_map(|rich| own(rich).filter(is_new).into_iter().chain(simplified(search, rich, so_far))).collect()
}

/// The start of the simpler effect where the richer one ended; `None` if `so_far` has it, or it may not be named.
fn simplified(search: &Search<'_>, rich: &Screened, so_far: &Fit) -> Option<Screened> {
    let entry = search.entries().into_iter().find(|entry| Some(entry.name) == rich.entry.contains)?;
    let values = rich.model.effects.values(rich.entry.name)?;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    instead(rich, so_far, entry, &[mean])
}

/// The start of `entry` at these values where `screened` ended, in place of the effect of that. `None`: `so_far` has
/// it, or cannot have it.
pub(crate) fn instead(screened: &Screened, so_far: &Fit, entry: &'static Entry, values: &[f64]) -> Option<Screened> {
    let mut base = screened.model.clone();
    base.effects.remove(screened.entry.name);
    let (model, parameters) = added(&base, &so_far.parameters, entry, values)?;
    Some(Screened { entry, model, parameters, rivals: Vec::new(), ..screened.clone() })
}

/// What a richer effect or form must gain beyond the simpler one, nats.
pub(crate) fn enough_beyond_simpler(rich: &Candidate) -> f64 {
    SECOND_EFFECT.max(SHARE_OF_EXPLAINED * rich.held_out_gain)
}

/// Removes each effect whose gain beyond the simpler one that it contains is too small. The simpler one is another
/// candidate, or `so_far` has it.
pub(crate) fn remove_needless(search: &Search<'_>, all: &mut Vec<Candidate>, so_far: &Fit) {
    let needless: Vec<&str> =
        all.iter().filter(|rich| is_needless(search, rich, all, so_far)).map(|rich| rich.entry.name).collect();
    all.retain(|candidate| !needless.contains(&candidate.entry.name));
}

fn is_needless(search: &Search<'_>, rich: &Candidate, all: &[Candidate], so_far: &Fit) -> bool {
    let Some(simpler) = rich.entry.contains else { return false };
    let (beyond, fit) = match all.iter().find(|other| other.entry.name == simpler) {
        Some(other) => (rich.held_out_gain - other.held_out_gain, &other.fit),
        None if so_far.model.effects.values(simpler).is_some() => (rich.held_out_gain, so_far),
        None => return false,
    };
    beyond < enough_beyond_simpler(rich) || beyond < omitted(search, fit)
}

/// What the omitted terms of the score test gain beside `fit`, nats; 0 in a search by forecasts, whose innovations are
/// not white.
fn omitted(search: &Search<'_>, fit: &Fit) -> f64 {
    if search.is_by_forecasts() { 0.0 } else { Misfit::of(&search.problem, fit, None).omitted_in_full() }
}

#[cfg(test)]
mod tests {
    use super::{omitted, remove_needless};
    use crate::fit::estimate::Fit;
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::candidates::Candidate;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::select::stepwise::select_effects;
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    /// A test of a search without effects on a record of a rig with these.
    fn on_rig<R>(effects: &[(&str, &[f64])], test: impl FnOnce(&Search<'_>, &Fit) -> R) -> R {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = belief.clone();
        for (name, values) in effects {
            assert!(rig.effects.set(name, values));
        }
        let recording = record(&rig, 0, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        test(&search, &refitted(&search))
    }

    /// Whether the richer effect stays that gains `beyond` more than the simpler one, or than `fit` if that has it.
    fn stays(search: &Search<'_>, fit: &Fit, beyond: f64) -> bool {
        let has_simpler = fit.model.effects.fan_lag.is_some();
        let candidate = |(name, held_out_gain): (&str, f64)| Candidate {
            entry: Effects::built_in(name).unwrap(),
            fit: fit.clone(),
            without_each_fold: Vec::new(),
            held_out_gain,
            penalised_gain: held_out_gain,
        };
        let beside = [("fan_lag", 50.0), ("spin_asymmetry", 50.0 + beyond), ("sensor_lag", 49.0)].map(candidate);
        let instead = [("spin_asymmetry", beyond)].map(candidate);
        let mut all = if has_simpler { instead.to_vec() } else { beside.to_vec() };
        let before = all.len();
        remove_needless(search, &mut all, fit);
        let is_there = all.iter().any(|candidate| candidate.entry.name == "spin_asymmetry");
        assert_eq!(all.len() + usize::from(!is_there), before);
        is_there
    }

    #[test]
    fn where_nothing_else_is_missing_the_richer_effect_stays_by_what_a_second_effect_must_gain() {
        on_rig(&[], |search, fit| {
            assert!(omitted(search, fit) < 5.0);
            assert!(stays(search, fit, 5.6) && !stays(search, fit, 5.4));
        });
    }

    #[test]
    fn where_something_else_is_missing_it_must_gain_more_than_the_omitted_terms() {
        on_rig(&[("hysteresis", &[0.8])], |search, fit| {
            let missing = omitted(search, fit);
            assert!(missing > 10.0, "{missing}");
            assert!(stays(search, fit, missing + 0.1) && !stays(search, fit, missing - 0.1));
        });
    }

    #[test]
    fn the_same_holds_for_one_that_would_replace_a_simpler_effect_of_the_model() {
        on_rig(&[("hysteresis", &[0.8])], |search, fit| {
            let mut with_lag = fit.clone();
            with_lag.model.effects.set("fan_lag", &[0.01]);
            let missing = omitted(search, &with_lag);
            assert!(stays(search, &with_lag, missing + 0.1) && !stays(search, &with_lag, missing - 0.1));
        });
    }

    #[test]
    fn a_fan_of_two_time_constants_is_found_as_such_amid_hysteresis() {
        on_rig(&[("spin_asymmetry", &[0.45, 0.08]), ("hysteresis", &[0.4])], |search, fit| {
            let found = select_effects(search, fit);
            let mut names: Vec<&str> = found.added().into_iter().map(|entry| entry.name).collect();
            names.sort_unstable();
            assert_eq!(names, ["hysteresis", "spin_asymmetry"]);
        });
    }
}
