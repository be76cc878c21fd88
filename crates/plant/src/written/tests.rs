//! Written effects beside built-in ones and closed forms, and what is refused.

use super::{Definition, DefinitionError, DefinitionTable};
use crate::effects::Effects;
use crate::model::{Model, tests::thesis};
use crate::motion::{Input, Motion};

fn table(json: serde_json::Value) -> DefinitionTable {
    serde_json::from_value(json).unwrap()
}

/// `adds` with the parameter `k`, neutral at 0.
fn simple(stage: &str, adds: &str) -> DefinitionTable {
    table(serde_json::json!({
        "stage": stage, "adds": adds, "parameters": { "k": { "neutral": 0.0, "low": -100.0, "high": 100.0 } },
    }))
}

fn refused(table: &DefinitionTable) -> DefinitionError {
    Definition::new("refused", table).unwrap_err()
}

/// A model with one effect: of its own, or written with these values.
fn with(name: &str, values: &[f64], written: Option<&DefinitionTable>) -> Model {
    let mut model = Model { effects: Effects::default(), ..thesis() };
    if let Some(table) = written {
        model.effects.written.define(Definition::new(name, table).unwrap());
    }
    assert!(model.effects.set(name, values), "{name}");
    model.check().unwrap();
    model
}

/// Heights of a ball under a square wave of the duty, from 250 mm.
fn heights(model: &Model) -> Vec<f64> {
    let mut motion = model.at_rest(250.0, 0.0);
    let step = |k: i32| {
        let duty = model.hover_duty_percent + if (k / 40) % 2 == 0 { 0.6 } else { -0.6 };
        let input = Input { time_s: f64::from(k) * 0.01, ..Input::of(model.commanded(duty)) };
        motion = motion.step(model, input, 0.01);
        motion.position_mm
    };
    (0..400).map(step).collect()
}

fn same(one: &[f64], other: &[f64]) {
    let off = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-12 * 583.0, "{off} mm");
}

#[test]
fn an_effect_written_as_a_formula_flies_as_the_one_in_rust() {
    let drag = with("drag_of_mine", &[0.004], Some(&simple("ball", "-k * v * abs(v)")));
    same(&heights(&drag), &heights(&with("quadratic_drag", &[0.004], None)));
    let flow = with("flow_of_mine", &[6.0], Some(&simple("air", "-k * (x - 291.5)")));
    same(&heights(&flow), &heights(&with("height_dependent_flow", &[6.0], None)));
}

/// A supply that loses the share `k` of a step with the time constant `tau`.
fn sagging(k: f64, tau: f64) -> Model {
    let sag = table(serde_json::json!({
        "stage": "air", "adds": "-k * s", "states": { "s": { "rate": "(fan - s) / tau", "start": "fan" } },
        "parameters": { "k": { "neutral": 0.0, "low": 0.0, "high": 1.0 }, "tau": { "value": 2.0, "low": 0.1, "high": 9.0 } },
    }));
    with("sag", &[k, tau], Some(&sag))
}

#[test]
fn a_state_follows_its_rate_along_an_exponential_and_the_ball_moves_as_the_closed_form_says() {
    let (share, tau) = (0.5, 1.5);
    let model = Model { drag_per_s: 0.0, ..sagging(share, tau) };
    let (step, t) = (100.0, 3.0);
    let end = (0..300)
        .fold(Motion::at_rest(1e5, 0.0), |motion, _| motion.step_in_endless_pipe(&model, Input::of(step), 0.01));
    let decay = (-t / tau).exp();
    let (state, speed) = (step * (1.0 - decay), step * (t - share * (t - tau * (1.0 - decay))));
    assert!((end.own[0] - state).abs() < 1e-6, "{}, exact {state}", end.own[0]);
    assert!((end.velocity_mm_per_s - speed).abs() < 1e-6, "{}, exact {speed}", end.velocity_mm_per_s);
}

#[test]
fn a_ball_at_rest_with_a_settled_state_stays_there_at_an_end() {
    let model = sagging(0.5, 1.0);
    let rest = model.at_rest(0.0, -80.0);
    assert_eq!(rest.own[0], -80.0);
    let held = (0..100).fold(rest, |motion, _| motion.step(&model, Input::of(-100.0), 0.01));
    assert_eq!(held.position_mm, 0.0);
    let exact = -100.0 + 20.0 * (-1.0_f64).exp();
    assert!((held.own[0] - exact).abs() < 1e-6, "{}, exact {exact}", held.own[0]);
}

#[test]
fn a_formula_in_the_actuator_changes_the_command_and_may_move_with_time() {
    let model = with("ripple", &[0.5], Some(&simple("actuator", "k * sin(t) + k * u")));
    let mut actuator = crate::Actuator::new(&model, model.hover_duty_percent + 1.0);
    assert!(crate::Actuator::drifts(&model));
    let at = actuator.commanded(&model, 2.0);
    let exact = model.gain_mm_per_s2_per_percent * (1.0 + 0.5 * 2.0_f64.sin() + 0.5);
    assert!((at - exact).abs() < 1e-9, "{at}, exact {exact}");
}

