//! The share of the gap that the true effects close, to compare with the claimed share.
//!
//! ```text
//! closed = (E_belief² − E_true²) / (E_belief² − F_true²)          at 1 s, over the readings in free flight
//! ```
//!
//! The true model is the belief with the rig's own gain, drag, hover and effects, as the catalogue has them. Nothing is
//! fitted, so that no half is held out. A rig with an effect outside the catalogue has no such share; nor has one with
//! too small a gap.

use crate::truth::{CaseTruth, TrueEffect};
use diagnose::scoring::{is_open, share_closed};
use diagnose::{Gap, Recording, in_free_flight};
use plant::{Effects, Model, Neutral};
use serde_json::{Map, Value};

/// The share of the gap at 1 s between `belief` and `recording` that the true model closes.
#[must_use]
pub fn closed_of_truth(belief: &Model, truth: &CaseTruth, recording: &Recording) -> Option<f64> {
    let model = true_model(belief, truth)?;
    let counts = in_free_flight(belief, recording);
    let gap = |model: &Model| Gap::measure_where(model, recording, &|row| counts[row]);
    let (nominal, best) = (gap(belief), gap(&model));
    let [before, after, floor] = [nominal.error_mm[2]?, best.error_mm[2]?, best.floor_mm[2]?].map(|mm| mm * mm);
    is_open(before, floor).then(|| share_closed(before, after, floor))
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
    use super::{closed_of_truth, true_model};
    use crate::tests_support::{model, record};
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
        let closed = closed_of_truth(&belief, &lag_of_a_rig("fan_lag"), &record(&model(), 3, 80)).unwrap();
        assert!((closed - 1.0).abs() < 0.1, "{closed}");
    }

    #[test]
    fn nothing_is_closed_where_nothing_is_open_or_the_catalogue_has_no_word() {
        let recording = record(&model(), 3, 80);
        assert_eq!(closed_of_truth(&model(), &lag_of_a_rig("fan_lag"), &recording), None);
        let belief = Model { effects: Effects::default(), ..model() };
        assert_eq!(closed_of_truth(&belief, &lag_of_a_rig("gusts"), &recording), None);
    }
}
