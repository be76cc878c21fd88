//! Optional parameters of an effect, such as the speed over which friction builds up: an effect that has some is fitted
//! with them and without, and the form that forecasts better is its candidate.

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::record::recording::Recording;
use crate::record::usual_speed::usual_speed;
use crate::select::candidates::Candidate;
use crate::select::nested::{enough_beyond_simpler, instead};
use crate::select::screening::{COST_OF_A_NUMBER, Screened};
use crate::select::search::Search;
use plant::{Entry, Scale};

/// Initial value of an optional speed, as a share of the usual speed of the record. Chosen, not fitted: a fit may move
/// it.
const SHARE_OF_SPEED: f64 = 0.1;

/// These values of the simple form of an effect, with initial values of its optional parameters; `None`: it has none,
/// or one that is no speed.
pub(crate) fn with_optional(entry: &Entry, simple: &[f64], recording: &Recording) -> Option<Vec<f64>> {
    let speed = SHARE_OF_SPEED * usual_speed(recording);
    let optional = &entry.params[entry.simple_count()..];
    let are_speeds = !optional.is_empty() && optional.iter().all(|param| param.scale == Scale::Speed);
    are_speeds.then(|| simple.iter().copied().chain(optional.iter().map(|_| speed)).collect())
}

/// The starts of the promising effects in the form that was not screened as the better one.
pub(crate) fn other_forms(search: &Search<'_>, promising: &[&Screened], so_far: &Fit) -> Vec<Screened> {
    promising.iter().filter_map(|one| other_form(search, one, so_far)).collect()
}

fn other_form(search: &Search<'_>, one: &Screened, so_far: &Fit) -> Option<Screened> {
    let entry = one.entry;
    let values = one.model.effects.values(entry.name)?;
    let other = if values.len() > entry.simple_count() {
        values[..entry.simple_count()].to_vec()
    } else {
        with_optional(entry, &values, search.problem.recording)?
    };
    let cost = one.cost + COST_OF_A_NUMBER * (other.len() as f64 - values.len() as f64);
    Some(Screened { cost, ..instead(one, so_far, entry, &other)? })
}

/// Whether an optional parameter ended within its bounds. One at a bound is another effect: friction over the slowest
/// transition is dry, and over the fastest a drag.
pub(crate) fn is_within_bounds(search: &Search<'_>, candidate: &Candidate) -> bool {
    let Candidate { entry, fit, .. } = candidate;
    let is_optional = |one: &&Parameter| one.index_in(entry.name).is_some_and(|index| index >= entry.simple_count());
    let mut optional = fit.parameters.iter().filter(is_optional);
    optional.all(|one| search.problem.bounds().active(*one, &fit.model).is_none())
}

/// Removes each form with optional parameters whose gain beyond the simple form is too small: the filter knows the
/// speed of the ball with an error, over which even dry friction builds up.
pub(crate) fn prefer_simple_forms(all: &mut Vec<Candidate>) {
    let of = |one: &Candidate| (one.entry.name, one.value_count(), one.held_out_gain);
    let forms: Vec<(&str, usize, f64)> = all.iter().map(of).collect();
    all.retain(|rich| {
        let enough = enough_beyond_simpler(rich);
        let is_as_good = |(name, count, gain): &(&str, usize, f64)| {
            *name == rich.entry.name && *count < rich.value_count() && rich.held_out_gain - gain < enough
        };
        !forms.iter().any(is_as_good)
    });
}

#[cfg(test)]
mod tests {
    use crate::select::tests_support::{ClosedLoop, STEP_S, seeking};
    use crate::tests_support::model;
    use crate::{Diagnosis, Recording, diagnose};
    use plant::effects::{DeadZone, Hysteresis, QuadraticDrag, WallFriction};
    use plant::{Effect, Effects, Model, Noise};

    /// A ball in a pipe, ẍ = 150·(u − 40) − 1.2·ẋ mm/s² before friction, in closed loop; 0.25 mm of noise. `slowed`:
    /// the velocity after a step from the one without friction.
    fn flown(slowed: impl Fn(f64) -> f64) -> Recording {
        let closed_loop = ClosedLoop {
            seed: 7,
            middle_mm: 300.0,
            range_mm: 250.0,
            noise_draws: 12,
            noise_mm: 0.25,
            hover_percent: 40.0,
            proportional: 0.015,
            derivative: 0.018,
        };
        closed_loop.record(|[x, v], duty_percent| {
            let v = slowed(v + STEP_S * (150.0 * (duty_percent - 40.0) - 1.2 * v));
            [x + STEP_S * v, v]
        })
    }

    /// The diagnosis from a belief without friction.
    fn found(recording: &Recording) -> Diagnosis {
        let belief = Model {
            gain_mm_per_s2_per_percent: 150.0,
            drag_per_s: 1.2,
            hover_duty_percent: 40.0,
            pipe_length_mm: 600.0,
            noise: Noise { sensor_mm: 0.25, acceleration_psd_mm2_per_s3: 1.0 },
            effects: Effects::default(),
            ..model()
        };
        let sought =
            [WallFriction::ENTRY.name, DeadZone::ENTRY.name, Hysteresis::ENTRY.name, QuadraticDrag::ENTRY.name];
        diagnose(&belief, std::slice::from_ref(recording), &seeking(&sought))
    }

    #[test]
    fn friction_over_a_transition_is_found_with_it_and_dry_friction_without_one() {
        let creeping = found(&flown(|v| v - STEP_S * 50.0 * (v / 6.0).tanh()));
        let values = creeping.mended.model.effects.values(WallFriction::ENTRY.name).unwrap();
        let near = |value: f64, truth: f64, share: f64| (value / truth - 1.0).abs() < share;
        assert!(near(values[0], 50.0, 0.1) && near(values[1], 6.0, 0.2), "{values:?}");
        assert_eq!(creeping.effects.len(), 1, "{}", creeping.verdict_in_words());
        let sticking = found(&flown(|v: f64| v.signum() * (v.abs() - STEP_S * 50.0).max(0.0)));
        let values = sticking.mended.model.effects.values(WallFriction::ENTRY.name).unwrap();
        assert!(values.len() == 1 && near(values[0], 50.0, 0.1), "{values:?}");
    }
}
