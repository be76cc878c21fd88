//! What `motion.rs` promises.

use super::{Input, Motion};
use crate::effects::{Effects, FanLag};
use crate::model::{Model, tests::thesis};
use libm::exp;

fn fly(model: &Model, duty: f64, seconds: f64, steps: u32, start: Motion) -> Motion {
    let commanded = model.commanded(duty);
    let dt = seconds / f64::from(steps);
    (0..steps).fold(start, |motion, _| motion.step(model, Input::of(commanded), dt))
}

#[test]
fn a_duty_step_without_lag_is_the_closed_form() {
    let model = Model { pipe_length_mm: 1e6, effects: Effects::default(), ..thesis() };
    let (t, a) = (0.8, model.drag_per_s);
    let force = model.gain_mm_per_s2_per_percent * 0.5;
    let end = fly(&model, model.hover_duty_percent + 0.5, t, 800, Motion::at_rest(0.0, 0.0));
    let exact = force / a * (t - (1.0 - exp(-a * t)) / a);
    assert!((end.position_mm - exact).abs() < 1e-9, "{} mm, exact {exact} mm", end.position_mm);
}

#[test]
fn a_duty_step_through_the_double_pole_of_g_c_is_the_closed_form() {
    // τ = 1/a: velocity F/a·(1 − (1 + a·t)·e^(−a·t)), position its integral.
    let a = 3.896;
    let lag = FanLag { time_constant_s: 1.0 / a };
    let effects = Effects { fan_lag: Some(lag), ..Effects::default() };
    let model = Model { pipe_length_mm: 1e6, effects, ..thesis() };
    let force = model.gain_mm_per_s2_per_percent;
    let t = 1.0;
    let end = fly(&model, model.hover_duty_percent + 1.0, t, 1000, Motion::at_rest(0.0, 0.0));
    let decay = exp(-a * t);
    let velocity = force / a * (1.0 - (1.0 + a * t) * decay);
    let position = force / a * (t - 2.0 / a * (1.0 - decay) + t * decay);
    assert!((end.velocity_mm_per_s - velocity).abs() < 1e-8, "{} mm/s, exact {velocity}", end.velocity_mm_per_s);
    assert!((end.position_mm - position).abs() < 1e-8, "{} mm, exact {position}", end.position_mm);
}

#[test]
fn the_ball_rests_at_both_ends_and_leaves_them_when_pushed() {
    let model = Model { effects: Effects::default(), ..thesis() };
    let bottom = fly(&model, model.hover_duty_percent - 3.0, 2.0, 2000, Motion::at_rest(100.0, 0.0));
    assert_eq!((bottom.position_mm, bottom.velocity_mm_per_s), (0.0, 0.0));
    let top = fly(&model, model.hover_duty_percent + 3.0, 3.0, 3000, bottom);
    assert_eq!((top.position_mm, top.velocity_mm_per_s), (model.pipe_length_mm, 0.0));
    let falling = fly(&model, model.hover_duty_percent - 1.0, 0.1, 100, top);
    assert!(falling.position_mm < model.pipe_length_mm && falling.velocity_mm_per_s < 0.0);
}

/// Flies without a duty: `commanded` acceleration for `seconds` in `steps`.
fn push(model: &Model, commanded: f64, seconds: f64, steps: u32, start: Motion) -> Motion {
    let dt = seconds / f64::from(steps);
    (0..steps).fold(start, |motion, _| motion.step(model, Input::of(commanded), dt))
}

/// A long pipe without drag, with one effect.
fn frictionless(name: &str, values: &[f64]) -> Model {
    let mut model = Model { drag_per_s: 0.0, pipe_length_mm: 1e6, effects: Effects::default(), ..thesis() };
    assert!(model.effects.set(name, values), "{name}");
    model
}

fn thrown(position_mm: f64, velocity_mm_per_s: f64) -> Motion {
    Motion { velocity_mm_per_s, ..Motion::at_rest(position_mm, 0.0) }
}

fn near(value: f64, exact: f64, within: f64) {
    assert!((value - exact).abs() <= within, "{value}, exact {exact}");
}

