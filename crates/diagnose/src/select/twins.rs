//! Twins: effects that a record tells apart by the colour of noise alone, such as a lag of the fan and one of the sensor.
//! They are compared beside a coloured random force ([`mod@crate::select::coloured_force`]).

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::select::coloured_force::held_out_beside_coloured_force;
use crate::select::screening::added;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect};
use crate::thresholds::INDISTINGUISHABLE_TWINS;
use plant::{Entry, Model};

/// Compares each added effect with its twins beside all the others: a twin takes the place of the effect, is
/// indistinguishable from it, or is neither.
pub(crate) fn compare_twins(search: &Search<'_>, effects: &mut [NamedEffect], fit: &mut Fit) {
    for named in effects.iter_mut().filter(|named| named.change == Change::Added) {
        let entries = search.entries().into_iter();
        for twin in entries.filter(|entry| named.candidate.entry.twins.contains(&entry.name)) {
            compare(search, named, twin, fit);
        }
    }
}

fn compare(search: &Search<'_>, named: &mut NamedEffect, twin: &'static Entry, fit: &mut Fit) {
    let Some((model, parameters)) = in_place_of(named.candidate.entry, twin, fit) else { return };
    let swapped = search.problem.fit(&model, &parameters);
    let gain = held_out_beside_coloured_force(search, &swapped) - held_out_beside_coloured_force(search, fit);
    if let Some(at) = named.indistinguishable_from.iter().position(|name| *name == twin.name) {
        named.indistinguishable_from.remove(at);
        named.rivals.remove(at);
    }
    if gain > INDISTINGUISHABLE_TWINS {
        (named.candidate.entry, named.candidate.fit) = (twin, swapped.clone());
        *fit = swapped;
    } else if gain > -INDISTINGUISHABLE_TWINS {
        named.indistinguishable_from.push(twin.name);
        named.rivals.push(swapped.model);
    }
}

/// The model of `fit` with `twin` of the same values in the place of `entry`, and its parameters; `None` if it has the
/// twin as well.
fn in_place_of(entry: &Entry, twin: &'static Entry, fit: &Fit) -> Option<(Model, Vec<Parameter>)> {
    let values = fit.model.effects.values(entry.name)?;
    let mut without = fit.clone();
    without.model.effects.remove(entry.name);
    without.parameters.retain(|parameter| !parameter.is_of(entry.name));
    added(&without, twin, &values)
}

#[cfg(test)]
mod tests {
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::select::stepwise::{is_random_force, select_effects};
    use crate::tests_support::{model, record};
    use plant::effects::Turbulence;
    use plant::{Effects, Model};

    #[test]
    fn a_lag_of_the_fan_amid_turbulence_is_not_told_from_one_of_the_sensor() {
        let mut rig = model();
        rig.noise.sensor_mm = 0.3;
        rig.effects.turbulence = Some(Turbulence { sigma_mm_per_s2: 120.0, correlation_s: 0.3 });
        let belief = Model { effects: Effects::default(), ..model() };
        let recording = record(&rig, 5, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default()).without(is_random_force);
        let found = select_effects(&search, &refitted(&search));
        let named = found.effects.iter().find(|named| named.candidate.entry.name.ends_with("_lag")).unwrap();
        let names = [&[named.candidate.entry.name], &named.indistinguishable_from[..]].concat();
        assert!(names.contains(&"fan_lag"), "{names:?}");
        assert_eq!(named.rivals.len(), named.indistinguishable_from.len());
    }
}
