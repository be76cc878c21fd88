//! Measurements of simulated rigs with known parameters: for 50 seeds a 90 % interval contains the true value 40 to 49
//! times.

use super::critical::{critical, critical_time};
use super::dead_zone::dead_zone;
use super::jumps::jumps;
use super::noise_floor::noise_floor;
use super::two_ends::two_ends;
use super::{Estimate, MeasureError};
use crate::tests_support::model;
use crate::{Recording, Sample};
use control::design::critical::{critical_gain, critical_integral_time};
use control::design::law::Gains;
use plant::{Model, Simulator, effects::DeadZone};
use rayon::prelude::*;

/// A part of a flight.
#[derive(Clone, Copy)]
enum Leg {
    /// A constant duty, until the time is over or the ball leaves 100 to 500 mm.
    Drive { percent: f64, seconds: f64 },
    /// A setpoint with a PID controller of K_p, T_i and T_d.
    Hold { setpoint_mm: f64, law: [f64; 3], seconds: f64 },
}

const CALM: [f64; 3] = [0.02, 15.0, 0.35];

/// Simulates the legs at 50 Hz.
fn fly(rig: &Model, seed: u64, legs: &[Leg]) -> Recording {
    let mut simulator = Simulator::new(rig.clone(), seed);
    let (mut k, mut samples) = (0_u32, Vec::new());
    let (mut integral, mut lead, mut last_mm) = (0.0, 0.0, 0.0);
    for leg in legs {
        let start = k;
        loop {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            let mm = simulator.reading_mm();
            let position_mm = Some(mm);
            let (seconds, sample, out) = match *leg {
                Leg::Drive { percent, seconds } => {
                    let sample = Sample { time_s, duty_percent: percent, position_mm, ..Sample::default() };
                    (seconds, sample, k > start + 5 && !(100.0..500.0).contains(&mm))
                }
                Leg::Hold { setpoint_mm, law: [kp, ti_s, td_s], seconds } => {
                    let error = setpoint_mm - mm;
                    lead = if td_s > 0.0 { 0.6 * lead + 0.4 * td_s * (last_mm - mm) / 0.02 } else { 0.0 };
                    let control = kp * (error + lead) + integral;
                    integral += kp / ti_s * error * 0.02;
                    let (setpoint_mm, control_percent) = (Some(setpoint_mm), Some(control));
                    let duty_percent = 21.4 + control;
                    (
                        seconds,
                        Sample { time_s, setpoint_mm, control_percent, duty_percent, position_mm, ..Sample::default() },
                        false,
                    )
                }
            };
            last_mm = mm;
            if out || f64::from(k - start) * 0.02 >= seconds {
                break;
            }
            simulator.drive(sample.duty_percent);
            samples.push(sample);
            k += 1;
        }
    }
    Recording::new(samples).unwrap()
}

/// Asserts that each interval contains the true value for 40 to 49 of 50 seeds.
fn assert_calibrated<const N: usize>(truth: [f64; N], measured: impl Fn(u64) -> [Estimate; N] + Send + Sync) {
    let all: Vec<[Estimate; N]> = (1..=50).into_par_iter().map(measured).collect();
    let counts: [usize; N] = std::array::from_fn(|i| all.iter().filter(|found| found[i].holds(truth[i])).count());
    let means: [f64; N] = std::array::from_fn(|i| all.iter().map(|found| found[i].value).sum::<f64>() / 50.0);
    assert!(counts.iter().all(|count| (40..=49).contains(count)), "of 50: {counts:?}; {means:?} beside {truth:?}");
}

#[test]
fn the_noise_floor_of_a_ball_at_rest_is_the_sensors() {
    assert_calibrated([2.5, 0.0], |seed| {
        let still = fly_through(&model(), seed, &[Leg::Drive { percent: 10.0, seconds: 12.0 }]);
        let found = noise_floor(&Recording::new(still).unwrap()).unwrap();
        [found.sensor_mm, found.drift_mm_per_s]
    });
}

#[test]
fn two_ends_give_back_a_sensor_that_is_off_in_offset_and_scale() {
    let (scale, offset) = (0.97, 6.0);
    let legs = [Leg::Drive { percent: 10.0, seconds: 8.0 }, Leg::Drive { percent: 25.0, seconds: 9.0 }];
    let wide = |seed| {
        let flown = fly_through(&model(), seed, &legs);
        let off = |row: &Sample| Sample { position_mm: row.position_mm.map(|mm| scale * mm + offset), ..*row };
        two_ends(&Recording::new(flown.iter().map(off).collect()).unwrap(), 583.0, 600.0).unwrap()
    };
    assert_calibrated([offset, 1.0 / scale, scale * 583.0 + offset], |seed| {
        let found = wide(seed);
        let top = found.top.unwrap();
        [found.bottom_mm, top.scale, top.reading_mm]
    });
}

/// Duties in sequence, without a limit of the position.
fn fly_through(rig: &Model, seed: u64, legs: &[Leg]) -> Vec<Sample> {
    let mut simulator = Simulator::new(rig.clone(), seed);
    let mut k = 0_u32;
    let mut samples = Vec::new();
    for leg in legs {
        let Leg::Drive { percent: duty_percent, seconds } = *leg else { continue };
        let until = f64::from(k) + 50.0 * seconds;
        while f64::from(k) < until {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            samples.push(Sample {
                time_s,
                duty_percent,
                position_mm: Some(simulator.reading_mm()),
                ..Sample::default()
            });
            simulator.drive(duty_percent);
            k += 1;
        }
    }
    samples
}

