//! Twins: effects that a record hardly tells apart, such as a lag of the fan and one of the sensor, or a delay of the duty
//! and one of the reading. At the end of a search, each named effect is compared with its twins beside all the others.

use crate::fit::estimate::Fit;
use crate::select::coloured_force::held_out_beside_coloured_force;
use crate::select::screening::added;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect};
use crate::thresholds::INDISTINGUISHABLE_TWINS;
use plant::Entry;

/// Compares each added effect with its twins: a twin takes the place of the effect, is indistinguishable from it, or is
/// neither.
pub(crate) fn compare_twins(search: &Search<'_>, effects: &mut [NamedEffect], fit: &mut Fit) {
    for named in effects.iter_mut().filter(|named| named.change == Change::Added) {
        for twin in twins(search, named.candidate.entry) {
            compare(search, named, twin, fit);
        }
    }
}

/// The effects of the search that are twins of `entry`.
pub(crate) fn twins(search: &Search<'_>, entry: &Entry) -> impl Iterator<Item = &'static Entry> {
    search.entries().into_iter().filter(|other| entry.twins.contains(&other.name))
}

fn compare(search: &Search<'_>, named: &mut NamedEffect, twin: &'static Entry, fit: &mut Fit) {
    let entry = named.candidate.entry;
    let Some(other) = in_place_of(search, entry, twin, fit) else { return };
    // Beside a white random force, the one that smooths the readings would be preferred.
    let smooths = entry.acts.smooths_readings() || twin.acts.smooths_readings();
    let total = |fit: &Fit| {
        if smooths { held_out_beside_coloured_force(search, fit) } else { search.held_out_total(fit) }
    };
    let gain = total(&other) - total(fit);
    if let Some(at) = named.indistinguishable_from.iter().position(|name| *name == twin.name) {
        named.indistinguishable_from.remove(at);
        named.rivals.remove(at);
    }
    if gain > INDISTINGUISHABLE_TWINS {
        (named.candidate.entry, named.candidate.fit) = (twin, other.clone());
        *fit = other;
    } else if gain > -INDISTINGUISHABLE_TWINS {
        named.indistinguishable_from.push(twin.name);
        named.rivals.push(other.model);
    }
}

/// The fit with `twin` in the place of `entry`, from the same values; `None` if it has the twin as well.
pub(crate) fn in_place_of(search: &Search<'_>, entry: &Entry, twin: &'static Entry, fit: &Fit) -> Option<Fit> {
    let values = fit.model.effects.values(entry.name)?;
    let (model, parameters) = search.start_without(fit, &[entry]);
    let (model, parameters) = added(&model, &parameters, twin, &values)?;
    Some(search.problem.fit(&model, &parameters))
}

#[cfg(test)]
mod tests {
    use super::compare_twins;
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::addition::best_addition;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::tests_support::{model, record};
    use crate::thresholds::SECOND_EFFECT;
    use plant::{Effects, Model};

    /// The effect that is named once `named`, found by a search for it alone, is compared with its twin, and the effects
    /// that are indistinguishable from it. `rig`: the effects of the rig.
    fn compared(rig: &[(&str, &[f64])], named: &str) -> (&'static str, Vec<&'static str>) {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut other = belief.clone();
        other.noise.sensor_mm = 0.3;
        for (name, values) in rig {
            other.effects.set(name, values);
        }
        let recording = record(&other, 5, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let alone = search.without(|entry| entry.name != named);
        let (found, _) = best_addition(&alone, &refitted(&search), SECOND_EFFECT);
        let mut effects = [found.unwrap()];
        let mut fit = effects[0].candidate.fit.clone();
        compare_twins(&search, &mut effects, &mut fit);
        let [found] = effects;
        assert!(fit.model.effects.values(found.candidate.entry.name).is_some());
        assert_eq!(found.rivals.len(), found.indistinguishable_from.len());
        (found.candidate.entry.name, found.indistinguishable_from)
    }

    #[test]
    fn a_twin_takes_the_place_of_an_effect_that_explains_less() {
        assert_eq!(compared(&[("sensor_lag", &[0.1])], "fan_lag"), ("sensor_lag", vec![]));
        assert_eq!(compared(&[("fan_lag", &[0.25])], "fan_lag"), ("fan_lag", vec![]));
    }

    #[test]
    fn a_twin_that_explains_as_much_is_indistinguishable() {
        let (name, others) = compared(&[("transport_delay", &[0.1])], "sensor_delay");
        assert_eq!((name, others), ("sensor_delay", vec!["transport_delay"]));
    }

    #[test]
    fn a_lag_of_the_fan_amid_turbulence_is_not_taken_for_one_of_the_sensor() {
        let rig: [(&str, &[f64]); 2] = [("fan_lag", &[0.257]), ("turbulence", &[80.0, 0.3])];
        let (name, others) = compared(&rig, "sensor_lag");
        assert!(name == "fan_lag" || others.contains(&"fan_lag"), "{name} {others:?}");
    }
}
