//! Exchange: an effect that stood for another one as well when it was added yields to a rival that explains more beside the
//! others. Source: Pudil, Novovičová and Kittler, "Floating search methods in feature selection", Pattern Recognition
//! Letters 15 (1994).

use crate::fit::estimate::Fit;
use crate::select::addition::best_addition;
use crate::select::forecast::is_better;
use crate::select::posterior::Scored;
use crate::select::random_force::is_random_force;
use crate::select::search::Search;
use crate::select::stepwise::NamedEffect;
use crate::thresholds::{BEHIND, BEHIND_SHARE, SECOND_EFFECT};
use plant::Entry;

/// Searches for the effect at `at` again beside the others. Only effects that explained about as much in its round can
/// take its place, and only if they forecast no worse. A random force cannot: it would follow whatever the effect
/// explained.
pub(crate) fn exchange(
    search: &Search<'_>,
    effects: &mut [NamedEffect],
    fit: &mut Fit,
    rounds: &[Vec<Scored>],
    at: usize,
) {
    let old = effects[at].candidate.entry;
    let rivals = rivals_of(search, old, rounds);
    if rivals.len() < 2 {
        return;
    }
    let without = search.removed(fit, old);
    let among = search.without(|entry| !rivals.contains(&entry.name) || is_random_force(entry));
    let (again, _) = best_addition(&among, &without, SECOND_EFFECT);
    if let Some(again) = again.filter(|again| is_better(search, &again.candidate.fit, fit)) {
        *fit = again.candidate.fit.clone();
        effects[at] = again;
    }
}

/// The effects that explained about as much as `entry` in its round, itself among them. If it took the place of a twin
/// after the search, that twin's round is its own.
pub(crate) fn rivals_of(search: &Search<'_>, entry: &Entry, rounds: &[Vec<Scored>]) -> Vec<&'static str> {
    let round_of = |name: &str| rounds.iter().find(|round| round.first().is_some_and(|best| best.name == name));
    let own = round_of(entry.name).or_else(|| entry.twins.iter().find_map(|twin| round_of(twin)));
    let own = own.map(Vec::as_slice).unwrap_or_default();
    let best = own.first().map_or(0.0, |best| best.held_out_gain);
    let is_rival = |scored: &&Scored| scored.in_full && scored.held_out_gain > best * (1.0 - BEHIND_SHARE) - BEHIND;
    let mut rivals: Vec<&str> = own.iter().filter(is_rival).map(|scored| scored.name).collect();
    // Of two effects of which one contains the other, that of the round depends on what was missing then.
    rivals.extend(nested_with(search, &rivals));
    rivals
}

/// The effects that contain one of `names` or are contained in one.
fn nested_with(search: &Search<'_>, names: &[&str]) -> Vec<&'static str> {
    let pairs = search.entries().into_iter().filter_map(|entry| Some((entry.name, entry.contains?)));
    let other = |(rich, simple)| match [rich, simple].map(|name| names.contains(&name)) {
        [true, false] => Some(simple),
        [false, true] => Some(rich),
        _ => None,
    };
    pairs.filter_map(other).collect()
}

#[cfg(test)]
mod tests {
    use super::{exchange, rivals_of};
    use crate::fit::parameter::{BASE, Parameter, parameters_of_effect};
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::candidates::Candidate;
    use crate::select::odds::Evidence;
    use crate::select::posterior::Scored;
    use crate::select::search::Search;
    use crate::select::stepwise::{Change, NamedEffect};
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    /// The effect in the place of a lag, which gained 100 in its round, on a rig with a delay, which gained `gain` there.
    fn in_place_of_the_lag(gain: f64) -> &'static str {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = belief.clone();
        rig.effects.set("height_dependent_flow", &[12.0]);
        rig.effects.set("transport_delay", &[0.15]);
        let recording = record(&rig, 1, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let mut start = rig.clone();
        start.effects.remove("transport_delay");
        start.effects.set("sensor_lag", &[0.15]);
        let entries = ["height_dependent_flow", "sensor_lag"].map(|name| Effects::built_in(name).unwrap());
        let own = entries.map(|entry| parameters_of_effect(entry, &start.effects.values(entry.name).unwrap()));
        let parameters: Vec<Parameter> = BASE.into_iter().chain(own.into_iter().flatten()).collect();
        let mut fit = search.problem.fit(&start, &parameters);
        let mut effects = entries.map(|entry| NamedEffect {
            change: Change::Added,
            candidate: Candidate {
                entry,
                fit: fit.clone(),
                without_each_fold: Vec::new(),
                held_out_gain: 100.0,
                penalised_gain: 100.0,
            },
            probability: 1.0,
            evidence: Evidence::default(),
            indistinguishable_from: Vec::new(),
            rivals: Vec::new(),
        });
        let scored = |name, gain| Scored { name, held_out_gain: gain, penalised_gain: gain, in_full: true };
        let lag = vec![scored("sensor_lag", 100.0), scored("transport_delay", gain)];
        let rounds = [vec![scored("height_dependent_flow", 100.0)], lag];
        exchange(&search, &mut effects, &mut fit, &rounds, 1);
        assert!(fit.model.effects.values(effects[1].candidate.entry.name).is_some());
        effects[1].candidate.entry.name
    }

    #[test]
    fn the_rivals_of_an_effect_that_took_the_place_of_its_twin_are_those_of_the_twins_round() {
        let (belief, recording) = (model(), record(&model(), 1, 20));
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let scored = |name, gain| Scored { name, held_out_gain: gain, penalised_gain: gain, in_full: true };
        let rounds = [
            vec![scored("wall_friction", 300.0)],
            vec![scored("transport_delay", 100.0), scored("dead_zone", 99.0), scored("hover_drift", 1.0)],
        ];
        let of = |name| rivals_of(&search, Effects::built_in(name).unwrap(), &rounds);
        assert_eq!(of("transport_delay"), ["transport_delay", "dead_zone"]);
        assert_eq!(of("sensor_delay"), of("transport_delay"));
        assert!(of("height_dependent_flow").is_empty());
    }

    #[test]
    fn an_effect_yields_to_one_that_explains_more_beside_the_others_and_explained_about_as_much_before() {
        assert_eq!(in_place_of_the_lag(90.0), "transport_delay");
        assert_eq!(in_place_of_the_lag(10.0), "sensor_lag");
    }
}
