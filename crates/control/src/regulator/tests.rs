//! Tests of `regulator.rs`: every controller flies the believed plant, none gives invalid output, and changes are
//! bumpless.

use super::{Kind, Limits, Regulator, Unready};
use crate::believed::{State, tests::G_C};
use crate::cascade::Cascade;
use crate::controller::{Controllers, OpenLoop};
use crate::feed_forward::FeedForward;
use crate::inputs::Source;
use crate::mpc::Mpc;
use crate::observer::{Gain, Observer};
use crate::pid::{AntiWindup, DerivativeOn, Pid};
use crate::schedule::Schedule;
use crate::state_feedback::{Integral, Lqg, StateFeedback};
use nalgebra::vector;
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

const T: f64 = 0.02;
const LIMITS: Limits = Limits { lower: -11.4, upper: 18.6 };
/// One step of the original rig's fan, percent.
const FAN_STEP: f64 = 0.8;

fn observer() -> Observer {
    Observer {
        believed: G_C,
        sensor_mm: 2.5,
        acceleration_psd_mm2_per_s3: 360.0,
        disturbance_psd_per_s: Some(1e-3),
        gate_sigma: 5.0,
        second_sensor_mm: None,
        tachometer: None,
        gain: Gain::SteadyState,
    }
}

/// One controller of each kind, for the thesis' three-pole model.
fn all() -> Controllers {
    Controllers {
        pid: Some(Pid::new(0.012, 6.0, 0.45, 10.0, DerivativeOn::Measurement)),
        cascade: Some(Cascade {
            position_per_s: 1.5,
            fastest_mm_per_s: 300.0,
            velocity_s_per_mm: 0.006,
            ti_s: 2.0,
            velocity: Source::Observer,
        }),
        state_feedback: Some(StateFeedback {
            position_per_mm: 0.012,
            velocity_s_per_mm: 0.005,
            setpoint_per_mm: None,
            integral: Some(Integral::Added { ti_s: 4.0 }),
            velocity: Source::Filter,
        }),
        lqg: Some(Lqg { position_per_mm: 0.02, velocity_s_per_mm: 0.006, fan: 0.5 }),
        mpc: Some(Mpc { move_s: 0.06, position_mm: 20.0, velocity_mm_per_s: 200.0, control: 0.5 }),
        open_loop: Some(OpenLoop { control: 0.0 }),
        ..Controllers::default()
    }
}

fn regulator(controllers: Controllers) -> Regulator {
    Regulator::new(controllers, Some(&observer()), T).unwrap()
}

/// The plant as believed, with hover off by `disturbance`, flown for `seconds`; the control values.
fn fly(regulator: &mut Regulator, state: &mut State, setpoint_mm: f64, seconds: f64) -> Vec<f64> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand")]
    let steps = (seconds / T) as usize;
    (0..steps)
        .map(|_| {
            regulator.read(state[0], T);
            let control = regulator.step(setpoint_mm, T, LIMITS);
            *state = G_C.over(T).apply(state, control);
            regulator.pass(control, T);
            control
        })
        .collect()
}

fn only(kind: Kind) -> Regulator {
    regulator(Controllers { active: Some(kind), ..all() })
}

/// Every kind that is fed back, and both integrals of state feedback.
fn fed_back() -> Vec<(&'static str, Regulator)> {
    let mut flown: Vec<(&str, Regulator)> = Kind::ALL.map(|kind| (kind.name(), only(kind))).to_vec();
    flown.retain(|(name, _)| *name != "open_loop");
    let in_place = StateFeedback { integral: Some(Integral::InPlace { ti_s: 1.0 }), ..all().state_feedback.unwrap() };
    let set = Controllers { active: Some(Kind::StateFeedback), state_feedback: Some(in_place), ..all() };
    flown.push(("in_place", regulator(set)));
    flown
}

#[test]
fn every_controller_settles_without_an_error_where_hover_is_not_what_was_believed() {
    for (name, mut regulator) in fed_back() {
        let mut state = vector![200.0, 0.0, 0.0, 0.3];
        fly(&mut regulator, &mut state, 300.0, 40.0);
        assert!((state[0] - 300.0).abs() < 0.5 && state[1].abs() < 0.5, "{name}: {state}");
    }
}

