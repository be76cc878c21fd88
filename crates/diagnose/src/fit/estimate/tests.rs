//! A fit recovers the parameters of the rig.

use super::Problem;
use crate::fit::parameter::{BASE, Parameter, Prior};
use crate::record::folds::Folds;
use crate::tests_support::{model, record, shaken};
use plant::effects::{FanLag, TransportDelay};
use plant::{Effect, Effects, Model};

#[test]
fn a_fit_recovers_the_numbers_of_the_rig_within_their_own_deviations() {
    let rig = model();
    let wrong = Model { gain_mm_per_s2_per_percent: 200.0, drag_per_s: 2.5, hover_duty_percent: 21.6, ..rig.clone() };
    let parameters = [&BASE[..], &[Parameter::Effect { entry: &FanLag::ENTRY, index: 0, size: 0.1 }]].concat();
    let (mut inside, mut all) = (0, 0);
    for seed in 0..8 {
        let recording = record(&rig, seed, 60);
        let folds = Folds::new(&rig, &recording);
        let problem = Problem { recording: &recording, belief: &rig, folds: &folds, prior: Prior::Belief };
        let fitted = problem.fit(&wrong, &parameters);
        let deviations = fitted.deviations();
        let off = [
            (fitted.model.gain_mm_per_s2_per_percent / rig.gain_mm_per_s2_per_percent).ln() / deviations[0],
            ((fitted.model.drag_per_s + 1.0) / (rig.drag_per_s + 1.0)).ln() / deviations[1],
            (fitted.model.hover_duty_percent - rig.hover_duty_percent) / 0.1 / deviations[2],
            (fitted.model.effects.fan_lag.unwrap().time_constant_s - 0.2) / 0.1 / deviations[5],
        ];
        assert!(off.iter().all(|off| off.abs() < 4.5), "seed {seed}: {off:?}");
        inside += off.iter().filter(|off| off.abs() < 1.645).count();
        all += off.len();
    }
    // 90 % of 32 is 28.8; fewer than 24 have a probability of 1 %.
    assert!(inside >= 24, "{inside} of {all} within their 90 % intervals");
}

// Without the lag of the rig, the likelihood is highest at no drag; with a delay in its place, far from there. A scale
// that is a ratio of the drag alone has no slope at 0, and the fit stayed, 150 nats below.
#[test]
fn a_fit_comes_back_from_a_drag_of_zero() {
    let rig = model();
    let recording = shaken(&rig, 3, 80);
    let belief = Model { effects: Effects::default(), ..rig };
    let folds = Folds::new(&belief, &recording);
    let problem = Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Nothing };
    let parameters = [&BASE[..], &[Parameter::Effect { entry: &TransportDelay::ENTRY, index: 0, size: 0.1 }]].concat();
    let total_from = |start: &Model, delay_s| {
        let effects = Effects { transport_delay: Some(TransportDelay { delay_s }), ..Effects::default() };
        problem.total_of(&problem.fit(&Model { effects, ..start.clone() }, &parameters))
    };
    let without = problem.fit(&belief, &BASE).model;
    assert!(without.drag_per_s < 0.01, "{}", without.drag_per_s);
    let (from_belief, from_zero) = (total_from(&belief, 0.1), total_from(&without, 0.03));
    assert!((from_belief - from_zero).abs() < 0.5, "{from_belief} and {from_zero} nats");
}
