//! Tests that every number of a config can be changed in flight, by name, within the bounds of its check.

use super::{Numbers, Parameter};
use crate::believed::Believed;
use crate::cascade::Cascade;
use crate::compensation::{Compensation, DeadZoneCorrection};
use crate::controller::{Controllers, OpenLoop};
use crate::dither::Dither;
use crate::feed_forward::FeedForward;
use crate::inputs::Source;
use crate::mpc::Mpc;
use crate::observer::{Gain, Observer, Tachometer};
use crate::pid::{AntiWindup, DerivativeOn, Pid};
use crate::predistortion::Predistortion;
use crate::schedule::Schedule;
use crate::state_feedback::{Integral, Lqg, StateFeedback};
use std::collections::BTreeSet;

/// A point of a straight curve.
fn point(number: u8) -> [f64; 2] {
    [8.6 + 0.2 * f64::from(number), 10.0 * (f64::from(number) - 64.0)]
}

/// Every table and key, each with a number of its own.
fn all() -> Numbers {
    let believed = Believed { gain_mm_per_s2_per_control: 827.2, drag_per_s: 3.896, fan_lag_s: Some(0.257) };
    Numbers {
        controllers: Controllers {
            pid: Some(Pid {
                rate_limit_per_s: Some(40.0),
                anti_windup: AntiWindup::BackCalculation { tracking_s: 2.0 },
                ..Pid::new(0.018, 15.0, 0.35, 10.0, DerivativeOn::Measurement)
            }),
            cascade: Some(Cascade {
                position_per_s: 1.5,
                fastest_mm_per_s: 250.0,
                velocity_s_per_mm: 0.006,
                ti_s: 4.0,
                velocity: Source::Observer,
            }),
            state_feedback: Some(StateFeedback {
                position_per_mm: 0.012,
                velocity_s_per_mm: 0.005,
                setpoint_per_mm: Some(0.013),
                velocity: Source::Filter,
                integral: Some(Integral::Added { ti_s: 30.0 }),
            }),
            lqg: Some(Lqg { position_per_mm: 0.019, velocity_s_per_mm: 0.0044, fan: 0.7 }),
            mpc: Some(Mpc { move_s: 0.06, position_mm: 20.0, velocity_mm_per_s: 200.0, control: 0.4 }),
            open_loop: Some(OpenLoop { control: 0.0 }),
            gain_schedule: Some(Schedule {
                height_mm: (0..16).map(|row| 30.0 * f64::from(row)).collect(),
                factor: (0..16).map(|row| 1.0 + 0.01 * f64::from(row)).collect(),
            }),
            feed_forward: Some(FeedForward { time_constant_s: 0.15 }),
            ..Controllers::default()
        },
        observer: Some(Observer {
            sensor_mm: 2.5,
            acceleration_psd_mm2_per_s3: 360.0,
            disturbance_psd_per_s: Some(1e-3),
            gate_sigma: 5.0,
            second_sensor_mm: Some(2.6),
            tachometer: Some(Tachometer { control: 0.2, psd_per_s: 1.0 }),
            gain: Gain::SteadyState,
            believed,
        }),
        compensation: Compensation {
            dead_zone: Some(DeadZoneCorrection { lower_percent: -0.3, upper_percent: 0.31 }),
            dither: Some(Dither { step_percent: 0.8, seed: 1 }),
            predistortion: Some(Predistortion { points: Some((0..128).map(point).collect()) }),
            ..Compensation::bare(21.4)
        },
    }
}

#[test]
fn every_number_has_a_name_of_its_own_bounds_that_hold_it_and_a_place_of_its_own() {
    let there = all();
    there.check().unwrap();
    let before = there.values();
    let names: BTreeSet<&str> = Parameter::ALL.iter().map(|parameter| parameter.name).collect();
    assert_eq!(names.len(), Parameter::ALL.len());
    for (k, parameter) in Parameter::ALL.iter().enumerate().filter(|(_, parameter)| parameter.words.is_empty()) {
        let value = before[k].unwrap_or_else(|| panic!("{} is absent", parameter.name));
        let (min, max) = parameter.bounds(&there).unwrap_or_else(|| panic!("{} has no bounds", parameter.name));
        assert!(min <= value && value <= max, "{}: {value} within {min} to {max}", parameter.name);
        let mut values = [None; super::COUNT];
        values[Parameter::named(parameter.name).unwrap()] = Some(min);
        let changed = there.with(&values).unwrap();
        // A single point at its bound makes no curve of a fan.
        if !parameter.name.starts_with("compensation.predistortion") {
            changed.check().unwrap();
        }
        for (other, (now, was)) in changed.values().into_iter().zip(before).enumerate() {
            assert_eq!(now, if other == k { Some(min) } else { was }, "{} moved {other}", parameter.name);
        }
        values[k] = Some(f64::NAN);
        assert!(there.with(&values).unwrap().check().is_err(), "{}", parameter.name);
    }
}

