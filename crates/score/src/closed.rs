//! The share of the gap that the true effects close, to compare with the claimed share.
//!
//! ```text
//! closed = (E_belief² − E_true²) / (E_belief² − F_true²)          at 1 s, over the readings in free flight
//! ```
//!
//! The true model is the belief with the rig's own gain, drag, hover and effects, as the catalogue has them. Nothing is
//! fitted, so that no half is held out. A rig with an effect outside the catalogue has no such share; nor has one with
//! too small a gap.

use crate::truth::CaseTruth;
use diagnose::scoring::{is_open, share_closed};
use diagnose::{Gap, Recording, in_free_flight};
use plant::{Effects, Model};

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
    let mut model = Model {
        gain_mm_per_s2_per_percent: *truth.base.get("gain_mm_per_s2_per_percent")?,
        drag_per_s: *truth.base.get("drag_per_s")?,
        hover_duty_percent: *truth.base.get("hover_duty_percent")?,
        effects: Effects::default(),
        ..belief.clone()
    };
    for effect in &truth.rig_effects {
        let entry = Effects::built_in(&effect.name)?;
        let neutral = entry.neutral(&model);
        let own = entry.params.iter().zip(neutral);
        let values: Vec<f64> =
            own.map(|(param, neutral)| effect.parameters.get(param.name).copied().unwrap_or(neutral)).collect();
        model.effects.set(&effect.name, &values);
    }
    model.check().is_ok().then_some(model)
}

#[cfg(test)]
mod tests {
    use super::closed_of_truth;
    use crate::tests_support::{model, record};
    use crate::truth::tests::lag_of_a_rig;
    use plant::{Effects, Model};

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
