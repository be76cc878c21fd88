//! Whether what a fit found is what its name says, and what that name costs on a rig that is believed to be as it is.

use crate::fit::lag_form::lags;
use crate::select::candidates::Candidate;
use crate::select::search::Search;
use crate::thresholds::{COST_BESIDE_A_LAG, NOTHING, SHARE_OF_A_LAG};
use plant::{Effects, Entry, Neutral, Readings};

/// Whether an effect was found, and not just noise or other base parameters under its name.
pub(crate) fn is_plausible(search: &Search<'_>, candidate: &Candidate) -> bool {
    does_something(search, candidate) && can_show(search, candidate) && is_more_than_form(search, candidate)
}

/// A fit that switched its effect off again has found better numbers for the rest, and no effect.
fn does_something(search: &Search<'_>, candidate: &Candidate) -> bool {
    let Candidate { entry, fit, .. } = candidate;
    if entry.start.is_read_off() {
        return true;
    }
    let matters = |index: usize| !matches!(entry.params[index].neutral, Neutral::Any(_));
    let own = fit.parameters.iter().filter(|one| one.index_in(entry.name).is_some_and(matters));
    let mut off = own.filter_map(|one| one.distance_from_neutral(&fit.model, search.problem.belief));
    off.any(|off| off.abs() > NOTHING)
}

/// Whether every effect of the model that is not believed has values that readings can show as its own.
fn can_show(search: &Search<'_>, candidate: &Candidate) -> bool {
    let (recording, belief) = (search.problem.recording, search.problem.belief);
    let period_s = recording.duration_s() / recording.readings().max(1) as f64;
    let readings = Readings { sigma_mm: belief.noise.sensor_mm, period_s };
    let effects = &candidate.fit.model.effects;
    let added = effects.present().into_iter().filter(|entry| belief.effects.values(entry.name).is_none());
    added.into_iter().all(|entry| effects.can_show(entry.name, &readings))
}

/// Where the speed of the fan is recorded, its lag is seen as it is, and has no form to be mistaken.
fn is_more_than_form(search: &Search<'_>, candidate: &Candidate) -> bool {
    search.problem.recording.has_fan_speed() || !is_form_of_a_lag(&candidate.entry, &candidate.fit.model.effects)
}

/// A rig's lag is never quite of first order: where one is believed, another effect that makes things late may only mend its form.
pub(crate) fn cost_of_form(search: &Search<'_>, entry: &Entry) -> f64 {
    let believed = &search.problem.belief.effects;
    let lag = lags().any(|lag| believed.values(lag.name).is_some());
    if lag && entry.acts.late.is_some() { COST_BESIDE_A_LAG } else { 0.0 }
}

/// Whether an effect is late by so little beside a lag that it may be the rest of that lag, which is never quite of first order.
fn is_form_of_a_lag(entry: &Entry, effects: &Effects) -> bool {
    let own_s = effects.late_s(entry.name);
    let beside_s: f64 = lags().filter(|lag| lag.name != entry.name).map(|lag| effects.late_s(lag.name)).sum();
    entry.acts.late.is_some() && own_s < SHARE_OF_A_LAG * (own_s + beside_s)
}

#[cfg(test)]
mod tests {
    use super::is_form_of_a_lag;
    use plant::{Effects, Entry};

    fn entry(name: &str) -> &'static Entry {
        Effects::entry(name).unwrap()
    }

    /// Effects with these first numbers, the second of two the same.
    fn with(lates: &[(&str, f64)]) -> Effects {
        let mut effects = Effects::default();
        for (name, seconds) in lates {
            effects.set(name, &vec![*seconds; Effects::entry(name).unwrap().params.len()]);
        }
        effects
    }

    #[test]
    fn what_is_late_by_little_beside_a_lag_is_its_form() {
        let lag = ("fan_lag", 0.2);
        for late in ["transport_delay", "sensor_delay", "sensor_lag"] {
            assert!(is_form_of_a_lag(entry(late), &with(&[lag, (late, 0.03)])), "{late}");
            assert!(!is_form_of_a_lag(entry(late), &with(&[lag, (late, 0.05)])), "{late}");
            assert!(!is_form_of_a_lag(entry(late), &with(&[(late, 0.03)])), "{late} alone");
        }
        assert!(is_form_of_a_lag(entry("fan_lag"), &with(&[("fan_lag", 0.02), ("sensor_lag", 0.2)])));
        assert!(is_form_of_a_lag(entry("sensor_delay"), &with(&[("sensor_delay", 0.02), ("spin_asymmetry", 0.2)])));
        assert!(!is_form_of_a_lag(entry("spin_asymmetry"), &with(&[("spin_asymmetry", 0.02)])));
        assert!(!is_form_of_a_lag(entry("dead_zone"), &with(&[lag, ("dead_zone", 0.01)])));
    }
}
