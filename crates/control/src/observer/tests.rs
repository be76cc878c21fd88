//! What `observer.rs` promises.

mod converging;
mod signals;

use super::{Estimator, Gain, Observer};
use crate::believed::tests::G_C;
use crate::believed::{Believed, State};
use nalgebra::vector;
use rand_core::Rng;
use rand_pcg::Pcg32;

const T: f64 = 0.02;
const OBSERVER: Observer = Observer {
    believed: G_C,
    sensor_mm: 2.5,
    acceleration_psd_mm2_per_s3: 360.0,
    disturbance_psd_per_s: None,
    gate_sigma: 5.0,
    second_sensor_mm: None,
    tachometer: None,
    gain: Gain::SteadyState,
};

/// The believed plant itself, with seeded noise of the believed sizes, flown by a gentle square wave of the control
/// value.
struct Truth {
    state: State,
    random: Pcg32,
}

impl Truth {
    fn new(disturbance: f64) -> Self {
        Self { state: vector![250.0, 0.0, 0.0, disturbance], random: Pcg32::new(7, 11) }
    }

    /// A number of mean 0 and variance 1: the sum of twelve uniform ones.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| f64::from(self.random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0
    }

    fn step(&mut self, model: &Believed, control: f64, dt: f64) -> f64 {
        self.state = model.over(dt).apply(&self.state, control);
        self.state[1] += (360.0 * dt).sqrt() * self.normal();
        self.state[0] + 2.5 * self.normal()
    }
}

fn control(k: u32) -> f64 {
    if (k / 60).is_multiple_of(2) { 0.05 } else { -0.05 }
}

/// The rms of position and velocity errors and the mean test ratio, over 4,000 readings of which `missing` are lost.
fn errors(set: Observer, missing: impl Fn(u32) -> bool, jitter: f64) -> (f64, f64, f64) {
    let mut truth = Truth::new(0.0);
    let mut estimator = Estimator::new(set, T).unwrap();
    let (mut x, mut v, mut ratio, mut count) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..4000 {
        let dt = T * (1.0 + jitter * (f64::from(truth.random.next_u32()) / f64::from(u32::MAX) - 0.5));
        let reading = truth.step(&set.believed, control(k), dt);
        estimator.predict(control(k), dt);
        let innovation = if missing(k) { None } else { estimator.update(reading) };
        if k > 200 {
            let now = estimator.estimate().unwrap();
            x += (now.position_mm - truth.state[0]).powi(2);
            v += (now.velocity_mm_per_s - truth.state[1]).powi(2);
            if let Some(innovation) = innovation {
                ratio += innovation.test_ratio;
                count += 1.0;
            }
        }
    }
    ((x / 3799.0_f64).sqrt(), (v / 3799.0_f64).sqrt(), ratio / count)
}

#[test]
fn the_errors_are_those_that_the_riccati_equation_promises() {
    for gain in [Gain::SteadyState, Gain::TimeVarying] {
        let (x, v, ratio) = errors(Observer { gain, ..OBSERVER }, |_| false, 0.0);
        // P after an update is S − R times R/S in position.
        let mut filter = Estimator::new(Observer { gain: Gain::TimeVarying, ..OBSERVER }, T).unwrap();
        filter.update(250.0);
        for _ in 0..2000 {
            filter.predict(0.0, T);
            filter.update(250.0);
        }
        let promised = filter.filter.covariance.diagonal().map(f64::sqrt);
        assert!((x / promised[0] - 1.0).abs() < 0.1, "{gain:?}: {x} mm, promised {}", promised[0]);
        assert!((v / promised[1] - 1.0).abs() < 0.1, "{gain:?}: {v} mm/s, promised {}", promised[1]);
        // ν²/S has mean 1, so that a gate of 5 sigma leaves a mean of 1/25.
        assert!((ratio * 25.0 - 1.0).abs() < 0.1, "{gain:?}: mean test ratio {ratio}");
    }
}

#[test]
fn the_steady_gain_is_that_to_which_the_time_varying_filter_converges() {
    let at_once = Believed { fan_lag_s: None, ..G_C };
    for (disturbance_psd_per_s, believed) in [(Some(1e-3), G_C), (None, G_C), (Some(1e-3), at_once), (None, at_once)] {
        let set = Observer { gain: Gain::TimeVarying, disturbance_psd_per_s, believed, ..OBSERVER };
        let mut filter = Estimator::new(set, T).unwrap();
        filter.update(250.0);
        for _ in 0..20_000 {
            filter.predict(0.0, T);
            filter.update(250.0);
        }
        filter.predict(0.0, T);
        let before = filter.filter.state;
        filter.update(before[0] + 1.0);
        let (moved, steady) = (filter.filter.state - before, set.steady_gain(T).unwrap());
        assert!((moved - steady).norm() < 1e-9, "{moved} {steady}");
        assert_eq!(steady[3] == 0.0, disturbance_psd_per_s.is_none(), "a known hover is not corrected");
    }
}

#[test]
fn a_filter_that_turns_to_time_varying_gains_goes_on_from_where_the_steady_one_was() {
    let mut filter = Estimator::new(OBSERVER, T).unwrap();
    filter.update(250.0);
    for _ in 0..200 {
        filter.predict(0.0, T);
        filter.update(250.0);
    }
    let mut varying = filter.with(Observer { gain: Gain::TimeVarying, ..OBSERVER }).unwrap();
    let [steady, varying] = [&mut filter, &mut varying].map(|filter| {
        filter.predict(0.0, T);
        filter.update(252.0);
        filter.filter.state
    });
    assert!((steady - varying).norm() < 1e-6, "{steady} {varying}");
}