#[test]
fn every_smooth_effect_together_converges_with_order_four() {
    let mut model = Model { pipe_length_mm: 1e6, ..thesis() };
    model.effects.set("spin_asymmetry", &[0.15, 0.4]);
    model.effects.fan_lag = None;
    model.effects.set("height_dependent_flow", &[20.0]);
    model.effects.set("turbulence", &[100.0, 0.3]);
    model.effects.set("quadratic_drag", &[0.005]);
    model.effects.set("sensor_lag", &[0.1]);
    let start = Motion { turbulence_mm_per_s2: 150.0, ..thrown(5e5 - 200.0, 300.0) };
    let end = |steps| push(&model, 700.0, 0.5, steps, start);
    let exact = end(2560);
    for read in [|m: Motion| m.position_mm, |m: Motion| m.velocity_mm_per_s, |m: Motion| m.sensed_mm] {
        let error = |steps| (read(end(steps)) - read(exact)).abs();
        let order = (error(20) / error(40)).log2();
        assert!((3.6..4.6).contains(&order), "order {order}: {} {}", error(20), error(40));
    }
}

#[test]
fn quadratic_drag_alone_is_the_closed_form() {
    // dv/dt = −c·v²: v = v₀/(1 + c·v₀·t), y = ln(1 + c·v₀·t)/c, upward and downward.
    let (c, v, t) = (0.004, 900.0, 0.7);
    let model = frictionless("quadratic_drag", &[c]);
    for sign in [1.0, -1.0] {
        let end = push(&model, 0.0, t, 700, thrown(5e5, sign * v));
        near(end.velocity_mm_per_s, sign * v / (1.0 + c * v * t), 1e-6);
        near(end.position_mm, 5e5 + sign * (c * v * t).ln_1p() / c, 1e-6);
    }
}

#[test]
fn flow_that_falls_with_height_swings_the_ball_about_its_centre() {
    // y − centre = 100·cos(√g·t).
    let mut model = frictionless("height_dependent_flow", &[9.0]);
    model.effects.height_dependent_flow.as_mut().unwrap().centre_mm = Some(400.0);
    let end = push(&model, 0.0, 2.0, 2000, Motion::at_rest(500.0, 0.0));
    near(end.position_mm, 400.0 + 100.0 * (3.0 * 2.0_f64).cos(), 1e-6);
}

#[test]
fn turbulence_pushes_and_is_forgotten() {
    // v = w₀·τ·(1 − e^(−t/τ)).
    let model = frictionless("turbulence", &[50.0, 0.3]);
    let start = Motion { turbulence_mm_per_s2: 80.0, ..Motion::at_rest(5e5, 0.0) };
    let end = push(&model, 0.0, 0.6, 600, start);
    near(end.turbulence_mm_per_s2, 80.0 * exp(-2.0), 1e-10);
    near(end.velocity_mm_per_s, 80.0 * 0.3 * (1.0 - exp(-2.0)), 1e-8);
}

#[test]
fn a_lagging_sensor_trails_a_steady_ball_by_its_time_constant() {
    // s = y₀ + v·(t − τ·(1 − e^(−t/τ))).
    let model = frictionless("sensor_lag", &[0.08]);
    let end = push(&model, 0.0, 0.3, 15, thrown(1000.0, 200.0));
    near(end.sensed_mm, 1000.0 + 200.0 * (0.3 - 0.08 * (1.0 - exp(-0.3 / 0.08))), 1e-9);
}

#[test]
fn lags_far_shorter_than_the_step_are_no_lag() {
    let mut model = frictionless("fan_lag", &[1e-6]);
    model.effects.set("sensor_lag", &[1e-6]);
    let end = push(&model, 500.0, 1.0, 50, Motion::at_rest(1000.0, 500.0));
    near(end.position_mm, 1250.0, 1e-8);
    near(end.sensed_mm, 1250.0, 1e-2);
}

#[test]
fn a_sliding_ball_stops_where_friction_has_eaten_its_energy_in_any_step() {
    // Stops after v/f at v²/(2f), and stays.
    let model = frictionless("wall_friction", &[250.0]);
    for (steps, v) in [(1, 100.0), (7, 100.0), (1000, 100.0), (1, -100.0), (333, -100.0)] {
        let end = push(&model, 0.0, 1.0, steps, thrown(5e5, v));
        assert_eq!(end.velocity_mm_per_s, 0.0);
        near(end.position_mm, 5e5 + v * v.abs() / 500.0, 1e-8);
    }
}