/// A sensor that shows `k` of the square of the height more, and of a state that follows the fan.
fn bending() -> Model {
    let bend = table(serde_json::json!({
        "stage": "sensor", "adds": "k * x^2 + 100 * k * v + k * s",
        "states": { "s": { "rate": "(fan - s) / 0.5", "start": "fan" } },
        "parameters": { "k": { "neutral": 0.0, "low": 0.0, "high": 1.0 } },
    }));
    with("bending", &[1e-3], Some(&bend))
}

#[test]
fn a_formula_in_the_sensor_changes_what_is_seen_and_leaves_the_ball_alone() {
    let model = bending();
    let plain = Model { effects: Effects::default(), ..model.clone() };
    assert_eq!(heights(&model), heights(&plain));
    assert!(model.effects.acts_on_reading() && model.effects.motion_is_linear());
    let motion = Motion { velocity_mm_per_s: -30.0, own: [80.0, 0.0], ..Motion::at_rest(200.0, 0.0) };
    let seen = model.seen_mm(&motion, Input::of(0.0));
    let exact = 200.0 + 1e-3 * (200.0_f64.powi(2) - 3000.0 + 80.0);
    assert!((seen - exact).abs() < 1e-9, "{seen}, exact {exact}");
    assert_eq!(plain.seen_mm(&motion, Input::of(0.0)), 200.0);
}

#[test]
fn the_slopes_of_what_is_seen_are_those_of_the_closed_form() {
    let model = bending();
    let motion = Motion::at_rest(200.0, 0.0);
    let still = Motion::at_rest(0.0, 0.0);
    for (along, exact) in [
        (Motion { sensed_mm: 1.0, ..still }, 1.0 + 2.0 * 1e-3 * 200.0),
        (Motion { velocity_mm_per_s: 1.0, ..still }, 0.1),
        (Motion { own: [1.0, 0.0], ..still }, 1e-3),
        (Motion { fan_mm_per_s2: 1.0, ..still }, 0.0),
    ] {
        let slope = model.seen_along(&motion, Input::of(0.0), &along);
        assert!((slope - exact).abs() < 1e-12, "{along:?}: {slope}, exact {exact}");
    }
}

#[test]
fn a_force_of_time_is_integrated_with_its_time() {
    // ÿ = k·cos t from rest: y = k·(1 − cos t).
    let table = simple("air", "k * cos(t)");
    let model = Model { drag_per_s: 0.0, pipe_length_mm: 1e6, ..with("hum", &[80.0], Some(&table)) };
    let mut motion = model.at_rest(5e5, 0.0);
    for k in 0..200 {
        motion = motion.step(&model, Input { time_s: f64::from(k) * 0.01, ..Input::of(0.0) }, 0.01);
    }
    let exact = 5e5 + 80.0 * (1.0 - 2.0_f64.cos());
    assert!((motion.position_mm - exact).abs() < 1e-5, "{}, exact {exact}", motion.position_mm);
}

#[test]
fn a_formula_of_the_setpoint_takes_that_of_the_input_and_mid_pipe_where_none_is_known() {
    let rest = Motion::at_rest(100.0, 0.0);
    let model = Model { drag_per_s: 0.0, ..with("pull", &[2.0], Some(&simple("air", "k * (setpoint - x)"))) };
    for (setpoint_mm, pull) in [(Some(150.0), 100.0), (None, 2.0 * (291.5 - 100.0))] {
        let moved = rest.step(&model, Input { setpoint_mm, ..Input::of(0.0) }, 1e-4);
        let found = moved.velocity_mm_per_s / 1e-4;
        assert!((found - pull).abs() < 1e-3, "{setpoint_mm:?}: {found}, exact {pull}");
    }
    let fed = with("fed", &[0.01], Some(&simple("actuator", "k * (setpoint - 291.5)")));
    let mut actuator = crate::Actuator::new(&fed, fed.hover_duty_percent);
    let mut percent = |setpoint_mm| {
        actuator.set_setpoint(setpoint_mm);
        actuator.commanded(&fed, 0.0) / fed.gain_mm_per_s2_per_percent
    };
    // Unknown, then set, then as it was.
    for (setpoint_mm, exact) in [(None, 0.0), (Some(391.5), 1.0), (None, 1.0), (Some(191.5), -1.0)] {
        let found = percent(setpoint_mm);
        assert!((found - exact).abs() < 1e-9, "{setpoint_mm:?}: {found}, exact {exact}");
    }
}

#[test]
fn a_definition_says_where_it_depends_on_the_setpoint() {
    let said = |table: &DefinitionTable| Definition::new("mine", table).unwrap().without_setpoint("none here");
    assert_eq!(said(&simple("air", "k * x")), None);
    let DefinitionError { key, message } = said(&simple("air", "k * (x - setpoint)")).unwrap();
    let expected = "`k * (x - setpoint)`, column 10: `setpoint` is not known: none here";
    assert_eq!((key.as_str(), message.as_str()), ("adds", expected));
    let in_state = table(serde_json::json!({
        "stage": "air", "adds": "k * s", "states": { "s": { "rate": "x - s", "start": "setpoint" } },
        "parameters": { "k": { "neutral": 0.0, "low": 0.0, "high": 1.0 } },
    }));
    assert_eq!(said(&in_state).map(|error| error.key).as_deref(), Some("states.s.start"));
}

