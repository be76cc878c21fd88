//! A start while the ball moves.

use super::{Estimator, Gain, OBSERVER, T, Truth, control};
use crate::observer::Observer;
use nalgebra::vector;

const SETS: [Observer; 3] = [
    OBSERVER,
    Observer { disturbance_psd_per_s: Some(1e-3), ..OBSERVER },
    Observer { gain: Gain::TimeVarying, ..OBSERVER },
];

/// The readings that are refused, and the errors of position and velocity 0.3 s after the start and later, at most.
fn refusals_and_errors(set: Observer, speed: f64, seed: u32) -> (u32, f64, f64) {
    let mut truth = Truth::new(0.0);
    truth.random = rand_pcg::Pcg32::new(u64::from(seed), 11);
    truth.state = vector![500.0, speed, 0.0, 0.0];
    let mut estimator = Estimator::new(set, T).unwrap();
    let (mut refused, mut x, mut v) = (0, 0.0_f64, 0.0_f64);
    for k in 0..100 {
        let reading = truth.step(&set.believed, control(k), T);
        if k == 50 {
            // Out of sight and thrown: the ball comes back in another place with another velocity.
            truth.state = vector![300.0, -speed, truth.state[2], 0.0];
            estimator.lose_sight();
            continue;
        }
        estimator.predict(control(k), T);
        refused += u32::from(estimator.update(reading).is_some_and(|innovation| innovation.test_ratio > 1.0));
        let now = estimator.estimate().unwrap();
        if k % 50 >= 15 {
            x = x.max((now.position_mm - truth.state[0]).abs());
            v = v.max((now.velocity_mm_per_s - truth.state[1]).abs());
        }
    }
    (refused, x, v)
}

#[test]
fn a_ball_that_moves_at_the_start_is_followed_at_once_and_known_after_three_tenths_of_a_second() {
    for set in SETS {
        for seed in 0..40 {
            let speed = 40.0 * f64::from(seed) - 800.0;
            let (refused, x, v) = refusals_and_errors(set, speed, seed);
            assert!(refused == 0 && x < 12.0 && v < 90.0, "{speed} mm/s: {refused} refused, off by {x} mm, {v} mm/s");
        }
    }
}

#[test]
fn a_ball_that_lies_at_the_bottom_is_at_rest_and_the_steady_gain_goes_on() {
    let start = |reading: f64| {
        let mut estimator = Estimator::new(OBSERVER, T).unwrap();
        estimator.update(reading);
        estimator.converging
    };
    assert!(!start(3.0) && start(100.0));
}

#[test]
fn the_steady_gain_takes_over_once_the_estimate_has_converged() {
    let mut truth = Truth::new(0.0);
    let mut estimator = Estimator::new(OBSERVER, T).unwrap();
    let mut last = 0;
    for k in 0..200 {
        let reading = truth.step(&OBSERVER.believed, control(k), T);
        estimator.predict(control(k), T);
        estimator.update(reading);
        if estimator.converging {
            last = k;
        }
    }
    assert!(last < 50, "converged after {last} readings");
}
