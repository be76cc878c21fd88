//! Optional parameters of an effect, such as the speed over which friction builds up: an effect that has some is fitted
//! with them and without, and the form that forecasts better is its candidate.

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::record::recording::Recording;
use crate::record::usual_speed::usual_speed;
use crate::select::candidates::Candidate;
use crate::select::screening::{COST_OF_A_NUMBER, Screened, added};
use crate::select::search::Search;
use crate::thresholds::{SECOND_EFFECT, SHARE_OF_EXPLAINED};

/// Initial transition of friction, as a share of the usual speed. Chosen, not fitted: a fit may move it.
const SHARE_OF_SPEED: f64 = 0.1;

/// The values of an effect in its simple form with initial values of the optional parameters.
pub(crate) fn with_optional(simple: &[f64], recording: &Recording) -> Vec<f64> {
    simple.iter().copied().chain([SHARE_OF_SPEED * usual_speed(recording)]).collect()
}

/// The starts of the promising effects in the form that was not screened as the better one.
pub(crate) fn other_forms(search: &Search<'_>, promising: &[&Screened], so_far: &Fit) -> Vec<Screened> {
    promising.iter().filter_map(|one| other_form(search, one, so_far)).collect()
}

fn other_form(search: &Search<'_>, one: &Screened, so_far: &Fit) -> Option<Screened> {
    let entry = one.entry;
    let values = one.model.effects.values(entry.name).filter(|_| entry.optional > 0)?;
    let simple = entry.params.len() - entry.optional;
    let other = if values.len() > simple {
        values[..simple].to_vec()
    } else {
        with_optional(&values, search.problem.recording)
    };
    let mut base = one.model.clone();
    base.effects.remove(entry.name);
    let (model, parameters) = added(&base, &so_far.parameters, entry, &other)?;
    let cost = one.cost + COST_OF_A_NUMBER * (other.len() as f64 - values.len() as f64);
    Some(Screened { model, parameters, cost, rivals: Vec::new(), ..one.clone() })
}

/// Whether an optional parameter ended within its bounds. One at a bound is another effect: friction over the slowest
/// transition is dry, and over the fastest a drag.
pub(crate) fn is_within_bounds(search: &Search<'_>, candidate: &Candidate) -> bool {
    let (entry, model) = (candidate.entry, &candidate.fit.model);
    let simple = entry.params.len() - entry.optional;
    let is_optional = |one: &&Parameter| one.index_in(entry.name).is_some_and(|index| index >= simple);
    let mut optional = candidate.fit.parameters.iter().filter(is_optional);
    entry.optional == 0 || optional.all(|one| search.problem.bounds().active(*one, model).is_none())
}

/// Removes each form with optional parameters whose gain beyond the simple form is too small: the filter knows the
/// speed of the ball with an error, over which even dry friction builds up.
pub(crate) fn prefer_simple_forms(all: &mut Vec<Candidate>) {
    let is_needless = |rich: &Candidate| {
        let enough = SECOND_EFFECT.max(SHARE_OF_EXPLAINED * rich.held_out_gain);
        let is_simple =
            |other: &&Candidate| other.entry.name == rich.entry.name && other.value_count() < rich.value_count();
        all.iter().find(is_simple).is_some_and(|simple| rich.held_out_gain - simple.held_out_gain < enough)
    };
    let needless: Vec<bool> = all.iter().map(is_needless).collect();
    let mut needless = needless.into_iter();
    all.retain(|_| !needless.next().unwrap_or_default());
}

#[cfg(test)]
mod tests {
    use crate::options::Options;
    use crate::random_for_tests::uniform;
    use crate::tests_support::model;
    use crate::{Diagnosis, Recording, Sample, diagnose};
    use plant::{Effects, Model, Noise};

    const STEP_S: f64 = 1e-3;

    /// A ball in a pipe, ẍ = 150·(u − 40) − 1.2·ẋ mm/s² before friction, held by a PD controller with a random
    /// setpoint; 0.25 mm of noise. Its own simulator. `rub`: the velocity after a step from the one without friction.
    fn flown(rub: impl Fn(f64) -> f64) -> Recording {
        let (mut x, mut v, mut setpoint, mut last, mut slope) = (300.0, 0.0, 300.0, 300.0, 0.0);
        let mut uniform = uniform(7);
        let rows = (0..3000_u32).map(|k| {
            if k % 150 == 0 {
                setpoint = 300.0 + 250.0 * uniform();
            }
            let reading = x + 0.25 * (0..12).map(|_| uniform()).sum::<f64>();
            slope += 0.3 * ((reading - last) / 0.02 - slope);
            last = reading;
            let duty_percent: f64 = 40.0 + 0.015 * (setpoint - reading) - 0.018 * slope;
            for _ in 0..20 {
                v = rub(v + STEP_S * (150.0 * (duty_percent - 40.0) - 1.2 * v));
                x += STEP_S * v;
            }
            Sample { time_s: 0.02 * f64::from(k), duty_percent, position_mm: Some(reading), ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    /// The diagnosis from a belief without friction; few effects are sought, because that is quicker.
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
        let sought = ["wall_friction", "dead_zone", "hysteresis", "quadratic_drag"];
        let others = Effects::CATALOGUE.iter().map(|entry| entry.name).filter(|name| !sought.contains(name));
        let without = others.map(str::to_owned).collect();
        diagnose(
            &belief,
            std::slice::from_ref(recording),
            &Options { without, without_formula: true, ..Options::default() },
        )
    }

    #[test]
    fn friction_over_a_transition_is_found_with_it_and_dry_friction_without_one() {
        let creeping = found(&flown(|v| v - STEP_S * 50.0 * (v / 6.0).tanh()));
        let values = creeping.mended.model.effects.values("wall_friction").unwrap();
        let near = |value: f64, truth: f64, share: f64| (value / truth - 1.0).abs() < share;
        assert!(near(values[0], 50.0, 0.1) && near(values[1], 6.0, 0.2), "{values:?}");
        assert_eq!(creeping.effects.len(), 1, "{}", creeping.verdict_in_words());
        let sticking = found(&flown(|v: f64| v.signum() * (v.abs() - STEP_S * 50.0).max(0.0)));
        let values = sticking.mended.model.effects.values("wall_friction").unwrap();
        assert!(values.len() == 1 && near(values[0], 50.0, 0.1), "{values:?}");
    }
}
