//! What `actuator.rs` promises.

use super::Actuator;
use crate::effects::Effects;
use crate::model::{Model, tests::thesis};

/// The thesis' model with `effects` only.
fn model(effects: &[(&str, &[f64])]) -> Model {
    let mut model = Model { effects: Effects::default(), ..thesis() };
    for (name, values) in effects {
        assert!(model.effects.set(name, values), "{name}");
    }
    model
}

/// What a sequence of duties about hover, written a millisecond apart, commands in the end, in percent of duty.
fn commanded(model: &Model, about_hover: &[f64]) -> f64 {
    let mut actuator = Actuator::new(model, model.hover_duty_percent + about_hover[0]);
    let mut last = 0.0;
    for (k, u) in (0..).zip(about_hover) {
        let t = 0.001 * f64::from(k);
        actuator.write(model, t, model.hover_duty_percent + u);
        last = actuator.commanded(model, t);
    }
    last / model.gain_mm_per_s2_per_percent
}

fn near(value: f64, exact: f64) {
    assert!((value - exact).abs() < 1e-9, "{value}, exact {exact}");
}

#[test]
fn a_delayed_duty_begins_to_act_at_its_instant() {
    let model = model(&[("transport_delay", &[0.25])]);
    let mut actuator = Actuator::new(&model, 21.4);
    actuator.write(&model, 1.0, 22.4);
    actuator.write(&model, 1.02, 23.4);
    assert_eq!(actuator.next_jump_s(1.0), Some(1.25));
    assert_eq!(actuator.commanded(&model, 1.2499), 0.0);
    near(actuator.commanded(&model, 1.25), 827.2);
    assert_eq!(actuator.next_jump_s(1.25), Some(1.27));
    near(actuator.commanded(&model, 1.3), 2.0 * 827.2);
    assert_eq!(actuator.next_jump_s(1.3), None);
}

#[test]
fn the_grid_of_the_duty_starts_at_zero_and_not_at_hover() {
    // 21.7 % is nearest to 27 × 0.8 = 21.6 %.
    near(commanded(&model(&[("duty_quantisation", &[0.8])]), &[0.3]), 0.2);
}

#[test]
fn a_duty_at_a_limited_rate_ramps_to_each_new_one_from_where_it_is() {
    // 100 % in 5 s is 20 %/s.
    let model = model(&[("rate_limit", &[5.0])]);
    let mut actuator = Actuator::new(&model, 21.4);
    actuator.write(&model, 1.0, 23.4);
    near(actuator.commanded(&model, 1.05), 827.2);
    actuator.write(&model, 1.05, 21.4);
    near(actuator.commanded(&model, 1.075), 0.5 * 827.2);
    near(actuator.commanded(&model, 1.2), 0.0);
    actuator.write(&model, 2.0, 21.9);
    near(actuator.commanded(&model, 3.0), 0.5 * 827.2);
}

#[test]
fn the_play_starts_centred() {
    let model = model(&[("hysteresis", &[0.5])]);
    near(commanded(&model, &[3.0]), 3.0);
    near(commanded(&model, &[3.0, 3.4]), 3.0);
    near(commanded(&model, &[3.0, 2.6]), 3.0);
    near(commanded(&model, &[3.0, 4.0, 3.1]), 3.5);
}

#[test]
fn the_play_comes_before_the_dead_zone() {
    // Play first: −0.6 pulls it to −0.1, inside the zone. Zone first: 0.7 then −0.3, the play stays at 0.2.
    let both = model(&[("hysteresis", &[0.5]), ("dead_zone", &[-0.3, 0.3])]);
    assert_eq!(commanded(&both, &[0.0, 1.0, -0.6]), 0.0);
}

#[test]
fn the_dead_zone_comes_before_the_thrust_curve() {
    let both = model(&[("dead_zone", &[-0.3, 0.3]), ("thrust_curve", &[0.1])]);
    near(commanded(&both, &[1.3]), 1.0 + 0.1);
    near(commanded(&both, &[-1.3]), -1.0 + 0.1);
}

#[test]
fn the_asymmetry_judges_what_is_left_of_the_duty() {
    let both = model(&[("force_asymmetry", &[4.0]), ("dead_zone", &[-0.3, 0.3])]);
    near(commanded(&both, &[1.3]), 2.0);
    near(commanded(&both, &[-1.3]), -0.5);
}

#[test]
fn the_limits_come_after_every_gain() {
    let all = model(&[("force_asymmetry", &[4.0]), ("gain_drift", &[0.1]), ("saturation", &[-800.0, 1100.0])]);
    let mut actuator = Actuator::new(&all, 22.0);
    near(actuator.commanded(&all, 0.0), 827.2 * 0.6 * 2.0);
    near(actuator.commanded(&all, 5.0), 1100.0);
}

#[test]
fn gain_and_hover_drift_from_the_start_of_the_record() {
    let both = model(&[("gain_drift", &[-0.02]), ("hover_drift", &[0.05])]);
    assert!(Actuator::drifts(&both) && !Actuator::drifts(&thesis()));
    let mut actuator = Actuator::new(&both, 22.4);
    for t in [0.0, 1.0, 10.0] {
        near(actuator.commanded(&both, t), 827.2 * (1.0 - 0.02 * t) * (1.0 - 0.05 * t));
    }
}

#[test]
fn the_play_follows_a_drift_however_rarely_it_is_asked() {
    // Hover climbs 1 % in 10 s, then the duty jumps back up: the play has been dragged to u + 0.2 = −0.8.
    let both = model(&[("hysteresis", &[0.2]), ("hover_drift", &[0.1])]);
    let mut actuator = Actuator::new(&both, 21.4);
    actuator.write(&both, 10.0, 21.7);
    near(actuator.commanded(&both, 10.0) / 827.2, -0.8);
}

#[test]
fn a_model_commands_what_its_actuator_has_settled_on() {
    let all = model(&[("transport_delay", &[0.3]), ("hysteresis", &[0.5]), ("dead_zone", &[-0.3, 0.3])]);
    near(all.commanded(23.4), 827.2 * 1.7);
}