/// Jumps up from 150 mm and down from 450 mm in turn, with hover duty plus or minus these values.
fn jump_legs(beyond: &[f64]) -> Vec<Leg> {
    let hold = |setpoint_mm, seconds| Leg::Hold { setpoint_mm, law: CALM, seconds };
    let pair = |by: &f64| {
        let drive = |percent| Leg::Drive { percent, seconds: 5.0 };
        [hold(150.0, 4.0), drive(21.4 + by), hold(450.0, 4.0), drive(21.4 - by)]
    };
    beyond.iter().flat_map(pair).collect()
}

#[test]
fn the_edges_of_a_dead_zone_and_what_the_jumps_share_are_the_rigs() {
    let mut rig = model();
    rig.effects.dead_zone = Some(DeadZone { lower_percent: -0.2, upper_percent: 0.3 });
    let legs = jump_legs(&[0.1, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3]);
    let truth = [21.2, 21.7, 254.6, 254.6, 0.2];
    assert_calibrated(truth, |seed| {
        let shared = jumps(&fly(&rig, seed, &legs), 1.889).unwrap();
        let zone = dead_zone(&shared).unwrap();
        let edges = [zone.lower_duty_percent, zone.upper_duty_percent];
        [edges[0], edges[1], zone.gain_below, zone.gain_above, shared.lag_s]
    });
}

#[test]
fn a_rig_without_a_dead_zone_has_two_edges_at_hover() {
    let legs = jump_legs(&[0.2, 0.3, 0.4, 0.6, 0.8, 1.0]);
    assert_calibrated([21.4, 21.4], |seed| {
        let zone = dead_zone(&jumps(&fly(&model(), seed, &legs), 1.889).unwrap()).unwrap();
        [zone.lower_duty_percent, zone.upper_duty_percent]
    });
}

#[test]
fn the_forces_of_jumps_lie_in_their_intervals_as_often_as_they_should() {
    let legs = jump_legs(&[0.4, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5]);
    let share = |seed: u64| {
        let found = jumps(&fly(&model(), seed, &legs), 1.889).unwrap().jumps;
        let right = found.iter().filter(|jump| jump.mm_per_s2.holds(254.6 * (jump.duty_percent - 21.4))).count();
        (right, found.len())
    };
    let all: Vec<(usize, usize)> = (1..=50).into_par_iter().map(share).collect();
    let (right, of) = all.iter().fold((0, 0), |(right, of), one| (right + one.0, of + one.1));
    // The jumps of a record share the lag, so their errors are correlated: a wider range than for 800 independent ones.
    let share = right as f64 / of as f64;
    assert!((0.86..0.94).contains(&share), "{right} of {of}");
}

#[test]
fn the_critical_gain_is_that_of_the_sampled_loop() {
    let plant = model().linear().sampled(0.02).unwrap();
    let exact = critical_gain(&Gains::pi(1.0, 15.0), &plant).value().unwrap();
    let mut legs = Vec::new();
    for k in 0..14 {
        let (setpoint_mm, kp) = (if k % 2 == 0 { 360.0 } else { 240.0 }, 0.66 * exact * 1.05_f64.powi(k));
        legs.push(Leg::Hold { setpoint_mm: 600.0 - setpoint_mm, law: CALM, seconds: 3.0 });
        legs.push(Leg::Hold { setpoint_mm, law: [kp, 15.0, 0.0], seconds: 9.0 });
    }
    assert_calibrated([exact], |seed| [critical(&fly(&model(), seed, &legs)).unwrap().kp_per_mm]);
}

#[test]
fn the_critical_integral_time_is_that_of_the_sampled_loop() {
    let plant = model().linear().sampled(0.02).unwrap();
    let kp = 0.4 * critical_gain(&Gains::pi(1.0, 15.0), &plant).value().unwrap();
    let exact = critical_integral_time(&Gains::pi(kp, 15.0), &plant).value().unwrap();
    let mut legs = Vec::new();
    // No swing reaches an end of the pipe.
    for k in 0..14 {
        let (setpoint_mm, ti_s) = (if k % 2 == 0 { 330.0 } else { 270.0 }, 1.25 * exact * 0.975_f64.powi(k));
        legs.push(Leg::Hold { setpoint_mm: 600.0 - setpoint_mm, law: CALM, seconds: 4.0 });
        legs.push(Leg::Hold { setpoint_mm, law: [kp, ti_s, 0.0], seconds: 12.0 });
    }
    assert_calibrated([exact], |seed| [critical_time(&fly(&model(), seed, &legs)).unwrap().ti_s]);
}

#[test]
fn a_record_of_something_else_is_refused_with_what_is_missing() {
    let hovering = fly(&model(), 1, &[Leg::Hold { setpoint_mm: 300.0, law: CALM, seconds: 20.0 }]);
    assert_eq!(noise_floor(&hovering), Err(MeasureError::NoRest { found: 0, needed: 100 }));
    assert!(matches!(jumps(&hovering, 1.889), Err(MeasureError::FewJumps { found: 0, .. })));
    assert!(matches!(critical(&hovering), Err(MeasureError::NoSwing { .. })));
    assert!(critical_time(&hovering).unwrap_err().to_string().contains("experiments/critical-time.toml"));
    assert!(two_ends(&hovering, 583.0, 553.0).is_err());
}
