//! The share of the gap that the true effects close, to compare with the claimed share.
//!
//! ```text
//! closed    = (E_belief² − E_true²) / (E_belief² − F_true²)        at 1 s, over the readings in free flight
//! closed(e) = (E_without e² − E_true²) / (E_belief² − F_true²)     with e as it is believed, and all else true
//! ```
//!
//! The true model is the belief with the rig's own gain, drag, hover and effects, as the catalogue has them. Nothing is
//! fitted, so that no half is held out. A rig with an effect outside the catalogue has no such share; nor has one with
//! too small a gap.

use crate::truth::{CaseTruth, TrueEffect, Values};
use diagnose::scoring::{is_open, share_closed};
use diagnose::{Gap, Recording, in_free_flight};
use plant::{Effects, Model, Neutral};
use serde_json::{Map, Value};

/// The shares of the gap at 1 s that the true model closes.
#[derive(Clone, Debug, Default)]
pub struct TrueShares {
    /// With all of its numbers and effects.
    pub all: f64,
    /// Each effect beside everything else that is true, by its name.
    pub each: Values,
}

/// The shares of the gap at 1 s between `belief` and `recording` that the true model closes.
#[must_use]
pub fn true_shares(belief: &Model, truth: &CaseTruth, recording: &Recording) -> Option<TrueShares> {
    let model = true_model(belief, truth)?;
    let counts = in_free_flight(belief, recording);
    let gap = |model: &Model| Gap::measure_where(model, recording, &|row| counts[row]);
    let (nominal, best) = (gap(belief), gap(&model));
    let [before, after, floor] = [nominal.error_mm[2]?, best.error_mm[2]?, best.floor_mm[2]?].map(|mm| mm * mm);
    if !is_open(before, floor) {
        return None;
    }
    let all = share_closed(before, after, floor);
    let share_of = |effect: &TrueEffect| {
        let without = gap(&without(&model, belief, &effect.name)).error_mm[2]?.powi(2);
        Some((effect.name.clone(), all - share_closed(before, without, floor)))
    };
    Some(TrueShares { all, each: truth.effects.iter().filter_map(share_of).collect() })
}

/// The model with this effect as it is believed, on or off.
fn without(model: &Model, belief: &Model, name: &str) -> Model {
    let mut model = model.clone();
    match belief.effects.values(name) {
        Some(values) => model.effects.set(name, &values),
        None => model.effects.remove(name),
    };
    model
}

/// The rig in terms of the catalogue, if all its effects are in it.
pub(crate) fn true_model(belief: &Model, truth: &CaseTruth) -> Option<Model> {
    let tables = truth.rig_effects.iter().map(|effect| Some((effect.name.clone(), table(belief, effect)?)));
    let tables: Map<String, Value> = tables.collect::<Option<_>>()?;
    let model = Model {
        gain_mm_per_s2_per_percent: *truth.base.get("gain_mm_per_s2_per_percent")?,
        drag_per_s: *truth.base.get("drag_per_s")?,
        hover_duty_percent: *truth.base.get("hover_duty_percent")?,
        effects: serde_json::from_value(tables.into()).ok()?,
        ..belief.clone()
    };
    model.check().is_ok().then_some(model)
}

/// The table of an effect as a config has it. A parameter that is not given is neutral, or absent if no value of it is.
fn table(belief: &Model, effect: &TrueEffect) -> Option<Value> {
    let entry = Effects::built_in(&effect.name)?;
    let values = entry.params.iter().zip(entry.neutral(belief)).filter_map(|(param, neutral)| {
        let neutral = (!matches!(param.neutral, Neutral::Any(_))).then_some(neutral);
        Some((param.name.to_owned(), effect.parameters.get(param.name).copied().or(neutral)?.into()))
    });
    Some(values.collect::<Map<_, _>>().into())
}

#[cfg(test)]
mod tests {
    use super::{true_model, true_shares};
    use crate::tests_support::{model, record};
    use crate::truth::TrueEffect;
    use crate::truth::tests::lag_of_a_rig;
    use plant::{Effects, Model};

    #[test]
    fn a_force_over_the_height_is_linear_about_the_centre_of_the_rig() {
        let mut truth = lag_of_a_rig("height_dependent_flow");
        truth.rig_effects[0].parameters =
            [("gradient_per_s2", 1.5), ("centre_mm", 250.0)].map(|(key, value)| (key.to_owned(), value)).into();
        let flow = true_model(&model(), &truth).unwrap().effects.height_dependent_flow.unwrap();
        assert_eq!((flow.gradient_per_s2, flow.centre_mm, flow.turn_mm), (1.5, Some(250.0), None));
    }

    #[test]
    fn the_true_effects_close_the_whole_gap_of_a_rig_that_the_catalogue_can_write() {
        let belief = Model { effects: Effects::default(), ..model() };
        let closed = true_shares(&belief, &lag_of_a_rig("fan_lag"), &record(&model(), 3, 80)).unwrap();
        assert!((closed.all - 1.0).abs() < 0.1, "{closed:?}");
        assert!((closed.each["fan_lag"] - closed.all).abs() < 1e-9, "the lag is all that is missing: {closed:?}");
    }

    #[test]
    fn nothing_is_closed_where_nothing_is_open_or_the_catalogue_has_no_word() {
        let recording = record(&model(), 3, 80);
        assert!(true_shares(&model(), &lag_of_a_rig("fan_lag"), &recording).is_none());
        let belief = Model { effects: Effects::default(), ..model() };
        assert!(true_shares(&belief, &lag_of_a_rig("gusts"), &recording).is_none());
    }

    #[test]
    fn an_effect_closes_what_is_open_without_it_beside_the_others() {
        let lag = model().effects.fan_lag;
        let mut rig = model();
        rig.effects.set("wall_friction", &[40.0]);
        let belief = Model { effects: Effects::default(), ..model() };
        let mut truth = lag_of_a_rig("fan_lag");
        let friction = TrueEffect {
            name: "wall_friction".into(),
            parameters: [("acceleration_mm_per_s2".to_owned(), 40.0)].into(),
            ..truth.effects[0].clone()
        };
        truth.effects.push(friction.clone());
        truth.rig_effects.push(friction);
        let recording = record(&rig, 3, 80);
        let closed = true_shares(&belief, &truth, &recording).unwrap();
        let believing_the_lag = Model { effects: Effects { fan_lag: lag, ..Effects::default() }, ..model() };
        let retuned = true_shares(&believing_the_lag, &truth, &recording).unwrap();
        assert!(closed.each["wall_friction"] > 0.1 && closed.each["fan_lag"] > 0.05, "{closed:?}");
        assert!(retuned.each["fan_lag"].abs() < 1e-9 && (retuned.each["wall_friction"] - retuned.all).abs() < 1e-9);
    }
}