#[test]
fn without_an_integral_the_error_at_rest_is_what_the_gain_leaves() {
    let law = StateFeedback { integral: None, ..all().state_feedback.unwrap() };
    let set = Controllers { active: Some(Kind::StateFeedback), state_feedback: Some(law), ..all() };
    let mut state = vector![300.0, 0.0, 0.0, 0.3];
    fly(&mut regulator(set), &mut state, 300.0, 40.0);
    // At rest k₁·e = −d.
    assert!((state[0] - 300.0 - 0.3 / 0.012).abs() < 0.01, "{state}");
}

#[test]
fn a_schedule_over_height_changes_the_gain_and_not_the_rest() {
    let rows = Schedule { height_mm: [100.0, 500.0].into_iter().collect(), factor: [0.8, 1.4].into_iter().collect() };
    for (name, kind) in Kind::ALL.map(|kind| (kind.name(), kind)) {
        if matches!(kind, Kind::OpenLoop | Kind::Mpc) {
            continue;
        }
        let set = Controllers { active: Some(kind), gain_schedule: Some(rows.clone()), ..all() };
        let mut regulator = regulator(set);
        let mut state = vector![200.0, 0.0, 0.0, 0.3];
        fly(&mut regulator, &mut state, 400.0, 40.0);
        assert!((state[0] - 400.0).abs() < 0.5, "{name}: {state}");
    }
    let control = |schedule: Option<Schedule>| {
        let p = Pid::new(0.01, f64::INFINITY, 0.0, 10.0, DerivativeOn::Measurement);
        let mut regulator = regulator(Controllers { pid: Some(p), gain_schedule: schedule, ..Controllers::default() });
        regulator.read(300.0, T);
        regulator.step(320.0, T, LIMITS)
    };
    // Half way between the rows the factor is 1.1.
    assert!((control(Some(rows)) / control(None) - 1.1).abs() < 1e-12);
}

#[test]
fn with_feed_forward_a_jump_is_flown_along_its_way() {
    let smooth = FeedForward { time_constant_s: 0.3 };
    for kind in [Kind::Lqg, Kind::StateFeedback, Kind::Cascade, Kind::Mpc] {
        let set = Controllers { active: Some(kind), feed_forward: Some(smooth), ..all() };
        let mut regulator = regulator(set);
        let mut state = vector![200.0, 0.0, 0.0, 0.0];
        fly(&mut regulator, &mut state, 200.0, 5.0);
        let mut worst: f64 = 0.0;
        for k in 1..=200_u32 {
            fly(&mut regulator, &mut state, 300.0, T * 1.01);
            let z = T * f64::from(k) / 0.3;
            let way = 300.0 - 100.0 * libm::exp(-z) * (1.0 + z + z * z / 2.0);
            worst = worst.max((state[0] - way).abs());
        }
        // The way is flown a period late, and the derivative filter's velocity by another; its fastest is 90 mm/s.
        assert!(worst < 10.0, "{}: {worst} mm off the way", kind.name());
    }
}

#[test]
fn a_switch_at_rest_moves_the_duty_by_less_than_a_step_of_the_fan_and_the_ball_hardly() {
    for from in Kind::ALL {
        for to in Kind::ALL {
            if from == to {
                continue;
            }
            let mut regulator = only(from);
            // Open loop is at rest only where hover is what was believed.
            let lacks = if from == Kind::OpenLoop { 0.0 } else { 0.3 };
            let mut state = vector![300.0, 0.0, 0.0, lacks];
            let before = *fly(&mut regulator, &mut state, 300.0, 60.0).last().unwrap();
            assert!(regulator.switch(to));
            let after = fly(&mut regulator, &mut state, 300.0, 0.1);
            let moved = after.iter().map(|control| (control - before).abs()).fold(0.0, f64::max);
            assert!(moved < 0.1 * FAN_STEP, "{} to {}: {moved} %", from.name(), to.name());
            if to != Kind::OpenLoop {
                fly(&mut regulator, &mut state, 300.0, 30.0);
                assert!((state[0] - 300.0).abs() < 1.0, "{} to {}: {state}", from.name(), to.name());
            }
        }
    }
}

