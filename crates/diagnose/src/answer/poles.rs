//! The order of the two poles of a belief with a lag.
//!
//! ```text
//! K/(s(s + a)(τs + 1)) = K'/(s(s + a')(τ's + 1))      a' = 1/τ, τ' = 1/a, K' = K/(aτ)
//! ```
//!
//! The response to the input is the same. Which pole is the lag shows in the noise alone, which enters behind it; and
//! what the model lacks distorts that: beside a missing delay the likelihood prefers the slow lag, and with that the
//! delay gains nothing. So a belief that was fitted to a record is taken in the order that is likelier with the first
//! effect that is found beside it. A force over the position, as of a spring or of gravity, leaves no such pair.

use crate::answer::diagnosis::{Diagnosis, likelihood_with_first_effect};
use crate::options::Options;
use crate::record::check::Finding;
use crate::record::prepare::FlightFinding;
use crate::record::recording::Recording;
use crate::thresholds::FIRST_EFFECT;
use plant::Model;

/// The model of the same response with drag and lag exchanged; `None` without a lag, or with a force over the position.
pub(super) fn in_other_order(model: &Model) -> Option<Model> {
    if model.linear().gradient_per_s2 != 0.0 {
        return None;
    }
    let lag_s = model.effects.fan_lag_s().filter(|lag_s| *lag_s > 0.0)?;
    let gain_mm_per_s2_per_percent = model.gain_mm_per_s2_per_percent / (model.drag_per_s * lag_s);
    let effects = model.effects.with_fan_lag(Some(1.0 / model.drag_per_s));
    let other = Model { drag_per_s: 1.0 / lag_s, gain_mm_per_s2_per_percent, effects, ..model.clone() };
    other.check().is_ok().then_some(other)
}

/// Whether the `other` belief is likelier than the first, each with the first effect that is found beside it, by the
/// evidence that an effect needs.
pub(super) fn is_likelier(other: &Model, first: &Model, logs: &[Recording], options: &Options) -> bool {
    let likelihood = |belief: &Model| likelihood_with_first_effect(belief, logs, options);
    likelihood(first).zip(likelihood(other)).is_some_and(|(first, other)| other > first + FIRST_EFFECT)
}

/// A diagnosis of the belief in the `other` order, with the finding that the order is another one.
pub(super) fn of_other_order(mut found: Diagnosis, other: &Model) -> Diagnosis {
    let (gain, drag_per_s) = (other.gain_mm_per_s2_per_percent, other.drag_per_s);
    let lag_s = other.effects.fan_lag_s().unwrap_or_default();
    found.findings.push(FlightFinding { flight: 0, finding: Finding::OtherOrder { gain, drag_per_s, lag_s } });
    found
}

#[cfg(test)]
mod tests {
    use super::in_other_order;
    use crate::identify::initial;
    use crate::options::Options;
    use crate::random_for_tests::uniform;
    use crate::select::tests_support::seeking;
    use crate::tests_support::model;
    use crate::{Recording, Sample, diagnose};
    use plant::effects::HeightDependentFlow;

    #[test]
    fn both_orders_have_the_same_response_and_the_other_of_the_other_is_the_first() {
        let belief = model();
        let lag_s = belief.effects.fan_lag_s().unwrap();
        let other = in_other_order(&belief).unwrap();
        let [first, second] = [&belief, &other].map(|model| {
            // |K/((jω + a)(τjω + 1))|² at ω = 3 rad/s, and K/a.
            let (a, gain) = (model.drag_per_s, model.gain_mm_per_s2_per_percent);
            let lag = 3.0 * model.effects.fan_lag_s().unwrap();
            [gain * gain / ((9.0 + a * a) * (1.0 + lag * lag)), gain / a]
        });
        assert!(first.iter().zip(second).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{first:?} {second:?}");
        let back = in_other_order(&other).unwrap();
        assert!((back.effects.fan_lag_s().unwrap() / lag_s - 1.0).abs() < 1e-9);
        let without = plant::Model { effects: belief.effects.with_fan_lag(None), ..belief.clone() };
        assert!(in_other_order(&without).is_none());
        // With a spring the exchange gives another response.
        let mut hanging = belief.clone();
        assert!(in_other_order(&hanging).is_some());
        hanging.effects.height_dependent_flow =
            Some(HeightDependentFlow { gradient_per_s2: 11.5, centre_mm: None, turn_mm: None });
        assert!(in_other_order(&hanging).is_none());
    }

    /// A ball in a pipe, ẍ = 150·(u(t − 0.12 s) − 40) − 1.2·ẋ mm/s², held by a PD controller with a random setpoint
    /// and a square wave beside it; 0.25 mm of noise and 6 mm²/s³ of gusts. Its own simulator, with twenty steps a row.
    fn pipe_with_delay() -> Recording {
        let (mut x, mut v, mut setpoint, mut last, mut slope) = (450.0, 0.0, 450.0, 450.0, 0.0);
        let mut uniform = uniform(4);
        let mut inputs = vec![40.0; 6];
        let rows = (0..4000_u32).map(|k| {
            if k % 150 == 0 {
                setpoint = 450.0 + 250.0 * uniform();
            }
            let mut normal = |size: f64| size * (0..12).map(|_| uniform()).sum::<f64>();
            let reading = x + normal(0.25);
            slope += 0.3 * ((reading - last) / 0.02 - slope);
            last = reading;
            let square = if (k / 37) % 2 == 1 { 1.5 } else { -1.5 };
            let duty_percent: f64 = (40.0 + 0.015 * (setpoint - reading) - 0.018 * slope + square).clamp(0.0, 100.0);
            inputs.push(duty_percent);
            let delayed = inputs[inputs.len() - 7];
            for _ in 0..20 {
                v += 1e-3 * (150.0 * (delayed - 40.0) - 1.2 * v) + normal(2.5 * 1e-3_f64.sqrt());
                x += 1e-3 * v;
            }
            let position_mm = Some(reading);
            Sample { time_s: 0.02 * f64::from(k), duty_percent, position_mm, ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    #[test]
    fn a_delay_is_found_where_the_fitted_belief_has_the_poles_in_the_other_order() {
        let recording = pipe_with_delay();
        let belief = initial(std::slice::from_ref(&recording), 0.0, 1200.0, None, None).unwrap().model;
        assert!(belief.effects.fan_lag_s().unwrap() * belief.drag_per_s > 1.0, "{belief:?}");
        let options = Options { is_fitted: true, ..seeking(&["transport_delay", "wall_friction"]) };
        let found = diagnose(&belief, &[recording], &options);
        let delay = found.effects.iter().find(|named| named.candidate.entry.name == "transport_delay");
        let delay_s = found.mended.model.effects.values("transport_delay").map(|values| values[0]);
        assert!(delay.is_some_and(|named| named.probability > 0.9), "{}", found.verdict_in_words());
        assert!(delay_s.is_some_and(|delay_s| (delay_s - 0.12).abs() < 0.005), "{delay_s:?}");
    }
}
