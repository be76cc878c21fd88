//! What `pid.rs` promises.

use super::{AntiWindup, DerivativeOn, Pid, PidState};
use crate::Limits;

const T: f64 = 0.02;
const FREE: Limits = Limits { lower: -1e9, upper: 1e9 };
const GAINS: Pid = Pid::new(0.01, 3.0, 0.3, 10.0, DerivativeOn::Measurement);

#[test]
fn the_integral_of_a_constant_error_is_the_closed_form() {
    let mut state = PidState::default();
    let mut control = 0.0;
    for _ in 0..=150 {
        control = GAINS.step(&mut state, 300.0, 200.0, T, FREE);
    }
    // 150 whole periods of a 100 mm error lie behind the last step: K_p·e·(1 + t/T_i).
    let exact = 0.01 * 100.0 * (1.0 + 150.0 * T / 3.0);
    assert!((control - exact).abs() < 1e-9, "{control}, exact {exact}");
}

#[test]
fn a_setpoint_jump_does_not_kick_the_derivative() {
    let mut state = PidState::default();
    GAINS.step(&mut state, 200.0, 200.0, T, FREE);
    let control = GAINS.step(&mut state, 300.0, 200.0, T, FREE);
    assert!((control - 1.0).abs() < 1e-9, "only K_p·e may act, got {control}");
}

#[test]
fn the_derivative_on_error_kicks_as_the_original_did() {
    let gains = Pid { derivative_on: DerivativeOn::Error, ..GAINS };
    let mut state = PidState::default();
    gains.step(&mut state, 200.0, 200.0, T, FREE);
    let control = gains.step(&mut state, 300.0, 200.0, T, FREE);
    assert!((control - 0.01 * (100.0 + 10.0 * 100.0)).abs() < 1e-9, "K_p·(e + N·Δe), got {control}");
}

#[test]
fn a_rising_ball_is_braked() {
    let mut state = PidState::default();
    GAINS.step(&mut state, 300.0, 300.0, T, FREE);
    assert!(GAINS.step(&mut state, 302.0, 302.0, T, FREE) < 0.0);
}

#[test]
fn integral_holds_while_the_fan_is_saturated() {
    let limits = Limits { lower: -1.0, upper: 1.0 };
    let mut state = PidState::default();
    for _ in 0..5000 {
        assert_eq!(GAINS.step(&mut state, 500.0, 0.0, T, limits), 1.0);
    }
    // The error turns: without windup the control leaves the limit at the first step.
    let control = GAINS.step(&mut state, 0.0, 10.0, T, limits);
    assert!(control < 1.0, "{control} is still at the limit");
}

#[test]
fn a_change_of_gains_does_not_bump_the_control() {
    let mut state = PidState::default();
    for k in 0..200 {
        GAINS.step(&mut state, 300.0, 250.0 + f64::from(k % 7), T, FREE);
    }
    let position = 250.0 + f64::from(199 % 7);
    let new = Pid { kp_per_mm: 0.03, ti_s: 8.0, td_s: 0.9, ..GAINS };
    let mut changed = state;
    new.take_over(&GAINS, &mut changed);
    // No time passes and nothing moves: both must ask for the same.
    let before = GAINS.step(&mut state, 300.0, position, 0.0, FREE);
    let after = new.step(&mut changed, 300.0, position, 0.0, FREE);
    assert!((before - after).abs() < 1e-12, "{before} became {after}");
}

#[test]
fn a_start_from_a_running_fan_keeps_its_control() {
    let mut state = PidState::starting_at(0.7);
    assert_eq!(GAINS.step(&mut state, 200.0, 200.0, T, FREE), 0.7);
}

#[test]
fn the_original_in_mm_per_s2_answers_a_step_of_the_error_by_its_transfer_function() {
    // K_p(1 + 1/(T_i s) + T_d s/(1 + T_d s/N)) with the thesis' 5, 3 s, 0.3 s and 10, on a step of the error by 1 mm.
    let original = Pid::new(5.0, 3.0, 0.3, 10.0, DerivativeOn::Error);
    let mut state = PidState::default();
    original.step(&mut state, 0.0, 0.0, 0.018, FREE);
    for k in 0..100 {
        let t = 0.018 * f64::from(k);
        let control = original.step(&mut state, 1.0, 0.0, 0.018, FREE);
        let exact = 5.0 * (1.0 + t / 3.0 + 10.0 * libm::exp(-10.0 * t / 0.3));
        assert!((control - exact).abs() < 1e-9, "{t} s: {control}, exact {exact}");
    }
}

#[test]
fn the_setpoint_weight_takes_its_share_of_a_jump_and_none_of_a_disturbance() {
    let weighted = Pid { setpoint_weight: 0.4, td_s: 0.0, ..GAINS };
    let mut state = PidState::default();
    let before = weighted.step(&mut state, 200.0, 200.0, T, FREE);
    let after = weighted.step(&mut state, 300.0, 200.0, T, FREE);
    assert!((after - before - 0.4 * 0.01 * 100.0).abs() < 1e-12, "{before} became {after}");
    // The integral saw 100 mm of error for one period; the fall of the ball by 50 mm counts in full.
    let fallen = weighted.step(&mut state, 300.0, 150.0, T, FREE);
    assert!((fallen - after - 0.01 * 50.0 - 0.01 * 100.0 * T / 3.0).abs() < 1e-12, "{after} became {fallen}");
}

#[test]
fn back_calculation_settles_where_integration_and_tracking_cancel() {
    let limits = Limits { lower: -1.0, upper: 1.0 };
    let tracking_s = 0.5;
    let gains = Pid { anti_windup: AntiWindup::BackCalculation { tracking_s }, td_s: 0.0, ..GAINS };
    let mut state = PidState::default();
    for _ in 0..5000 {
        assert_eq!(gains.step(&mut state, 150.0, 0.0, T, limits), 1.0);
    }
    // dI/dt = K_p·e/T_i − (K_p·e + I − 1)/T_t = 0 leaves I = 1 − K_p·e·(1 − T_t/T_i).
    let exact = 1.0 - 1.5 * (1.0 - tracking_s / 3.0);
    assert!((state.integral - exact).abs() < 1e-9, "{}, exact {exact}", state.integral);
}

#[test]
fn the_rate_limit_bounds_every_change_and_winds_nothing_up() {
    let gains = Pid { rate_limit_per_s: Some(2.0), ..GAINS };
    let mut state = PidState::default();
    let mut last = gains.step(&mut state, 200.0, 200.0, T, FREE);
    for k in 1..=200 {
        let control = gains.step(&mut state, 500.0, 200.0, T, FREE);
        assert!((control - last).abs() <= 2.0 * T + 1e-12, "step {k}: {last} became {control}");
        last = control;
    }
    // K_p·e = 3 is reached after 1.5 s, 75 steps; the integral grew in the other 125 only.
    let exact = 3.0 + 3.0 * 125.0 * T / 3.0;
    assert!((last - exact).abs() < 0.1, "{last}, exact {exact}");
}

proptest::proptest! {
    #[test]
    fn the_control_is_always_a_number_within_its_limits(
        samples in proptest::collection::vec((proptest::num::f64::ANY, proptest::num::f64::ANY, 0.0..10.0), 1..50)
    ) {
        let limits = Limits { lower: -21.4, upper: 30.0 };
        let mut state = PidState::default();
        for (setpoint, position, dt) in samples {
            let control = GAINS.step(&mut state, setpoint, position, dt, limits);
            proptest::prop_assert!((limits.lower..=limits.upper).contains(&control), "{control}");
        }
    }
}
