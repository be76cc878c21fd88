//! Stepwise selection of effects: forward selection while the gain is large enough, with backward elimination of
//! effects that a later one makes unnecessary.

use crate::fit::estimate::Fit;
use crate::residual::misfit::Misfit;
use crate::select::addition::best_addition;
use crate::select::believed::{BelievedChange, changed};
use crate::select::candidates::Candidate;
use crate::select::elimination::{backward_eliminate, eliminate_by_forecasts};
use crate::select::exchange::exchange;
use crate::select::forecast::loses_track;
use crate::select::odds::Evidence;
use crate::select::posterior::Scored;
use crate::select::random_force::{is_random_force, search_from};
use crate::select::ranking::rank;
use crate::select::refit::with_other_sizes;
use crate::select::search::Search;
use crate::select::smoothing::unconfirmed;
use crate::select::twins::compare_twins;
use crate::select::vuong::add_rivals_amid_misfit;
use crate::thresholds::{
    BESIDE_COARSE_READINGS, FIRST_EFFECT, FURTHER_EFFECT, LONG, MOST_EFFECTS, MOST_SEARCHES, SECOND_EFFECT,
    SHARE_OF_EXPLAINED, SHARE_OF_OMITTED,
};
use plant::{Changes, Entry, Model, Start};

/// The change of an effect between the belief and the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// It was not believed.
    Added,
    /// It was believed, but its values are wrong by more than a factor of 1.5.
    Retuned,
    /// It was believed, but the rig does not have it.
    Removed,
}

/// An effect that was found.
#[derive(Clone, Debug)]
pub struct NamedEffect {
    /// The change.
    pub change: Change,
    /// The effect and its fit when it was found.
    pub candidate: Candidate,
    /// The probability that this effect, or one that is indistinguishable from it, acts; 0 until the whole answer is
    /// known.
    pub probability: f64,
    /// The evidence that the probability is computed from.
    pub evidence: Evidence,
    /// The effects that are indistinguishable from it.
    pub indistinguishable_from: Vec<&'static str>,
    /// The models with each of those instead of it, in the same order.
    pub rivals: Vec<Model>,
}

/// The effects that explain a record: those to add, the most important first, then the changes of believed effects.
pub(crate) struct Selection {
    pub(crate) effects: Vec<NamedEffect>,
    pub(crate) rounds: Vec<Vec<Scored>>,
    pub(crate) fit: Fit,
    pub(crate) misfit: Misfit,
    /// The intermediate fits.
    on_the_way: Vec<Fit>,
}

impl Selection {
    /// Whether the residual is significant.
    pub(crate) fn is_incomplete(&self) -> bool {
        self.misfit.is_significant()
    }

    /// The added effects.
    pub(crate) fn added(&self) -> Vec<&'static Entry> {
        let added = self.effects.iter().filter(|named| named.change == Change::Added);
        added.map(|named| named.candidate.entry).collect()
    }

    /// Removes effects, and fits the others again.
    pub(crate) fn remove(&mut self, search: &Search<'_>, entries: &[&'static Entry]) {
        self.fit = search.without_effects(&self.fit, entries);
        self.effects.retain(|named| !entries.iter().any(|entry| entry.name == named.candidate.entry.name));
    }

    /// A selection without effects.
    pub(crate) fn nothing(search: &Search<'_>, refitted: &Fit) -> Self {
        let misfit = Misfit::of(&search.problem, refitted, None);
        Self { effects: Vec::new(), rounds: Vec::new(), fit: refitted.clone(), misfit, on_the_way: Vec::new() }
    }
}

/// Adds effects until none explains more. Effects that smooth the readings and are not confirmed beside a coloured
/// random force are then left out of a second search: they followed something else that is missing.
pub(crate) fn select_effects(search: &Search<'_>, refitted: &Fit) -> Selection {
    let mut found = search_from(search, refitted);
    let unconfirmed = unconfirmed(search, &found);
    if !unconfirmed.is_empty() {
        found = search_from(&search.without(|entry| unconfirmed.contains(&entry.name)), refitted);
    }
    compare_twins(search, &mut found.effects, &mut found.fit);
    if found.is_incomplete() {
        add_rivals_amid_misfit(search, &mut found);
    }
    rank(search, &mut found.effects, &found.fit, &found.on_the_way);
    add_changes(search, &mut found);
    found
}

/// Adds further effects to those of a fit by forecasts, until none explains more; then removes those that are not
/// needed. `misfit`: the residual tests of the search by likelihood, since they ask for white innovations. The search
/// by forecasts is made where something is missing: so Vuong's test compares the rivals.
pub(crate) fn select_further(search: &Search<'_>, fit: Fit, effects: Vec<NamedEffect>, misfit: &Misfit) -> Selection {
    let misfit = Some(misfit.clone());
    let start = SoFar { effects, misfit, ..SoFar::nothing(&fit) };
    let mut found = stepwise_search(search, start).0;
    eliminate_by_forecasts(search, &mut found.effects, &mut found.fit);
    compare_twins(search, &mut found.effects, &mut found.fit);
    add_rivals_amid_misfit(search, &mut found);
    rank(search, &mut found.effects, &found.fit, &found.on_the_way);
    add_changes(search, &mut found);
    found
}

/// Whether an effect changes the path of the ball or the mean of its readings. A random force changes their variance.
pub(crate) fn is_of_path(entry: &Entry) -> bool {
    entry.acts.changes == Changes::Path
}

