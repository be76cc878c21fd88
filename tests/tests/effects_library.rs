//! Effects of the shipped library are named first on rigs that this file draws by equations of its own.

use serde_json::Value;
use std::f64::consts::TAU;
use system_tests::Bench;

/// The rig of the config file: gain in mm/s² per percent, drag in 1/s, hover in percent, the fan's lag in s.
const GAIN: f64 = 827.2;
const DRAG: f64 = 3.896;
const HOVER: f64 = 21.4;
const LAG_S: f64 = 0.257;
/// Integration step, s, and steps from one reading to the next.
const STEP_S: f64 = 0.001;
const STEPS: usize = 20;
/// Noise of a reading, mm, and the density of the air's noise, mm²/s³.
const SENSOR_MM: f64 = 2.5;
const AIR: f64 = 360.0;

/// The state of a rig: time, height, speed, the fan's force, and two states of an effect.
#[derive(Clone, Copy, Default)]
struct State {
    t: f64,
    x: f64,
    v: f64,
    fan: f64,
    own: [f64; 2],
}

/// What a rig does otherwise than its config says: it may move its own states, and gives the mm/s² that it adds to the
/// ball and the mm that it adds to the reading.
type Act = fn(&mut State) -> (f64, f64);

/// Normal numbers: twelve uniform ones of a linear congruential generator (Knuth's MMIX), summed.
struct NormalNumbers(u64);

impl NormalNumbers {
    fn normal(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// A record of 60 s: a controller leads the ball through five heights while four sines shake the duty.
fn flown(act: Act) -> String {
    let mut state = State { x: 250.0, ..State::default() };
    let (mut normals, mut last) = (NormalNumbers(7), 250.0);
    let mut rows = String::from("time_s,setpoint_mm,duty_percent,position_mm\n");
    for row in 0..3000 {
        let reading = state.x + act(&mut state.clone()).1 + SENSOR_MM * normals.normal();
        let setpoint = [250.0, 420.0, 150.0, 480.0, 330.0][row / 200 % 5];
        let shake: f64 = [0.41, 0.83, 1.37, 2.3].iter().map(|hz| (TAU * hz * state.t).sin()).sum();
        let wanted = 0.010 * (setpoint - reading) - 0.0045 * (reading - last) / 0.02;
        last = reading;
        let duty = HOVER + (wanted + 0.25 * shake).clamp(-8.0, 8.0);
        rows += &format!("{:.3},{setpoint},{duty:.4},{reading:.2}\n", state.t);
        for _ in 0..STEPS {
            state.fan += (GAIN * (duty - HOVER) - state.fan) * STEP_S / LAG_S;
            let force = state.fan - DRAG * state.v + act(&mut state).0;
            state.v += force * STEP_S + (AIR * STEP_S).sqrt() * normals.normal();
            state.x += state.v * STEP_S;
            state.t += STEP_S;
        }
    }
    rows
}

/// The answer for a rig, with the library.
fn diagnosed(act: Act) -> Value {
    let bench = Bench::default();
    bench.write("flight.csv", flown(act));
    bench.write("effects.toml", bench.output(&["config", "effects"]));
    let said = bench.output(&["diagnose", "--json", "flight.csv", "--effects", "effects.toml"]);
    serde_json::from_str(&said).unwrap()
}

/// Whether an effect is named first, and these of its values are within their intervals.
fn is_named_first(act: Act, name: &str, truths: &[(&str, f64)]) {
    let found = diagnosed(act);
    let first = &found["effects"][0];
    assert_eq!((&first["name"], &first["change"]), (&name.into(), &"added".into()), "{found}");
    for (key, truth) in truths {
        let value = first["parameters"][key]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.3, "{key}: {value}, in truth {truth}");
    }
}

#[test]
fn a_rig_as_believed_has_no_effect_of_the_library() {
    let found = diagnosed(|_| (0.0, 0.0));
    assert_eq!(found["effects"].as_array().unwrap().len(), 0, "{found}");
}

#[test]
fn a_periodic_force_far_from_its_usual_frequency_is_named() {
    let act: Act = |now| (200.0 * (TAU * 1.13 * now.t + 0.9).sin(), 0.0);
    is_named_first(act, "periodic_force", &[("frequency", 1.13)]);
}

#[test]
fn friction_that_differs_by_direction_is_named() {
    let act: Act = |now| (if now.v > 0.0 { -1.2 * now.v } else { 1.2 * now.v }, 0.0);
    is_named_first(act, "friction_by_direction", &[("k", 1.2)]);
}

#[test]
fn a_resonance_that_the_fans_force_drives_is_named() {
    let act: Act = |now| {
        let (omega, damping) = (TAU * 1.9, 0.15);
        let [p, q] = &mut now.own;
        *q += STEP_S * (omega * omega * (now.fan - *p) - 2.0 * damping * omega * *q);
        *p += STEP_S * *q;
        (0.6 * (*p - now.fan), 0.0)
    };
    is_named_first(act, "resonance", &[("share", 0.6), ("frequency", 1.9)]);
}

#[test]
fn a_sensor_whose_scale_bends_with_height_is_named() {
    let act: Act = |now| (0.0, 9.0 * ((now.x - 300.0) / 100.0).powi(2));
    is_named_first(act, "bent_scale", &[("k", 9.0)]);
}

#[test]
fn backlash_before_what_is_measured_is_named() {
    let act: Act = |now| {
        let measured = &mut now.own[0];
        *measured = measured.clamp(now.x - 8.0, now.x + 8.0);
        (0.0, *measured - now.x)
    };
    is_named_first(act, "backlash", &[("half", 8.0)]);
}

#[test]
fn a_leak_above_one_height_is_named() {
    let act: Act = |now| (if now.x > 280.0 { -4.0 * (now.x - 280.0) } else { 0.0 }, 0.0);
    is_named_first(act, "leak", &[("k", 4.0), ("start", 280.0)]);
}

#[test]
fn a_force_that_sets_in_at_a_moment_is_named() {
    let act: Act = |now| (if now.t < 23.7 { 0.0 } else { -160.0 }, 0.0);
    is_named_first(act, "force_onset", &[("force", -160.0), ("start", 23.7)]);
}

#[test]
fn friction_that_drops_with_speed_is_named() {
    let act: Act = |now| (-250.0 * (now.v / 6.0).clamp(-1.0, 1.0) / (1.0 + (now.v / 80.0).powi(4)), 0.0);
    is_named_first(act, "stribeck_friction", &[("k", 250.0)]);
}

#[test]
fn a_second_lag_of_the_fan_is_named() {
    let act: Act = |now| {
        now.own[0] += (now.fan - now.own[0]) * STEP_S / 0.45;
        (0.6 * (now.own[0] - now.fan), 0.0)
    };
    is_named_first(act, "second_lag", &[("share", 0.6), ("tau", 0.45)]);
}

#[test]
fn a_gain_that_falls_with_height_is_named() {
    let act: Act = |now| (now.fan * (0.3 - 0.001 * now.x), 0.0);
    is_named_first(act, "gain_by_height", &[("k", 0.1)]);
}

#[test]
fn a_supply_that_gives_way_under_load_is_named() {
    let act: Act = |now| {
        now.own[0] += (now.fan - now.own[0]) * STEP_S / 3.0;
        (-0.4 * now.own[0], 0.0)
    };
    is_named_first(act, "supply_sag", &[("share", 0.4), ("tau", 3.0)]);
}
