//! Whether a fitted effect is plausible, and its penalty next to a believed lag.

use crate::fit::estimate::Fit;
use crate::fit::lag_form::lags;
use crate::record::check::other_rig;
use crate::select::candidates::Candidate;
use crate::select::search::Search;
use crate::thresholds::{COST_BESIDE_A_LAG, NOTHING, SHARE_OF_A_LAG};
use plant::{Effects, Entry, Model, Neutral, Readings};

/// Whether the effect is more than noise or other base parameters under its name, added to the fit `so_far`.
pub(crate) fn is_plausible(search: &Search<'_>, candidate: &Candidate, so_far: &Fit) -> bool {
    does_something(search, candidate)
        && can_show(search, candidate)
        && is_more_than_form(search, candidate)
        // Numbers that were fitted beside a noise that hides what is missing may be far off.
        && (search.noise_hides || is_of_this_rig(search.problem.belief, &candidate.fit.model, &so_far.model))
}

/// Whether gain and drag are near those of the belief, or were far from them without the effect as well.
fn is_of_this_rig(belief: &Model, fit: &Model, so_far: &Model) -> bool {
    other_rig(belief, fit).is_none() || other_rig(belief, so_far).is_some()
}

/// Whether the effect is switched on in its fit. If not, only the other parameters improved.
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

/// Whether the values of every effect that is not believed are observable in the readings.
fn can_show(search: &Search<'_>, candidate: &Candidate) -> bool {
    let (recording, belief) = (search.problem.recording, search.problem.belief);
    let period_s = recording.mean_reading_period_s();
    let readings = Readings { sigma_mm: belief.noise.sensor_mm, period_s };
    let effects = &candidate.fit.model.effects;
    let added = effects.present().into_iter().filter(|entry| belief.effects.values(entry.name).is_none());
    added.into_iter().all(|entry| effects.can_show(entry.name, &readings))
}

/// With a recorded fan speed the form of the fan lag is known, so that nothing can stand for it.
fn is_more_than_form(search: &Search<'_>, candidate: &Candidate) -> bool {
    search.problem.recording.has_fan_speed() || !is_form_of_a_lag(candidate.entry, &candidate.fit.model.effects)
}

/// Penalty of another lag or dead time next to a believed lag: no real lag is exactly first-order, so it may only
/// correct the form.
pub(crate) fn cost_of_form(search: &Search<'_>, entry: &Entry) -> f64 {
    let believed = &search.problem.belief.effects;
    let lag = lags().any(|lag| believed.values(lag.name).is_some());
    if lag && entry.acts.late.is_some() { COST_BESIDE_A_LAG } else { 0.0 }
}

/// Whether an effect delays so little next to a lag that it may be the deviation of that lag from first order.
fn is_form_of_a_lag(entry: &Entry, effects: &Effects) -> bool {
    let own_s = effects.late_s(entry.name);
    let beside_s: f64 = lags().filter(|lag| lag.name != entry.name).map(|lag| effects.late_s(lag.name)).sum();
    entry.acts.late.is_some() && own_s < SHARE_OF_A_LAG * (own_s + beside_s)
}

#[cfg(test)]
mod tests {
    use super::{is_form_of_a_lag, is_of_this_rig};
    use crate::tests_support::model;
    use plant::{Effects, Entry, Model};

    fn entry(name: &str) -> &'static Entry {
        Effects::built_in(name).unwrap()
    }

    /// Effects with these values, the same for each of their parameters.
    fn with(lates: &[(&str, f64)]) -> Effects {
        let mut effects = Effects::default();
        for (name, seconds) in lates {
            effects.set(name, &vec![*seconds; Effects::built_in(name).unwrap().params.len()]);
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

    #[test]
    fn an_effect_that_needs_the_gain_or_drag_of_another_rig_is_implausible_unless_the_rig_has_them_without_it() {
        let with = |gain: f64, drag: f64| Model {
            gain_mm_per_s2_per_percent: gain * model().gain_mm_per_s2_per_percent,
            drag_per_s: drag * model().drag_per_s,
            ..model()
        };
        for other in [with(295.0, 1.0), with(0.1, 1.0), with(1.0, 6.0)] {
            assert!(!is_of_this_rig(&model(), &other, &with(1.1, 0.9)));
            assert!(is_of_this_rig(&model(), &with(1.1, 0.9), &other));
            assert!(is_of_this_rig(&model(), &other, &other));
        }
        assert!(is_of_this_rig(&model(), &with(4.0, 0.01), &model()), "other numbers of the same rig");
    }
}
