use super::rated;
use crate::record::folds::Folds;
use crate::select::candidates::{Candidate, candidates};
use crate::select::initial_values::starts;
use crate::select::refit::refitted;
use crate::select::search::Search;
use crate::tests_support::{flown, model, record, shaken};
use plant::effects::{Hysteresis, Saturation, SensorOutliers, SensorQuantisation, TransportDelay, WallFriction};
use plant::{Effects, Model, Noise};

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

#[test]
fn friction_is_rated_at_what_a_regression_finds_with_the_gain_beside_it() {
    let belief = Model { effects: Effects::default(), pipe_length_mm: 1e5, hover_duty_percent: 50.0, ..model() };
    let belief = Model { gain_mm_per_s2_per_percent: 45.0, drag_per_s: 1.2, ..belief };
    let mut rig = Model { gain_mm_per_s2_per_percent: 90.0, ..belief.clone() };
    rig.noise.sensor_mm = 0.1;
    rig.effects.wall_friction = Some(WallFriction { acceleration_mm_per_s2: 700.0, transition_mm_per_s: None });
    let law = |t: f64, x: f64| 50.0 + 14.0 * (1.7 * t).sin() + 9.0 * (4.3 * t).cos() + 0.01 * (2000.0 - x);
    let recording = flown(&rig, 1, 40, law);
    let folds = Folds::new(&belief, &recording);
    let search = Search::new(&belief, &recording, &folds, &crate::Options::default());
    let so_far = refitted(&search);
    let entry = Effects::built_in("wall_friction").unwrap();
    let rated = rated(&search, &so_far, entry, &starts(entry, &so_far, &search));
    let best = &rated[0].model;
    let friction = best.effects.wall_friction.unwrap().acceleration_mm_per_s2;
    assert!((friction / 700.0 - 1.0).abs() < 0.25, "{friction}");
    assert!((best.gain_mm_per_s2_per_percent / 90.0 - 1.0).abs() < 0.25, "{}", best.gain_mm_per_s2_per_percent);
}

#[test]
fn coarse_and_wild_readings_are_found_although_a_force_is_missing_as_well() {
    let quiet = Noise { sensor_mm: 0.6, acceleration_psd_mm2_per_s3: 30.0 };
    let belief = Model { effects: Effects::default(), noise: quiet, ..model() };
    let late = Some(TransportDelay { delay_s: 0.25 });
    let coarse = Some(SensorQuantisation { step_mm: 12.6 });
    let wild = Some(SensorOutliers { probability: 0.015, size_mm: 60.0 });
    for (name, effects) in [
        ("sensor_quantisation", Effects { sensor_quantisation: coarse, ..Effects::default() }),
        ("sensor_outliers", Effects { sensor_outliers: wild, ..Effects::default() }),
    ] {
        let rig = Model { effects: Effects { transport_delay: late, ..effects }, ..belief.clone() };
        let best = &found(&belief, &shaken(&rig, 1, 60)).1[0];
        assert_eq!(best.entry.name, name, "{}", best.held_out_gain);
        assert!(best.held_out_gain > 100.0, "{name}: {}", best.held_out_gain);
    }
}