#[test]
fn a_ball_at_rest_sticks_up_to_the_friction_and_slides_beyond_it() {
    let model = frictionless("wall_friction", &[250.0]);
    let rest = Motion::at_rest(5e5, 0.0);
    for force in [-250.0, 249.0, 250.0] {
        let end = push(&model, force, 1.0, 100, rest);
        assert_eq!((end.position_mm, end.velocity_mm_per_s), (5e5, 0.0));
    }
    for force in [-260.0, 260.0_f64] {
        let end = push(&model, force, 1.0, 100, rest);
        near(end.position_mm, 5e5 + 5.0 * force.signum(), 1e-8);
    }
}

#[test]
fn a_ball_thrown_against_the_force_turns_round_through_friction_in_one_step() {
    // Up: −(800 + 200) for 0.3 s from 300 mm/s, 45 mm. Down: −(800 − 200) for 0.4 s, 48 mm.
    let model = frictionless("wall_friction", &[200.0]);
    for steps in [1, 10, 700] {
        let end = push(&model, -800.0, 0.7, steps, thrown(5e5, 300.0));
        near(end.position_mm, 5e5 + 45.0 - 48.0, 1e-8);
        near(end.velocity_mm_per_s, -240.0, 1e-8);
    }
}

#[test]
fn a_bounce_is_exact_in_any_step() {
    // From 200 mm under −1000 mm/s²: hits at √0.4 s, rises to e²·200 mm one e·√0.4 s later.
    let model = frictionless("end_stop", &[0.0, 500.0, 0.8]);
    let peak_s = 0.4_f64.sqrt() * 1.8;
    for steps in [1, 3, 100, 1000] {
        let end = push(&model, -1000.0, peak_s, steps, Motion::at_rest(200.0, 0.0));
        near(end.position_mm, 128.0, 1e-8);
        near(end.velocity_mm_per_s, 0.0, 1e-8);
    }
}

#[test]
fn a_ball_that_bounces_ever_lower_comes_to_rest_when_the_series_ends() {
    // All hops together last √(2h/g)·(1 + e)/(1 − e).
    let model = frictionless("end_stop", &[50.0, 500.0, 0.5]);
    let last_s = 0.4_f64.sqrt() * 3.0;
    let before = push(&model, -1000.0, last_s - 0.05, 2000, Motion::at_rest(250.0, 0.0));
    assert!(before.position_mm > 50.0, "{before:?}");
    let after = push(&model, -1000.0, last_s + 0.01, 2000, Motion::at_rest(250.0, 0.0));
    assert_eq!((after.position_mm, after.velocity_mm_per_s), (50.0, 0.0));
}

#[test]
fn a_ball_that_is_kicked_against_the_end_it_lies_on_bounces() {
    let model = frictionless("end_stop", &[0.0, 500.0, 0.5]);
    near(push(&model, 0.0, 0.1, 3, thrown(0.0, -100.0)).position_mm, 5.0, 1e-9);
    near(push(&model, 0.0, 0.1, 3, thrown(500.0, 100.0)).position_mm, 495.0, 1e-9);
}

#[test]
fn end_stops_take_the_place_of_the_ends_of_the_pipe() {
    let model = frictionless("end_stop", &[-20.0, 600.0, 0.0]);
    let model = Model { pipe_length_mm: 583.0, ..model };
    assert_eq!(push(&model, -500.0, 2.0, 2000, Motion::at_rest(100.0, 0.0)).position_mm, -20.0);
    assert_eq!(push(&model, 500.0, 2.0, 2000, Motion::at_rest(100.0, 0.0)).position_mm, 600.0);
}

#[test]
fn the_sensor_goes_on_lagging_while_the_ball_is_held() {
    let model = frictionless("sensor_lag", &[0.1]);
    let start = Motion { sensed_mm: 30.0, ..Motion::at_rest(0.0, -500.0) };
    near(push(&model, -500.0, 0.2, 10, start).sensed_mm, 30.0 * exp(-2.0), 1e-9);
}

#[test]
fn spinning_up_and_down_have_their_own_lags() {
    // v = A·(t − τ·(1 − e^(−t/τ))) up from 0; A falls as e^(−t/τ) once the command is gone.
    let model = frictionless("spin_asymmetry", &[0.1, 0.5]);
    let up = push(&model, 300.0, 0.4, 400, Motion::at_rest(1000.0, 0.0));
    near(up.velocity_mm_per_s, 300.0 * (0.4 - 0.1 * (1.0 - exp(-4.0))), 1e-7);
    let down = push(&model, 0.0, 0.5, 500, up);
    near(down.fan_mm_per_s2, up.fan_mm_per_s2 * exp(-1.0), 1e-9);
}