/// A stepwise search between two rounds.
#[derive(Clone)]
pub(super) struct SoFar {
    fit: Fit,
    effects: Vec<NamedEffect>,
    rounds: Vec<Vec<Scored>>,
    on_the_way: Vec<Fit>,
    /// The misfit before the last effect, where an omitted term gained more than that effect.
    beaten: Option<Misfit>,
    /// The residual tests that hold, where they are known before the search ends.
    misfit: Option<Misfit>,
}

impl SoFar {
    /// Before the first round.
    pub(super) fn nothing(refitted: &Fit) -> Self {
        let (effects, rounds, on_the_way) = (Vec::new(), Vec::new(), Vec::new());
        Self { fit: refitted.clone(), effects, rounds, on_the_way, beaten: None, misfit: None }
    }

    /// What was found, with these effects and this fit in its place.
    pub(super) fn after(found: &Selection, effects: Vec<NamedEffect>, fit: Fit) -> Self {
        let (rounds, on_the_way) = (found.rounds.clone(), found.on_the_way.clone());
        Self { fit, effects, rounds, on_the_way, beaten: None, misfit: None }
    }
}

/// The effects found from `start` on, and where the last random force was added.
pub(super) fn stepwise_search(search: &Search<'_>, start: SoFar) -> (Selection, Option<SoFar>) {
    let (mut so_far, mut before_random_force) = (start, None);
    // On a long record even a small misfit gains more than chance does, because no model is exact.
    let readings = search.problem.recording.readings() as f64 * search.problem.folds.weight();
    let long = (readings / LONG).max(1.0).sqrt();
    let mut rejected: Vec<&str> = Vec::new();
    while so_far.effects.len() < MOST_EFFECTS && so_far.rounds.len() < MOST_SEARCHES {
        let needed = long * threshold_beside(search, &so_far.effects);
        let (named, scored) =
            best_addition(&search.without(|entry| rejected.contains(&entry.name)), &so_far.fit, needed);
        if named.as_ref().is_some_and(|named| is_random_force(named.candidate.entry)) {
            before_random_force = Some(so_far.clone());
        }
        let SoFar { fit, effects, rounds, on_the_way, beaten, misfit } = &mut so_far;
        rounds.push(scored);
        let Some(named) = named else { break };
        if loses_track(search, &named.candidate, fit) {
            rejected.push(named.candidate.entry.name);
            continue;
        }
        // Beside another effect it may not.
        rejected.clear();
        // The residual tests ask for white innovations, which a search by forecasts has not.
        if !search.is_by_forecasts() {
            let left = Misfit::of(&search.problem, fit, explained(effects));
            if !effects.is_empty() && named.candidate.held_out_gain < SHARE_OF_OMITTED * left.omitted_in_full() {
                *misfit = Some(left);
                break;
            }
            *beaten = left.beaten_by_omitted(named.candidate.entry.name, named.candidate.held_out_gain);
        }
        on_the_way.push(std::mem::replace(fit, named.candidate.fit.clone()));
        if !is_of_path(named.candidate.entry) {
            *fit = with_other_sizes(search, fit.clone());
        }
        effects.push(named);
        if effects.len() == 2 {
            exchange(search, effects, fit, rounds, 0);
        }
        if !search.is_by_forecasts() {
            backward_eliminate(search, effects, fit);
        }
    }
    let SoFar { mut fit, mut effects, rounds, on_the_way, beaten, misfit } = so_far;
    // With two effects, the first was searched for again already.
    let earlier = if effects.len() > 2 { effects.len() - 1 } else { 0 };
    for at in 0..earlier {
        exchange(search, &mut effects, &mut fit, &rounds, at);
    }
    let last = effects.last().map(|named| named.candidate.entry.name);
    let beaten = beaten.filter(|left| last == left.rejected_effect);
    let misfit = misfit.or(beaten).unwrap_or_else(|| Misfit::of(&search.problem, &fit, explained(&effects)));
    (Selection { effects, rounds, fit, misfit, on_the_way }, before_random_force)
}

/// Adds the changes of the believed effects.
fn add_changes(search: &Search<'_>, found: &mut Selection) {
    for BelievedChange { change, candidate, without, rivals } in changed(search, &found.fit) {
        if let Some(without) = without {
            found.fit = without;
        }
        found.effects.push(NamedEffect {
            change,
            candidate,
            probability: 0.0,
            evidence: Evidence::default(),
            indistinguishable_from: rivals.iter().map(|rival| rival.entry.name).collect(),
            rivals: rivals.into_iter().map(|rival| rival.fit.model).collect(),
        });
    }
}

/// Nats that these effects explain; `None` without effects. Effects on the density of a reading do not count: they gain
/// thousands of nats, but their form is exact.
fn explained(effects: &[NamedEffect]) -> Option<f64> {
    let of_form = effects.iter().filter(|named| named.candidate.entry.acts.changes != Changes::Density);
    (!effects.is_empty()).then(|| of_form.map(|named| named.candidate.held_out_gain).sum())
}

/// Penalised gain that a further effect needs.
fn threshold_beside(search: &Search<'_>, effects: &[NamedEffect]) -> f64 {
    if search.is_by_forecasts() && !effects.is_empty() {
        // The weight of a reading follows from what the form of the others leaves.
        return SECOND_EFFECT;
    }
    let form = SHARE_OF_EXPLAINED * explained(effects).unwrap_or(0.0);
    let is_coarse = |named: &NamedEffect| named.candidate.entry.start == Start::ReadingStep;
    match effects {
        [] => FIRST_EFFECT,
        _ if effects.iter().any(is_coarse) => BESIDE_COARSE_READINGS.max(form),
        [_] => SECOND_EFFECT.max(form),
        _ => FURTHER_EFFECT.max(form),
    }
}