#[test]
fn the_observers_controllers_fly_on_through_missing_readings() {
    for kind in [Kind::Lqg, Kind::Mpc] {
        let mut regulator = only(kind);
        let mut state = vector![300.0, 0.0, 0.0, 0.0];
        fly(&mut regulator, &mut state, 300.0, 10.0);
        for k in 0..500 {
            if k % 3 == 0 {
                regulator.read(state[0], 3.0 * T);
            }
            let control = regulator.step(if k < 50 { 300.0 } else { 400.0 }, T, LIMITS);
            state = G_C.over(T).apply(&state, control);
            regulator.pass(control, T);
        }
        assert!((state[0] - 400.0).abs() < 1.0, "{}: {state}", kind.name());
    }
}

#[test]
fn a_controller_that_is_not_there_is_not_switched_to_and_one_without_an_observer_not_made() {
    let mut pid_only = regulator(Controllers::only_pid(all().pid.unwrap()));
    assert!(!pid_only.switch(Kind::Mpc));
    assert_eq!(pid_only.kind(), Kind::Pid);
    let refused = |set, observer: Option<&Observer>| Regulator::new(set, observer, T).unwrap_err();
    assert_eq!(refused(all(), None), Unready::NoObserver { needed_by: "lqg" });
    assert_eq!(refused(Controllers::default(), Some(&observer())), Unready::NoController);
}

/// What can come in: any number, or none.
fn anything() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..600.0_f64,
        1 => proptest::num::f64::ANY,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -f64::MAX]),
    ]
}

proptest! {
    #[test]
    fn no_controller_ever_gives_anything_but_a_number_within_its_limits(
        kinds in prop::collection::vec(prop::sample::select(Kind::ALL.to_vec()), 1..6),
        cycles in prop::collection::vec((anything(), prop::option::of(anything()), anything()), 1..80),
        (lower, upper) in (-30.0..0.0_f64, 0.0..80.0_f64),
        (gain, forward, windup, in_place, scheduled) in any::<(bool, bool, bool, bool, bool)>(),
    ) {
        let gain = if gain { Gain::SteadyState } else { Gain::TimeVarying };
        let anti_windup = if windup { AntiWindup::BackCalculation { tracking_s: 0.5 } } else { AntiWindup::Clamping };
        let pid = Pid { anti_windup, rate_limit_per_s: windup.then_some(20.0), derivative_on: DerivativeOn::Error, ..all().pid.unwrap() };
        let feed_forward = forward.then_some(FeedForward { time_constant_s: 0.2 });
        let integral = Some(if in_place { Integral::InPlace { ti_s: 1.0 } } else { Integral::Added { ti_s: 4.0 } });
        let state_feedback = Some(StateFeedback { integral, ..all().state_feedback.unwrap() });
        let rows = || Schedule { height_mm: [100.0, 500.0].into_iter().collect(), factor: [0.8, 1.4].into_iter().collect() };
        let gain_schedule = scheduled.then(rows);
        let set = Controllers { pid: Some(pid), state_feedback, gain_schedule, feed_forward, ..all() };
        let mut regulator = Regulator::new(set, Some(&Observer { gain, ..observer() }), T).unwrap();
        let limits = Limits { lower, upper };
        for (k, (setpoint, reading, dt)) in cycles.into_iter().enumerate() {
            regulator.switch(kinds[k / 8 % kinds.len()]);
            regulator.pass(setpoint, dt);
            if let Some(reading) = reading {
                regulator.read(reading, dt);
            }
            let control = regulator.step(setpoint, dt, limits);
            prop_assert!((lower..=upper).contains(&control), "{control}");
        }
        // And it has not forgotten how to fly: the estimate is finite after sensible readings.
        for _ in 0..20 {
            regulator.read(300.0, T);
            let control = regulator.step(300.0, T, limits);
            regulator.pass(control, T);
        }
        prop_assert!(regulator.observed().unwrap().velocity_mm_per_s.is_finite());
        prop_assert!(regulator.velocity_mm_per_s().unwrap().is_finite());
    }
}

#[test]
fn a_second_sensor_of_which_nothing_is_known_stands_in_like_the_first_and_says_nothing_beside_it() {
    let mut first = Regulator::new(all(), Some(&observer()), T).unwrap();
    let mut second = first.clone();
    for position_mm in [250.0, 252.0, 255.0, f64::NAN, 259.0] {
        first.pass(0.1, T);
        second.pass(0.1, T);
        first.read(position_mm, T);
        second.stand_in(position_mm, T);
    }
    assert_eq!((first.observed(), first.innovation()), (second.observed(), second.innovation()));
    first.read_second(400.0);
    assert_eq!(first.observed(), second.observed());
}
