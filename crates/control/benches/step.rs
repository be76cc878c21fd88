//! What one control step costs: observer, controller and compensation, beside the crates `pid` and `idsp` doing the
//! comparable part.
//!
//! Both crates compute a PID of the error with limits and nothing else; `idsp` computes it as a biquad, whose
//! coefficients know the sampling period, so that it has no exponential to compute. They are compared with `pid`, the
//! PID alone, over fixed periods. All are fed the same readings, which are made beforehand.
//!
//!     cargo bench --package control                          times, in turn, as medians with the quartiles
//!     cargo bench --package control -- NAME STEPS            STEPS steps of one of them, for `scripts/bench-control`

use control::believed::Believed;
use control::compensation::{Compensation, DeadZoneCorrection};
use control::controller::{Controllers, Kind};
use control::dither::Dither;
use control::mpc::Mpc;
use control::observer::{Gain, Observer};
use control::pid::{DerivativeOn, Pid, PidState};
use control::predistortion::Predistortion;
use control::regulator::Regulator;
use control::state_feedback::Lqg;
use control::{Duty, Limits};
use dsp_process::SplitProcess;
use idsp::Build;
use idsp::iir::{Biquad, BiquadClamp, DirectForm1, pid};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const T: f64 = 0.02;
const SETPOINT_MM: f64 = 300.0;
const LIMITS: Limits = Limits { lower: -11.4, upper: 18.6 };
const GAINS: Pid = Pid::new(0.018, 15.0, 0.35, 10.0, DerivativeOn::Error);
/// Steps that are timed together, and how often that is done.
const STEPS: usize = 20_000;
const ROUNDS: usize = 41;

/// One control step: a reading in, something that depends on it out.
type Step = Box<dyn FnMut(f64) -> f64>;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    match arguments.as_slice() {
        [] => times(),
        [name, steps] => {
            let mut step = contestants()?.into_iter().find(|(known, _)| known == name).ok_or("no such name")?.1;
            let _ = run(&mut step, steps.parse()?);
            Ok(())
        }
        _ => Err("give nothing, or a name and a number of steps".into()),
    }
}

/// Everything that is compared.
fn contestants() -> Result<Vec<(&'static str, Step)>, Box<dyn Error>> {
    Ok(vec![
        ("nothing", Box::new(|reading| reading)),
        ("pid", pid_alone()),
        ("crate-pid", crate_pid()),
        ("crate-idsp", crate_idsp()),
        ("pid-compensated", whole(Kind::Pid, None, false)?),
        ("lqg-compensated", whole(Kind::Lqg, Some(Gain::SteadyState), false)?),
        ("lqg-predistorted", whole(Kind::Lqg, Some(Gain::SteadyState), true)?),
        ("lqg-time-varying", whole(Kind::Lqg, Some(Gain::TimeVarying), false)?),
        ("mpc-compensated", whole(Kind::Mpc, Some(Gain::SteadyState), false)?),
        ("mpc-at-limits", within((21.0, 21.8), Kind::Mpc, Some(Gain::SteadyState), false)?),
    ])
}

/// Readings about the setpoint, from −80 to +80 mm, with some roughness.
fn readings() -> Vec<f64> {
    (0..1024_u32)
        .map(|k| {
            let t = f64::from(k) * std::f64::consts::TAU / 1024.0;
            SETPOINT_MM + 80.0 * t.sin() + f64::from(k * 7919 % 13) - 6.0
        })
        .collect()
}

fn run(step: &mut Step, steps: usize) -> f64 {
    let readings = readings();
    readings.iter().cycle().take(steps).map(|reading| black_box(step(black_box(*reading)))).sum()
}

fn times() -> Result<(), Box<dyn Error>> {
    let mut all = contestants()?;
    let mut taken: Vec<Vec<f64>> = all.iter().map(|_| Vec::new()).collect();
    for _ in 0..ROUNDS {
        for ((_, step), taken) in all.iter_mut().zip(&mut taken) {
            let start = Instant::now();
            black_box(run(step, STEPS));
            taken.push(start.elapsed().as_secs_f64() * 1e9 / STEPS as f64);
        }
    }
    println!("one control step, {ROUNDS} rounds of {STEPS} steps in turn: median, and quartiles");
    for ((name, _), mut taken) in all.into_iter().zip(taken) {
        taken.sort_by(f64::total_cmp);
        let at = |share: usize| taken.get(share * ROUNDS / 4).copied().unwrap_or(f64::NAN);
        println!("{name:18} {:7.1} ns   {:7.1} to {:7.1}", at(2), at(1), at(3));
    }
    Ok(())
}

