//! What a second sensor and a tachometer are worth to the observer.

use super::{OBSERVER, T, Truth, control};
use crate::believed::{Believed, State};
use crate::observer::{Estimator, Gain, Observer, Tachometer};

const GAINS: [Gain; 2] = [Gain::SteadyState, Gain::TimeVarying];
const TACHOMETER: Tachometer = Tachometer { control: 0.2, psd_per_s: 0.5 };

/// An estimator that has seen two sensors, and the fan, for long.
fn settled(set: Observer) -> Estimator {
    let mut estimator = Estimator::new(set, T).unwrap();
    estimator.update(250.0);
    for _ in 0..20_000 {
        estimator.predict(0.0, T);
        estimator.update(250.0);
        estimator.update_second(250.0);
        estimator.update_fan(0.0);
    }
    estimator.predict(0.0, T);
    estimator
}

/// The change of the estimate for an innovation of 1, by the first sensor, the second and the fan's speed.
fn moves(set: Observer) -> [State; 3] {
    let mut estimator = settled(set);
    let mut moved = |update: fn(&mut Estimator, &State)| {
        let before = estimator.filter.state;
        update(&mut estimator, &before);
        estimator.filter.state - before
    };
    [
        moved(|estimator, state| {
            estimator.update(state[0] + 1.0);
        }),
        moved(|estimator, state| {
            estimator.update_second(state[0] + 1.0);
        }),
        moved(|estimator, state| estimator.update_fan(state[2] + 1.0)),
    ]
}

#[test]
fn the_steady_gains_are_those_to_which_the_time_varying_filter_converges() {
    for disturbance_psd_per_s in [None, Some(1e-3)] {
        let both = Observer {
            disturbance_psd_per_s,
            second_sensor_mm: Some(4.0),
            tachometer: Some(TACHOMETER),
            gate_sigma: f64::INFINITY,
            ..OBSERVER
        };
        let [steady, varying] = GAINS.map(|gain| moves(Observer { gain, ..both }));
        for (steady, varying) in steady.iter().zip(varying) {
            assert!((steady - varying).norm() < 1e-9, "{steady} {varying}");
        }
    }
}

#[test]
fn two_equal_sensors_are_worth_one_whose_deviation_is_smaller_by_the_root_of_two() {
    let one = Observer { disturbance_psd_per_s: Some(1e-3), ..OBSERVER };
    let better = Observer { sensor_mm: one.sensor_mm / 2.0_f64.sqrt(), ..one };
    let [first, second, _] = moves(Observer { second_sensor_mm: Some(one.sensor_mm), ..one });
    let together = first + second * (1.0 - first[0]);
    assert!((together - better.steady_gain(T).unwrap()).norm() < 1e-9, "{together}");
}

/// The rms error of position, mm, and of the fan, control value, on a rig whose fan is three times as slow as believed.
fn errors(set: Observer) -> (f64, f64) {
    let slow = Believed { fan_lag_s: Some(3.0 * 0.257), ..set.believed };
    let mut truth = Truth::new(0.0);
    let mut estimator = Estimator::new(set, T).unwrap();
    let (mut x, mut fan) = (0.0, 0.0);
    for k in 0..4000 {
        // Held near its place, as a controller would.
        let control = 10.0 * control(k) - 2e-3 * (truth.state[0] - 250.0) - 1e-3 * truth.state[1];
        let reading = truth.step(&slow, control, T);
        estimator.predict(control, T);
        estimator.update(reading);
        estimator.update_second(truth.state[0] + 2.5 * truth.normal());
        estimator.update_fan(truth.state[2] + 0.05 * truth.normal());
        if k > 200 {
            let now = estimator.estimate().unwrap();
            x += (now.position_mm - truth.state[0]).powi(2);
            fan += (now.fan - truth.state[2]).powi(2);
        }
    }
    ((x / 3799.0_f64).sqrt(), (fan / 3799.0_f64).sqrt())
}

#[test]
fn a_fan_that_is_slower_than_believed_is_followed_by_its_speed() {
    for gain in GAINS {
        let blind = Observer { gain, ..OBSERVER };
        let tachometer = Some(Tachometer { control: 0.05, psd_per_s: 1.0 });
        let seeing = Observer { tachometer, ..blind };
        let ((_, blind), (_, seen)) = (errors(blind), errors(seeing));
        assert!(seen < 0.06 && blind > 3.0 * seen, "{gain:?}: {seen}, blind {blind}");
    }
}

#[test]
fn a_second_sensor_makes_the_position_better() {
    for gain in GAINS {
        let tachometer = Some(Tachometer { control: 0.05, psd_per_s: 1.0 });
        let alone = Observer { gain, tachometer, ..OBSERVER };
        // Without its deviation it is taken for the first; here it is left out by a deviation of a metre.
        let (one, _) = errors(Observer { second_sensor_mm: Some(1000.0), ..alone });
        let (two, _) = errors(Observer { second_sensor_mm: Some(2.5), ..alone });
        assert!(two < 0.85 * one, "{gain:?}: {two} mm with it, {one} mm without");
    }
}

#[test]
fn a_speed_says_nothing_where_the_fan_is_no_state() {
    let at_once = Observer { believed: Believed { fan_lag_s: None, ..OBSERVER.believed }, ..OBSERVER };
    let mut estimator = settled(Observer { tachometer: Some(TACHOMETER), ..at_once });
    let before = estimator.estimate();
    estimator.update_fan(5.0);
    assert_eq!(estimator.estimate(), before);
}

#[test]
fn while_one_sensor_agrees_the_outliers_of_the_other_do_not_move_the_estimate() {
    for gain in GAINS {
        let mut estimator = settled(Observer { gain, second_sensor_mm: Some(2.5), ..OBSERVER });
        for _ in 0..50 {
            assert!(estimator.update(400.0).unwrap().test_ratio > 1.0);
            estimator.update_second(250.0);
            estimator.predict(0.0, T);
        }
        let now = estimator.estimate().unwrap().position_mm;
        assert!((now - 250.0).abs() < 1.0, "{gain:?}: {now} mm");
    }
}

#[test]
fn signals_from_worthless_to_perfect_leave_steady_gains() {
    for sigma in [1e-3, 1.0, 1e3] {
        for psd_per_s in [1e-9, 1e-3, 1e6] {
            for control in [1e-3, 1.0, 1e3] {
                for disturbance_psd_per_s in [None, Some(1e-6), Some(1e-3), Some(1e3)] {
                    let tachometer = Some(Tachometer { control, psd_per_s });
                    let set = Observer { second_sensor_mm: Some(sigma), tachometer, disturbance_psd_per_s, ..OBSERVER };
                    assert_eq!(set.check(), Ok(()));
                    let found = Estimator::new(set, T);
                    assert!(found.is_ok(), "{set:?}: {found:?}");
                }
            }
        }
    }
}