#[test]
fn what_is_absent_cannot_be_changed() {
    let bare = Numbers {
        controllers: Controllers::only_pid(Pid::new(0.01, 3.0, 0.3, 10.0, DerivativeOn::Measurement)),
        observer: None,
        compensation: Compensation::bare(21.4),
    };
    let there: std::vec::Vec<&str> =
        Parameter::ALL.iter().zip(bare.values()).filter_map(|(one, value)| value.map(|_| one.name)).collect();
    let of_pid = ["pid.kp_per_mm", "pid.ti_s", "pid.td_s", "pid.derivative_n", "pid.setpoint_weight"];
    let words =
        ["pid.derivative_on", "pid.anti_windup", "feed_forward", "compensation.dead_zone", "compensation.dither"];
    assert_eq!(there, [&of_pid[..], &["compensation.hover_duty_percent"], &words[..]].concat());
    let mut values = [None; super::COUNT];
    values[Parameter::named("observer.sensor_mm").unwrap()] = Some(3.0);
    assert_eq!(bare.with(&values), Err("observer.sensor_mm"));
}

#[test]
fn numbers_on_the_way_lie_between_and_an_infinite_one_is_there_at_once() {
    let from = all();
    let mut to = all();
    to.controllers.pid.as_mut().unwrap().kp_per_mm = 0.03;
    to.controllers.pid.as_mut().unwrap().ti_s = f64::INFINITY;
    let half = to.on_the_way(&from, 0.5).controllers.pid.unwrap();
    assert!((half.kp_per_mm - 0.024).abs() < 1e-12 && half.ti_s == f64::INFINITY && half.td_s == 0.35);
}

fn given(values: &[(&str, f64)]) -> super::Values {
    let mut all = [None; super::COUNT];
    values.iter().for_each(|(name, value)| all[Parameter::named(name).unwrap()] = Some(*value));
    all
}

#[test]
fn every_word_can_be_said_and_is_said_then_and_nothing_else_is_a_word() {
    let there = all();
    for parameter in Parameter::ALL.iter().filter(|parameter| !parameter.words.is_empty()) {
        let at = Parameter::named(parameter.name).unwrap();
        for word in parameter.words {
            let value = parameter.value_of(word).unwrap();
            let said = there.with(&given(&[(parameter.name, value)])).unwrap();
            assert_eq!(said.values()[at].and_then(|value| parameter.word(value)), Some(*word), "{}", parameter.name);
        }
        for nothing in [0.5, -1.0, 9.0, f64::NAN] {
            assert_eq!(there.with(&given(&[(parameter.name, nothing)])), Err(parameter.name));
        }
        assert_eq!(parameter.value_of("perhaps"), None);
    }
}

#[test]
fn a_switch_adds_its_table_with_the_numbers_that_come_along_and_asks_for_those_that_do_not() {
    let bare = Numbers {
        controllers: Controllers::only_pid(Pid::new(0.01, 3.0, 0.3, 10.0, DerivativeOn::Measurement)),
        observer: None,
        compensation: Compensation::bare(21.4),
    };
    let (table, error) = bare.with(&given(&[("compensation.dither", 1.0)])).unwrap().check().unwrap_err();
    assert_eq!((table, error.key), ("compensation", "dither.step_percent"));
    let with = bare.with(&given(&[("compensation.dither", 1.0), ("compensation.dither.step_percent", 0.8)])).unwrap();
    assert_eq!((with.check(), with.compensation.dither.unwrap().step_percent), (Ok(()), 0.8));
    let without = with.with(&given(&[("compensation.dither", 0.0)])).unwrap();
    assert_eq!(without, bare);
    // A correction of no dead zone is none, so that its switch needs nothing.
    assert_eq!(bare.with(&given(&[("compensation.dead_zone", 1.0)])).unwrap().check(), Ok(()));
    let step = Parameter::ALL[Parameter::named("compensation.dither.step_percent").unwrap()];
    assert_eq!((step.bounds(&bare), step.bounds_if_added(&bare)), (None, Some((0.01, 10.0))));
    let tracking = Parameter::ALL[Parameter::named("pid.anti_windup.back_calculation.tracking_s").unwrap()];
    assert!(tracking.bounds_if_added(&bare).is_some());
}

#[test]
fn a_correction_of_the_dead_zone_comes_and_goes_on_the_way() {
    let (with, mut without) = (all(), all());
    without.compensation.dead_zone = None;
    let lower = |numbers: &Numbers| numbers.compensation.dead_zone.unwrap().lower_percent;
    assert!((lower(&without.on_the_way(&with, 0.25)) + 0.225).abs() < 1e-12);
    assert!((lower(&with.on_the_way(&without, 0.25)) + 0.075).abs() < 1e-12);
}
