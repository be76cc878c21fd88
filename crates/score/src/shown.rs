//! How much a record shows of what its owner does not know of, by the densities of the diagnosis.
//!
//! ```text
//! shown = ln p(record | true model) − max over rivals of ln p(record | rival)
//! ```
//!
//! The true model has the rig's own numbers. Its rivals are the belief and what the search of the diagnosis makes of
//! it, the true effect and its twins left out: see [`nats_above_rivals`]. A perfect diagnosis names what is shown by
//! some nats; what a chance of the noise hides is not shown, whatever the Cramér–Rao bound expects.

use crate::closed::true_model;
use crate::names::imitators;
use crate::truth::CaseTruth;
use diagnose::Recording;
use diagnose::scoring::{Departure, nats_above_rivals};
use plant::Model;

/// Nats by which the true model beats its best rival; of two effects, those of the one that shows less. `None`: no
/// effect, or none that the catalogue can write.
#[must_use]
pub fn shown(belief: &Model, truth: &CaseTruth, recording: &Recording) -> Option<f64> {
    if truth.effects.is_empty() {
        return None;
    }
    let model = true_model(belief, truth)?;
    let effects = truth.effects.iter();
    let departures: Vec<Departure<'_>> =
        effects.map(|effect| Departure { name: &effect.name, twins: imitators(&effect.name) }).collect();
    nats_above_rivals(belief, &model, &departures, recording)
}

#[cfg(test)]
mod tests {
    use super::shown;
    use crate::tests_support::{model, shaken};
    use crate::truth::tests::lag_of_a_rig;
    use plant::{Effects, Model};

    #[test]
    fn a_lag_is_shown_by_a_record_of_a_rig_that_has_it_and_the_more_the_longer_it_is() {
        let belief = Model { effects: Effects::default(), ..model() };
        let of = |seconds| shown(&belief, &lag_of_a_rig("fan_lag"), &shaken(&model(), 3, seconds)).unwrap();
        let (short, long) = (of(20), of(80));
        assert!(short > 5.0 && (2.5..6.0).contains(&(long / short)), "{short} and {long} nats");
    }

    #[test]
    fn what_does_not_act_is_not_shown_and_what_the_catalogue_cannot_write_has_no_number() {
        let rig = Model { effects: Effects::default(), ..model() };
        let recording = shaken(&rig, 3, 40);
        assert!(shown(&rig, &lag_of_a_rig("fan_lag"), &recording).unwrap() < -5.0);
        assert_eq!(shown(&rig, &lag_of_a_rig("gusts"), &recording), None);
    }
}