#[test]
fn linear_is_what_is_affine_in_everything_that_moves() {
    for (adds, linear) in
        [("-k * x", true), ("k * (x - 3 * v) + k", true), ("k * x * t", false), ("k * max(x, 0)", false)]
    {
        let model = with("of_mine", &[1.0], Some(&simple("air", adds)));
        assert_eq!(model.effects.motion_is_linear(), linear, "{adds}");
    }
}

#[test]
fn what_is_wrong_is_said_with_key_and_column() {
    let said = |table: &DefinitionTable| {
        let DefinitionError { key, message } = refused(table);
        format!("{key}: {message}")
    };
    for (adds, part) in [
        ("-k * (x - )", "adds: `-k * (x - )`, column 11"),
        ("-k * hight", "adds: `-k * hight`, column 6"),
        ("k / x", "column 3"),
        ("k * sqrt(x)", "column 5"),
        ("k * x + 1", "must give 0 there"),
        ("0 * x", "`k` occurs in no formula"),
    ] {
        assert!(said(&simple("air", adds)).contains(part), "{adds}: {}", said(&simple("air", adds)));
    }
    let unknown = said(&simple("actuator", "k * x"));
    assert!(
        unknown.contains("column 5: the stage actuator does not know `x`; there are u, duty, t, setpoint, k"),
        "{unknown}"
    );
    let unknown = said(&simple("sensor", "k * (x - setpoint)"));
    assert!(unknown.contains("column 10: the stage sensor does not know `setpoint`; there are x, v, u"), "{unknown}");
    assert!(
        said(&simple("air", "k\t* (x\u{1b}[2J")).contains("`k\\t* (x\\u{1b}[2J`, column 7"),
        "{}",
        said(&simple("air", "k\t* (x\u{1b}[2J"))
    );
    let long = said(&simple("air", &"k+".repeat(2000)));
    assert!(long.len() < 700 && long.contains("k+…`, column"), "{long}");
    let parameter =
        |k: serde_json::Value| table(serde_json::json!({"stage": "air", "adds": "k*x", "parameters": {"k": k}}));
    for (k, part) in [
        (serde_json::json!({ "neutral": 0.0, "low": 1.0, "high": 2.0 }), "not within 1 to 2"),
        (serde_json::json!({ "neutral": 0.0, "value": 1.0, "low": 0.0, "high": 2.0 }), "not both"),
        (serde_json::json!({ "value": 1.0, "low": 0.0, "high": 2.0 }), "no parameter has a neutral value"),
        (serde_json::json!({ "neutral": 0.0, "low": 0.0, "high": 2.0, "scale": 9.0 }), "scale = 9"),
    ] {
        assert!(said(&parameter(k.clone())).contains(part), "{}", said(&parameter(k)));
    }
    assert!(Definition::new("dead_zone", &simple("air", "k*x")).unwrap_err().message.contains("catalogue"));
    assert!(Definition::new("Leak", &simple("air", "k*x")).unwrap_err().message.contains("no name"));
}

#[test]
fn a_state_that_explodes_gives_no_panic_and_numbers_that_show_it() {
    let wild = table(serde_json::json!({
        "stage": "air", "adds": "k * s", "states": { "s": { "rate": "1 + s^3" } },
        "parameters": { "k": { "neutral": 0.0, "low": 0.0, "high": 1.0 } },
    }));
    let flown = heights(&with("wild", &[1.0], Some(&wild)));
    assert!(flown.last().is_some_and(|last| !last.is_finite() || *last == 583.0 || *last == 0.0), "{flown:?}");
}

#[test]
fn equal_definitions_are_one_and_a_new_one_takes_the_place_of_the_old() {
    let (one, other) = (simple("air", "k * x"), simple("air", "k * v"));
    assert!(std::ptr::eq(Definition::new("mine", &one).unwrap(), Definition::new("mine", &one).unwrap()));
    let mut model = with("mine", &[1.0], Some(&one));
    model.effects.written.define(Definition::new("mine", &other).unwrap());
    assert_eq!((model.effects.values("mine"), model.effects.present().len()), (None, 0));
    assert_eq!(model.effects.entry("mine").map(|entry| entry.params[0].name), Some("k"));
}

#[test]
fn values_are_checked_against_their_bounds_and_written_to_a_config() {
    let mut model = with("mine", &[1.0], Some(&simple("air", "k * x")));
    assert_eq!(serde_json::to_value(&model.effects).unwrap(), serde_json::json!({ "mine": { "k": 1.0 } }));
    model.effects.set("mine", &[1e4]);
    assert_eq!(model.check().unwrap_err().0, "effects.mine");
    assert!(model.effects.remove("mine") && model.effects.present().is_empty());
    let still = Motion::at_rest(100.0, 0.0);
    assert_eq!(still.step(&model, Input::of(0.0), 0.01).position_mm, 100.0);
}
