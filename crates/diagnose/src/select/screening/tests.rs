use crate::record::folds::Folds;
use crate::select::candidates::{Candidate, candidates};
use crate::select::refit::refitted;
use crate::select::search::Search;
use crate::tests_support::{model, record, shaken};
use plant::effects::{Hysteresis, Saturation};
use plant::{Effects, Model};

/// The base gain after the refit of `belief`, and the candidates, the best first.
fn found(belief: &Model, recording: &crate::Recording) -> (f64, Vec<Candidate>) {
    let folds = Folds::new(belief, recording);
    let search = Search::new(belief, recording, &folds, &crate::Options::default());
    let so_far = refitted(&search);
    (so_far.model.gain_mm_per_s2_per_percent, candidates(&search, &so_far).0)
}

#[test]
fn tight_limits_that_the_refit_takes_for_a_weak_fan_are_found_from_the_believed_gain() {
    let belief = Model { effects: Effects::default(), ..model() };
    let limits = Saturation { lower_mm_per_s2: -280.0, upper_mm_per_s2: 70.0 };
    let rig = Model { effects: Effects { saturation: Some(limits), ..Effects::default() }, ..belief.clone() };
    let (gain, found) = found(&belief, &shaken(&rig, 1, 60));
    assert!(gain < 0.4 * belief.gain_mm_per_s2_per_percent, "{gain}");
    let best = &found[0];
    let limits = best.fit.model.effects.saturation.expect(best.entry.name);
    let gain = best.fit.model.gain_mm_per_s2_per_percent / belief.gain_mm_per_s2_per_percent;
    assert!((limits.lower_mm_per_s2 / -280.0 - 1.0).abs() < 0.15, "{limits:?}");
    assert!((limits.upper_mm_per_s2 / 70.0 - 1.0).abs() < 0.15 && (gain - 1.0).abs() < 0.15, "{limits:?}, {gain}");
}

#[test]
fn a_play_wider_than_what_the_duty_jitters_is_found() {
    let belief = Model { effects: Effects::default(), ..model() };
    let play = Hysteresis { half_width_percent: 0.45 };
    let rig = Model { effects: Effects { hysteresis: Some(play), ..Effects::default() }, ..belief.clone() };
    let found = found(&belief, &record(&rig, 1, 60)).1;
    let play = found[0].fit.model.effects.hysteresis.expect(found[0].entry.name);
    assert!((play.half_width_percent / 0.45 - 1.0).abs() < 0.2, "{play:?}");
}