#[test]
fn whatever_the_config_allows_has_a_steady_gain() {
    let ends = |low: f64, high: f64| [low, (low * high).sqrt(), high];
    for drag_per_s in [0.0, 3.9, 1e3] {
        for fan_lag_s in [None, Some(1e-3), Some(0.257), Some(10.0)] {
            for sensor_mm in ends(1e-3, 1e3) {
                for acceleration_psd_mm2_per_s3 in ends(1e-6, 1e9) {
                    for disturbance_psd_per_s in [None, Some(1e-12), Some(1e-3), Some(1e9)] {
                        let believed = Believed { drag_per_s, fan_lag_s, ..G_C };
                        let set = Observer {
                            believed,
                            sensor_mm,
                            acceleration_psd_mm2_per_s3,
                            disturbance_psd_per_s,
                            ..OBSERVER
                        };
                        let found = set.steady_gain(T);
                        let sound = found.is_ok_and(|l| (0.0..=1.0).contains(&l[0]) && l.iter().all(|l| l.is_finite()));
                        assert!(sound, "{set:?}: {found:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn in_fast_sampling_the_gain_is_that_of_the_continuous_filter() {
    // A ball without drag under white acceleration: K = [√(2·ω₀), ω₀], ω₀ = √(q/R_c), R_c = R·T the density of the
    // readings' noise.
    let free = Believed { drag_per_s: 0.0, fan_lag_s: None, ..G_C };
    let period_s: f64 = 1e-4;
    let filter = Observer { believed: free, ..OBSERVER };
    let omega = (360.0 / (2.5 * 2.5 * period_s)).sqrt();
    let got = filter.steady_gain(period_s).unwrap() / period_s;
    assert!((got[1] / omega - 1.0).abs() < 0.05, "{got}, exact {omega}");
    assert!((got[0] / (2.0 * omega).sqrt() - 1.0).abs() < 0.05, "{got}, exact {}", (2.0 * omega).sqrt());
}

#[test]
fn it_works_through_missing_readings_and_irregular_cycles() {
    let every_third_of_two = |k: u32| k.is_multiple_of(3) || (k / 100).is_multiple_of(10) && k % 100 < 10;
    for gain in [Gain::SteadyState, Gain::TimeVarying] {
        let (x, v, ratio) = errors(Observer { gain, ..OBSERVER }, every_third_of_two, 0.8);
        assert!(x < 2.0 && v < 30.0 && ratio < 2.0 / 25.0, "{gain:?}: {x} mm, {v} mm/s, ratio {ratio}");
    }
}

#[test]
fn a_disturbance_is_found_and_the_fan_is_not_taken_for_one() {
    let set = Observer { disturbance_psd_per_s: Some(1e-3), ..OBSERVER };
    let mut truth = Truth::new(0.3);
    let mut estimator = Estimator::new(set, T).unwrap();
    let mut sum = 0.0;
    for k in 0..3000 {
        // Held near its place, as a controller would.
        let control = control(k) - 0.3 - 2e-3 * (truth.state[0] - 250.0) - 1e-3 * truth.state[1];
        let reading = truth.step(&set.believed, control, T);
        estimator.predict(control, T);
        estimator.update(reading);
        if k >= 1000 {
            sum += estimator.estimate().unwrap().disturbance;
        }
        let fan = estimator.estimate().unwrap().fan;
        assert!((fan - truth.state[2]).abs() < 1e-9, "{fan} or {}", truth.state[2]);
    }
    assert!((sum / 2000.0 - 0.3).abs() < 0.03, "{}", sum / 2000.0);
}

#[test]
fn an_outlier_is_refused_and_leaves_no_trace_but_a_moved_ball_is_believed_in_the_end() {
    for gain in [Gain::SteadyState, Gain::TimeVarying] {
        let mut estimator = Estimator::new(Observer { gain, ..OBSERVER }, T).unwrap();
        for _ in 0..200 {
            estimator.predict(0.0, T);
            estimator.update(250.0);
        }
        estimator.predict(0.0, T);
        let before = estimator.estimate();
        let innovation = estimator.update(320.0).unwrap();
        assert!(innovation.test_ratio > 1.0 && (innovation.innovation_mm - 70.0).abs() < 1e-6, "{innovation:?}");
        assert_eq!(estimator.estimate(), before);
        for _ in 0..10 {
            estimator.predict(0.0, T);
            estimator.update(500.0);
        }
        let now = estimator.estimate().unwrap().position_mm;
        assert!((now - 500.0).abs() < 1.0, "{gain:?}: {now} mm");
    }
}

#[test]
fn a_ball_that_lies_at_the_bottom_is_not_believed_to_fall_through_it() {
    let mut estimator = Estimator::new(OBSERVER, T).unwrap();
    estimator.update(0.0);
    for _ in 0..50 {
        estimator.predict(-21.4, T);
    }
    let now = estimator.estimate().unwrap();
    assert_eq!((now.position_mm, now.velocity_mm_per_s), (0.0, 0.0));
    assert!(now.fan < -20.0, "{now:?}");
}

#[test]
fn the_first_reading_is_where_the_ball_is() {
    let mut estimator = Estimator::new(OBSERVER, T).unwrap();
    assert_eq!(estimator.estimate(), None);
    assert_eq!(estimator.update(123.0), None);
    assert_eq!(estimator.estimate().unwrap().position_mm, 123.0);
}
