//! The full fit of a candidate.
//!
//! A sensor that smooths the readings also smooths what a random force does to them. An effect that gains by that gains
//! little beside a coloured random force, see [`mod@crate::select::coloured_force`].

use crate::fit::derivatives::KnownSensitivities;
use crate::fit::estimate::Fit;
use crate::fit::held_out::LogLikByFold;
use crate::select::candidates::Candidate;
use crate::select::coloured_force::beside_coloured_force;
use crate::select::plausibility::cost_of_form;
use crate::select::screening::{Screened, first, screen};
use crate::select::search::Search;
use crate::thresholds::{COST_OF_A_PARAMETER, RANDOM_FORCE_YIELDS, SCREENED, UNMOVED};

/// Screens again, beside a coloured random force, the effects that smooth the readings, and gives that base. `None`: none
/// of them explains anything, or the force does not.
pub(crate) fn screen_beside_coloured_force(
    search: &Search<'_>,
    so_far: &Fit,
    screened: &mut [Screened],
) -> Option<Base> {
    let explains = |one: &&mut Screened| one.entry.acts.smooths_readings() && one.gain > SCREENED;
    let mut smoothing = screened.iter_mut().filter(explains).peekable();
    smoothing.peek()?;
    let base = Base::of(search, beside_coloured_force(search, so_far)?);
    for one in smoothing {
        if let Some(again) = screen(search, &base.fit, &base.known, one.entry) {
            *one = again;
        }
    }
    Some(base)
}

/// What effects are added to.
pub(crate) struct Base {
    pub(crate) fit: Fit,
    /// Its held-out log-likelihood.
    before: LogLikByFold,
    /// Its derivatives by the parameters that the screening fits.
    pub(crate) known: KnownSensitivities,
}

impl Base {
    pub(crate) fn of(search: &Search<'_>, fit: Fit) -> Self {
        let before = search.problem.held_out(&fit);
        let known = search.problem.sensitivities_of(&fit, &first(search));
        Self { fit, before, known }
    }
}

/// A candidate. Where an effect that was screened beside a coloured random force gains less than [`RANDOM_FORCE_YIELDS`] of
/// its gain there, it stood for that force, and the lower gain counts.
pub(crate) fn full_fit(search: &Search<'_>, screened: &Screened, base: &Base, own: &Base) -> Candidate {
    let beside = full_fit_on(search, screened, own);
    if std::ptr::eq(base, own) {
        return beside;
    }
    let alone = full_fit_on(search, &screened.without_coloured_force(&base.fit), base);
    if beside.held_out_gain >= RANDOM_FORCE_YIELDS * alone.held_out_gain {
        return alone;
    }
    let penalised_gain = alone.penalised_gain.min(beside.penalised_gain);
    Candidate { held_out_gain: beside.held_out_gain, penalised_gain, ..alone }
}

fn full_fit_on(search: &Search<'_>, screened: &Screened, base: &Base) -> Candidate {
    let Base { fit: so_far, before, .. } = base;
    let fit = search.problem.fit(&screened.model, &screened.parameters);
    let (without_each_fold, mut after) = search.problem.cross_validated(&fit);
    for (fold, after) in after.iter_mut().enumerate() {
        if let Some(other) = screened.chosen_without(fold) {
            *after = after.min(other);
        }
    }
    let held_out = after.iter().sum::<f64>() - before.iter().sum::<f64>();
    let cost = screened.cost + cost_of_form(search, screened.entry);
    let held_out_gain = held_out + fit.log_prior - so_far.log_prior - cost;
    let added = fit.parameters.len().saturating_sub(so_far.parameters.len());
    let fitted = search.problem.total_of(&fit) - search.problem.total_of(so_far) - cost;
    let unmoved = (search.base_prior(&fit) - search.base_prior(so_far) - UNMOVED).max(0.0);
    let penalised_gain = held_out_gain.min(fitted - COST_OF_A_PARAMETER * added as f64) - unmoved;
    Candidate { entry: screened.entry, fit, without_each_fold, held_out_gain, penalised_gain }
}

#[cfg(test)]
mod tests {
    use super::{Base, full_fit, screen_beside_coloured_force};
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::select::refit::refitted;
    use crate::select::screening::screen;
    use crate::select::search::Search;
    use crate::tests_support::{model, record};
    use plant::effects::Turbulence;
    use plant::{Effects, Model};

    /// The held-out gain of a lag of the sensor on a rig with turbulence and no lag: beside white noise and beside a
    /// coloured force.
    #[test]
    fn a_lag_of_the_sensor_gains_nothing_by_smoothing_turbulence() {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = belief.clone();
        rig.noise.sensor_mm = 0.3;
        rig.effects.turbulence = Some(Turbulence { sigma_mm_per_s2: 120.0, correlation_s: 0.3 });
        let recording = record(&rig, 3, 60);
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let base = Base::of(&search, refitted(&search));
        let lag = Effects::built_in("sensor_lag").unwrap();
        let mut screened = vec![screen(&search, &base.fit, &base.known, lag).unwrap()];
        let alone = full_fit(&search, &screened[0], &base, &base);
        assert!(alone.held_out_gain > 30.0, "{}", alone.held_out_gain);
        let beside = screen_beside_coloured_force(&search, &base.fit, &mut screened).unwrap();
        let gain = full_fit(&search, &screened[0], &base, &beside).held_out_gain;
        assert!(gain < 3.0, "{gain}");
    }
}
