//! The information of a record about the effects that are missing in the belief, by the likelihoods of the diagnosis.
//!
//! ```text
//! shown = ln p(record | true model) − max over rivals of ln p(record | rival)
//! ```
//!
//! The true model has the rig's own parameters. Its rivals are the belief and the models that the search of the
//! diagnosis finds without the true effect and those that are not distinguishable from it: see [`nats_above_rivals`]. A
//! perfect diagnosis names an effect that gains several nats; an effect that is hidden by this realisation of the noise
//! counts as not shown, whatever the Cramér–Rao bound is.

use crate::closed::true_model;
use crate::names::imitators;
use crate::truth::{CaseTruth, Kind};
use diagnose::Recording;
use diagnose::scoring::{Departure, nats_above_rivals};
use plant::Model;

/// Log-likelihood of the true model minus that of its best rival, nats; of two effects, the smaller gain. `None`: an
/// effect outside the catalogue, or a kind for which no row of the score needs it. Each effect of a rig takes a search.
#[must_use]
pub fn shown(belief: &Model, truth: &CaseTruth, recording: &Recording) -> Option<f64> {
    if !matches!(truth.kind, Kind::Single | Kind::Pair) {
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
    use crate::truth::{CaseTruth, Kind};
    use plant::{Effects, Model};

    #[test]
    fn a_lag_is_shown_by_a_record_of_a_rig_that_has_it_and_the_more_the_longer_it_is() {
        let belief = Model { effects: Effects::default(), ..model() };
        let of = |seconds| shown(&belief, &lag_of_a_rig("fan_lag"), &shaken(&model(), 3, seconds)).unwrap();
        let (short, long) = (of(20), of(80));
        assert!(short > 5.0 && (2.5..6.0).contains(&(long / short)), "{short} and {long} nats");
    }

    #[test]
    fn what_does_not_act_is_not_shown_and_what_is_not_asked_or_not_in_the_catalogue_has_no_number() {
        let rig = Model { effects: Effects::default(), ..model() };
        let recording = shaken(&rig, 3, 40);
        assert!(shown(&rig, &lag_of_a_rig("fan_lag"), &recording).unwrap() < -5.0);
        assert_eq!(shown(&rig, &lag_of_a_rig("gusts"), &recording), None);
        let amid = CaseTruth { kind: Kind::Amid, ..lag_of_a_rig("fan_lag") };
        assert_eq!(shown(&rig, &amid, &recording), None);
    }
}
