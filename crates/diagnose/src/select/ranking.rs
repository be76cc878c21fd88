//! The order of the named effects: first the one whose absence raises the forecast errors most.
//!
//! ```text
//! a before b:  E²(1 s) without a > 2·E²(1 s) without b        E: see `gap`; else as found, a random force last
//! ```
//!
//! Without an effect that changes the readings alone, and not the path, the simulator forecasts the same path: its
//! E²(1 s) is that with all effects.
//!
//! Stepwise selection finds first what shows best one step ahead: on a rig with low noise these are fast and small
//! effects. But a simulator is corrected first where its forecasts err most.

use crate::fit::estimate::Fit;
use crate::select::forecast::error_at_1_s;
use crate::select::random_force::is_random_force;
use crate::select::search::Search;
use crate::select::stepwise::{Change, NamedEffect, is_of_path};
use crate::thresholds::LARGER;
use plant::{Entry, Model};
use rayon::prelude::*;

/// Orders the effects that were added to `fit`; the changes of believed effects come after them. `on_the_way`:
/// intermediate fits of the same search, one of which may be the best without an effect.
pub(crate) fn rank(search: &Search<'_>, effects: &mut [NamedEffect], fit: &Fit, on_the_way: &[Fit]) {
    let stays = |named: &NamedEffect| named.change != Change::Added || is_random_force(named.candidate.entry);
    let moves = effects.iter().position(stays).unwrap_or(effects.len());
    let added = &mut effects[..moves];
    if added.len() < 2 {
        return;
    }
    let without = |named: &NamedEffect| {
        let entry = named.candidate.entry;
        let model = if is_of_path(entry) { &best_without(search, entry, fit, on_the_way) } else { &fit.model };
        square_at_1_s(search, model)
    };
    let without: Vec<f64> = added.par_iter().map(without).collect();
    let mut order: Vec<usize> = Vec::with_capacity(added.len());
    for (at, square) in without.iter().enumerate() {
        let behind = order.iter().rposition(|before| *square <= LARGER * without[*before]);
        order.insert(behind.map_or(0, |behind| behind + 1), at);
    }
    let in_order: Vec<NamedEffect> = order.iter().map(|at| added[*at].clone()).collect();
    added.clone_from_slice(&in_order);
}

/// The most likely model without an effect and with no effects that `fit` lacks.
fn best_without(search: &Search<'_>, effect: &Entry, fit: &Fit, on_the_way: &[Fit]) -> Model {
    let removed = search.removed(fit, effect);
    let has = |fit: &Fit, name: &str| fit.model.effects.values(name).is_some();
    let is_part = |other: &&Fit| {
        other.model.effects.present().iter().all(|entry| entry.name != effect.name && has(fit, entry.name))
    };
    let others = on_the_way.iter().filter(is_part);
    let best = others.fold(&removed, |best, other| {
        if search.problem.total_of(other) > search.problem.total_of(best) { other } else { best }
    });
    best.model.clone()
}

/// Mean square of the forecast errors 1 s ahead, mm²; 0 if the record is too short, so that all are equal.
fn square_at_1_s(search: &Search<'_>, model: &Model) -> f64 {
    error_at_1_s(search, model).map_or(0.0, |error_mm| error_mm.powi(2))
}

#[cfg(test)]
mod tests {
    use super::rank;
    use crate::fit::parameter::{BASE, Parameter, parameters_of_effect};
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::candidates::Candidate;
    use crate::select::search::Search;
    use crate::select::stepwise::{Change, NamedEffect};
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    /// The order of these effects on a record of a rig with a strong gradient and weak others.
    fn order(found: [&'static str; 3], seconds: u32) -> [&'static str; 3] {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = belief.clone();
        for (name, values) in [
            ("quadratic_drag", &[1e-5][..]),
            ("wall_friction", &[0.01]),
            ("turbulence", &[0.1, 0.5]),
            ("height_dependent_flow", &[12.0]),
            ("sensor_noise", &[3.0]),
        ] {
            if found.contains(&name) {
                rig.effects.set(name, values);
            }
        }
        let recording = record(&rig, 2, seconds);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let of_effect =
            |name| parameters_of_effect(Effects::built_in(name).unwrap(), &rig.effects.values(name).unwrap());
        let parameters: Vec<Parameter> = BASE.into_iter().chain(found.into_iter().flat_map(of_effect)).collect();
        let fit = search.problem.fit(&rig, &parameters);
        let named = |name| NamedEffect {
            change: Change::Added,
            candidate: Candidate {
                entry: Effects::built_in(name).unwrap(),
                fit: fit.clone(),
                without_each_fold: Vec::new(),
                held_out_gain: 0.0,
                penalised_gain: 0.0,
            },
            probability: 1.0,
            evidence: crate::select::odds::Evidence::default(),
            indistinguishable_from: Vec::new(),
            rivals: Vec::new(),
        };
        let mut effects = found.map(named);
        rank(&search, &mut effects, &fit, &[]);
        effects.map(|named| named.candidate.entry.name)
    }

    #[test]
    fn what_leads_the_forecasts_astray_comes_before_what_hardly_does_and_alike_stay_as_they_were_found() {
        let order = order(["quadratic_drag", "wall_friction", "height_dependent_flow"], 60);
        assert_eq!(order, ["height_dependent_flow", "quadratic_drag", "wall_friction"]);
    }

    #[test]
    fn what_changes_the_path_comes_before_what_changes_the_readings_alone() {
        let order = order(["sensor_noise", "quadratic_drag", "height_dependent_flow"], 60);
        assert_eq!(order, ["height_dependent_flow", "sensor_noise", "quadratic_drag"]);
    }

    #[test]
    fn nothing_is_put_before_turbulence_nor_in_order_where_a_record_is_too_short_to_say() {
        let found = ["quadratic_drag", "turbulence", "height_dependent_flow"];
        assert_eq!(order(found, 60), found);
        let found = ["quadratic_drag", "wall_friction", "height_dependent_flow"];
        assert_eq!(order(found, 1), found);
    }
}
