//! The transient method recovers the plant from a sweep of proportional gains.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use diagnose::identify::Sweep;
use diagnose::identify::Transient;
use diagnose::{Recording, Sample};
use plant::{Effects, Model, Noise, Simulator};
use rayon::prelude::*;

const SEEDS: u64 = 50;
/// The thesis, table 3.1.2.1: K_p, δ, ω_n, and the K_g and a that it prints.
const TABLE: [[f64; 5]; 6] = [
    [0.006, 0.809, 1.120, 209.029, 1.813],
    [0.007, 0.922, 0.851, 103.455, 1.569],
    [0.009, 0.752, 1.397, 216.788, 2.100],
    [0.011, 0.585, 1.854, 312.539, 2.171],
    [0.013, 0.479, 1.892, 275.300, 1.812],
    [0.015, 0.392, 1.972, 259.334, 1.547],
];
const HALF_PERIOD_S: f64 = 8.0;
/// Rows of ten pulses and their returns, 50 a second.
const ROWS: u32 = 8000;

/// Setpoints of five pulses of ±100 mm and five of ±200 mm.
fn setpoint_mm(time_s: f64) -> f64 {
    let low = time_s % (2.0 * HALF_PERIOD_S) < HALF_PERIOD_S;
    let reach = if time_s < 10.0 * HALF_PERIOD_S { 50.0 } else { 100.0 };
    if low { 300.0 - reach } else { 300.0 + reach }
}

#[test]
fn a_sweep_of_loops_of_second_order_gives_back_the_table_of_the_thesis() {
    // At 0.007, which the thesis leaves out of its mean, the overshoot is 0.06 %: too little to measure on a pulse.
    for [kp, damping, omega, gain, drag] in TABLE.into_iter().filter(|row| row[0] != 0.007) {
        let loops = Transient { damping, omega };
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            let since = time_s % HALF_PERIOD_S;
            let from = setpoint_mm((time_s - since - 1e-6).max(0.0));
            let setpoint = setpoint_mm(time_s);
            let position = from + (setpoint - from) * loops.response(since);
            Sample {
                time_s,
                setpoint_mm: Some(setpoint),
                position_mm: Some(position),
                control_percent: Some(kp * (setpoint - position)),
                duty_percent: 21.4,
                ..Sample::default()
            }
        };
        let found = Sweep::of(&Recording::new((0..ROWS).map(row).collect()).unwrap(), 0.0).unwrap();
        // First term: half a digit of the printed δ and ω_n. Second term: the peak read at 50 points a second.
        assert!((found.gain.value / gain - 1.0).abs() < 0.0025 + 0.003, "K_p {kp}: {:?}", found.gain);
        assert!((found.drag.value / drag - 1.0).abs() < 0.0015 + 0.003, "K_p {kp}: {:?}", found.drag);
    }
}

/// Flies a sweep of `gains` on a rig without a fan lag.
fn flown(seed: u64, gains: &[f64]) -> Recording {
    let noise = Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 };
    let rig = Model {
        gain_mm_per_s2_per_percent: 254.598,
        drag_per_s: 1.889,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise,
        effects: Effects::default(),
    };
    let mut simulator = Simulator::new(rig, seed);
    let each = gains.iter().flat_map(|kp| (0..ROWS).map(move |row| (kp, 0.02 * f64::from(row))));
    let rows = (0..).zip(each).map(|(k, (kp, since_s))| {
        let time_s = 0.02 * f64::from(k);
        simulator.advance_to(time_s);
        let reading = simulator.reading_mm().round();
        let setpoint = setpoint_mm(since_s);
        let control = kp * (setpoint - reading);
        // The believed hover is 0.1 % too high: the ball settles off the setpoint.
        let duty_percent = (21.5 + control).clamp(10.0, 40.0);
        simulator.drive(duty_percent);
        let (setpoint_mm, position_mm, control_percent) = (Some(setpoint), Some(reading), Some(control));
        Sample { time_s, setpoint_mm, control_percent, duty_percent, position_mm, ..Sample::default() }
    });
    Recording::new(rows.collect()).unwrap()
}

#[test]
fn gain_and_drag_of_a_rig_without_lag_lie_in_their_intervals() {
    let found: Vec<Sweep> = (0..SEEDS)
        .into_par_iter()
        .map(|seed| Sweep::of(&flown(seed, &TABLE.map(|row| row[0])), 0.01).unwrap())
        .collect();
    for (what, of, truth) in [
        ("K_g", (|s: &Sweep| s.gain) as fn(&Sweep) -> diagnose::identify::ParameterEstimate, 254.598),
        ("a", |s: &Sweep| s.drag, 1.889),
    ] {
        let holds = |e: diagnose::identify::ParameterEstimate| e.low.unwrap() <= truth && truth <= e.high.unwrap();
        let count = found.iter().filter(|found| holds(of(found))).count();
        assert!((40..=49).contains(&count), "{what}: {count} of {SEEDS} intervals hold {truth}");
    }
}
