//! Effects that smooth the readings, such as a lag of the sensor, are confirmed beside a coloured random force.
//!
//! A model with a white random force prefers such an effect wherever it lacks something else: what is missing is
//! correlated in time, as a coloured force is, and a smoothed white force resembles that. Beside a coloured force
//! ([`mod@crate::select::coloured_force`]) there is no such preference.

use crate::fit::estimate::Fit;
use crate::select::coloured_force::held_out_beside_coloured_force;
use crate::select::search::Search;
use crate::select::stepwise::Selection;
use crate::select::twins::{in_place_of, twins};
use crate::thresholds::{INDISTINGUISHABLE_TWINS, SECOND_EFFECT};
use plant::Entry;

/// The added effects that smooth the readings and that only a white random force prefers: beside a coloured one they
/// gain too little for a name, or are no longer better than a twin.
pub(crate) fn unconfirmed(search: &Search<'_>, found: &Selection) -> Vec<&'static str> {
    let smoothing = found.added().into_iter().filter(|entry| entry.acts.smooths_readings());
    smoothing.filter(|entry| !is_confirmed(search, entry, &found.fit)).map(|entry| entry.name).collect()
}

fn is_confirmed(search: &Search<'_>, entry: &Entry, fit: &Fit) -> bool {
    let beside = held_out_beside_coloured_force(search, fit);
    let without = held_out_beside_coloured_force(search, &search.removed(fit, entry));
    if beside - without < SECOND_EFFECT {
        return false;
    }
    let alone = search.held_out_total(fit);
    twins(search, entry).filter_map(|twin| in_place_of(search, entry, twin, fit)).all(|other| {
        let is_better_alone = alone - search.held_out_total(&other) > INDISTINGUISHABLE_TWINS;
        let is_better = || beside - held_out_beside_coloured_force(search, &other) > INDISTINGUISHABLE_TWINS;
        !is_better_alone || is_better()
    })
}

#[cfg(test)]
mod tests {
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::random_force::is_random_force;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::select::stepwise::select_effects;
    use crate::tests_support::{model, record};
    use plant::effects::{SensorLag, Turbulence};
    use plant::{Effects, Model};

    /// The lags that a search without random forces adds on a rig with these effects.
    fn lags(effects: Effects) -> Vec<&'static str> {
        let mut rig = Model { effects, ..model() };
        rig.noise.sensor_mm = 0.3;
        let belief = Model { effects: Effects::default(), ..model() };
        let recording = record(&rig, 5, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default()).without(is_random_force);
        let found = select_effects(&search, &refitted(&search));
        found.added().into_iter().map(|entry| entry.name).filter(|name| name.ends_with("_lag")).collect()
    }

    #[test]
    fn a_lag_of_the_sensor_that_only_smooths_turbulence_is_left_out() {
        let turbulence = Some(Turbulence { sigma_mm_per_s2: 120.0, correlation_s: 0.3 });
        assert!(!lags(Effects { turbulence, ..Effects::default() }).contains(&"sensor_lag"));
    }

    #[test]
    fn a_lag_of_the_sensor_in_still_air_is_confirmed() {
        let sensor_lag = Some(SensorLag { time_constant_s: 0.1 });
        assert_eq!(lags(Effects { sensor_lag, ..Effects::default() }), ["sensor_lag"]);
    }
}