fn pid_alone() -> Step {
    let mut state = PidState::default();
    Box::new(move |reading| GAINS.step(&mut state, SETPOINT_MM, reading, T, LIMITS))
}

fn crate_pid() -> Step {
    let mut pid = ::pid::Pid::<f64>::new(SETPOINT_MM, LIMITS.upper);
    let limit = f64::INFINITY;
    pid.p(GAINS.kp_per_mm, limit).i(GAINS.kp_per_mm * T / GAINS.ti_s, limit).d(GAINS.kp_per_mm * GAINS.td_s / T, limit);
    Box::new(move |reading| pid.next_control_output(reading).output)
}

fn crate_idsp() -> Step {
    let (kp, ki, kd) = (GAINS.kp_per_mm, GAINS.kp_per_mm / GAINS.ti_s, GAINS.kp_per_mm * GAINS.td_s);
    let builder = pid::Builder::default().kp(kp).ki(ki).kd(kd).limit(pid::Action::D, GAINS.derivative_n * kp);
    let biquad: Biquad<f64> = builder.build(&T);
    let mut filter = BiquadClamp::<f64, f64>::from(biquad);
    (filter.min, filter.max) = (LIMITS.lower, LIMITS.upper);
    let mut state = DirectForm1::default();
    Box::new(move |reading| filter.process(&mut state, SETPOINT_MM - reading))
}

/// An observer of the thesis' three-pole model that takes every reading.
fn observer(gain: Gain, unit: f64) -> Observer {
    Observer {
        believed: Believed { gain_mm_per_s2_per_control: 827.2 / unit, drag_per_s: 3.896, fan_lag_s: Some(0.257) },
        sensor_mm: 2.5,
        acceleration_psd_mm2_per_s3: 360.0,
        disturbance_psd_per_s: Some(1e-3 * unit * unit),
        gate_sigma: 50.0,
        second_sensor_mm: None,
        tachometer: None,
        gain,
    }
}

/// Observer, controller, dead zone and dither, and predistortion where it is asked for.
fn whole(kind: Kind, gain: Option<Gain>, predistorted: bool) -> Result<Step, Box<dyn Error>> {
    within((10.0, 40.0), kind, gain, predistorted)
}

/// The same within other limits of the duty, percent.
fn within(duties: (f64, f64), kind: Kind, gain: Option<Gain>, predistorted: bool) -> Result<Step, Box<dyn Error>> {
    // With predistortion a control value is about a three-hundredth of a percent.
    let unit = if predistorted { 300.0 } else { 1.0 };
    let observer = gain.map(|gain| observer(gain, unit));
    let controllers = Controllers {
        active: Some(kind),
        pid: (kind == Kind::Pid).then_some(GAINS),
        lqg: (kind == Kind::Lqg).then_some(Lqg {
            position_per_mm: 0.01946 * unit,
            velocity_s_per_mm: 0.0044 * unit,
            fan: 0.6968,
        }),
        mpc: (kind == Kind::Mpc).then_some(Mpc {
            move_s: 0.06,
            position_mm: 20.0,
            velocity_mm_per_s: 200.0,
            control: 0.4,
        }),
        ..Controllers::default()
    };
    let compensation = Compensation {
        predistortion: predistorted.then_some(Predistortion { points: None }),
        dead_zone: Some(DeadZoneCorrection { lower_percent: -0.3, upper_percent: 0.3 }),
        dither: Some(Dither { step_percent: 0.8, seed: 1 }),
        ..Compensation::bare(21.4)
    };
    let mut regulator = Regulator::new(controllers, observer.as_ref(), T)?;
    let mut compensator = compensation.start();
    let mut control = 0.0;
    Ok(Box::new(move |reading| {
        regulator.pass(control, T);
        regulator.read(reading, T);
        let limits = compensator.control_limits(Duty::clamped(duties.0), Duty::clamped(duties.1), 0.0);
        control = regulator.step(SETPOINT_MM, T, limits);
        compensator.duty(control, 0.0).percent()
    }))
}
