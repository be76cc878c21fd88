//! Random forces in a search: what they follow, and what else was found beside them.

use crate::fit::estimate::Fit;
use crate::select::elimination::backward_eliminate;
use crate::select::forecast::is_better;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect, Selection, SoFar, stepwise_search};
use plant::Entry;

/// Whether an effect can follow any missing force.
pub(crate) fn is_random_force(entry: &Entry) -> bool {
    entry.acts.follows_any_force()
}

/// The effects that are added to `refitted`. If a random force was found that is not plausible, the search is repeated
/// without it from where it was added: it followed something else that is missing, which is better left unexplained.
/// What was found beside the random force counts if it also explains more without it.
pub(super) fn search_from(search: &Search<'_>, refitted: &Fit) -> Selection {
    let (found, before_random_force) = stepwise_search(search, SoFar::nothing(refitted));
    let added = found.effects.iter().filter(|named| named.change == Change::Added);
    let after = added.skip_while(|named| !is_random_force(named.candidate.entry)).count();
    // No effect may follow a random force, which would have followed that effect as well.
    match before_random_force {
        Some(before) if after > 1 || (after == 1 && !found.misfit.allows_random_force()) => {
            let without_random = search.without(is_random_force);
            let again = stepwise_search(&without_random, before).0;
            let beside = (after > 1).then(|| without_random_force(&without_random, &found));
            beside.filter(|beside| is_better(&without_random, &beside.fit, &again.fit)).unwrap_or(again)
        }
        _ => found,
    }
}

/// The search that goes on from the effects of `found` without its random forces. Beside a force that follows whatever
/// is missing, small effects are seen that the misfit of the others hides otherwise.
fn without_random_force(without_random: &Search<'_>, found: &Selection) -> Selection {
    let added = found.effects.iter().filter(|named| named.change == Change::Added);
    let (random, others): (Vec<&NamedEffect>, Vec<&NamedEffect>) =
        added.partition(|named| is_random_force(named.candidate.entry));
    let random: Vec<&Entry> = random.into_iter().map(|named| named.candidate.entry).collect();
    let mut effects: Vec<NamedEffect> = others.into_iter().cloned().collect();
    let mut fit = without_random.without_effects(&found.fit, &random);
    backward_eliminate(without_random, &mut effects, &mut fit);
    stepwise_search(without_random, SoFar::after(found, effects, fit)).0
}

#[cfg(test)]
mod tests {
    use super::{is_random_force, without_random_force};
    use crate::Options;
    use crate::record::folds::Folds;
    use crate::select::addition::best_addition;
    use crate::select::forecast::is_better;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::select::stepwise::{NamedEffect, Selection};
    use crate::tests_support::{model, shaken};
    use plant::{Effects, Model};

    #[test]
    fn what_was_found_beside_a_random_force_stays_without_it() {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = belief.clone();
        rig.effects.set("dead_zone", &[-0.5, 0.5]);
        rig.effects.set("height_dependent_flow", &[6.0]);
        let recording = shaken(&rig, 1, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let first = refitted(&search);
        let only = |name: &'static str| search.without(move |entry| entry.name != name);
        let mut found = Selection::nothing(&search, &first);
        for name in ["turbulence", "dead_zone", "height_dependent_flow"] {
            let named: NamedEffect = best_addition(&only(name), &found.fit, f64::NEG_INFINITY).0.expect(name);
            found.fit = named.candidate.fit.clone();
            found.effects.push(named);
        }
        let without_random = search.without(is_random_force);
        let beside = without_random_force(&without_random, &found);
        let names: Vec<&str> = beside.effects.iter().map(|named| named.candidate.entry.name).collect();
        assert_eq!(names, ["dead_zone", "height_dependent_flow"]);
        assert!(beside.fit.model.effects.values("turbulence").is_none());
        // It explains more than the first of them alone, which explains no more than both.
        let mut alone = Selection::nothing(&search, &search.removed(&beside.fit, beside.effects[1].candidate.entry));
        alone.effects.push(beside.effects[0].clone());
        assert!(
            is_better(&without_random, &beside.fit, &alone.fit) && !is_better(&without_random, &alone.fit, &beside.fit)
        );
    }
}
