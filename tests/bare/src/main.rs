//! A flight of every controller on a machine with no operating system and no heap.
//!
//! Built for a bare-metal target it is linked without `std` and without a memory allocator. The compiler refuses it as
//! soon as any dependency uses `alloc`. On any other target it runs the same flight and prints the position of the
//! ball.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(feature = "allocating")]
extern crate alloc;

use control::believed::Believed;
use control::cascade::Cascade;
use control::compensation::{Compensation, DeadZoneCorrection};
use control::controller::{Controllers, Kind, OpenLoop};
use control::design::Linear;
use control::design::critical::critical_gain;
use control::design::law::Gains;
use control::dither::Dither;
use control::feed_forward::FeedForward;
use control::inputs::Source;
use control::mpc::Mpc;
use control::observer::{Gain, Observer, Tachometer};
use control::pid::{DerivativeOn, Pid};
use control::predistortion::Predistortion;
use control::regulator::Regulator;
use control::state_feedback::{Lqg, StateFeedback};
use control::{Duty, Limits};

const PERIOD_S: f64 = 0.02;

/// One of each, so that every law is part of the program.
fn controllers() -> Controllers {
    Controllers {
        active: Some(Kind::OpenLoop),
        pid: Some(Pid::new(0.012, 6.0, 0.45, 10.0, DerivativeOn::Measurement)),
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
            setpoint_per_mm: None,
            velocity: Source::Filter,
            integral: None,
        }),
        lqg: Some(Lqg { position_per_mm: 0.0195, velocity_s_per_mm: 0.0044, fan: 0.697 }),
        mpc: Some(Mpc { move_s: 0.06, position_mm: 20.0, velocity_mm_per_s: 200.0, control: 0.4 }),
        open_loop: Some(OpenLoop { control: 0.0 }),
        gain_schedule: None,
        feed_forward: Some(FeedForward { time_constant_s: 0.15 }),
    }
}

fn compensation() -> Compensation {
    Compensation {
        hover_duty_percent: 21.4,
        predistortion: Some(Predistortion { points: None }),
        dead_zone: Some(DeadZoneCorrection { lower_percent: -0.3, upper_percent: 0.3 }),
        dither: Some(Dither { step_percent: 0.8, seed: 1 }),
    }
}

/// The position of the ball after a second under each controller, mm; `None`: no controller flies.
fn fly() -> Option<f64> {
    let believed = Believed { gain_mm_per_s2_per_control: 827.2, drag_per_s: 3.896, fan_lag_s: Some(0.257) };
    let observer = Observer {
        sensor_mm: 2.5,
        acceleration_psd_mm2_per_s3: 360.0,
        disturbance_psd_per_s: Some(1e-3),
        gate_sigma: 5.0,
        gain: Gain::TimeVarying,
        second_sensor_mm: Some(2.5),
        tachometer: Some(Tachometer { control: 0.2, psd_per_s: 1e-2 }),
        believed,
    };
    let mut regulator = Regulator::new(controllers(), Some(&observer), PERIOD_S).ok()?;
    let mut compensator = compensation().start();
    let (over, limits) = (believed.over(PERIOD_S), Limits { lower: -11.4, upper: 18.6 });
    let mut state = control::believed::State::new(250.0, 0.0, 0.0, 0.1);
    for kind in Kind::ALL {
        regulator.switch(kind);
        for _ in 0..50 {
            regulator.read(state[0], PERIOD_S);
            regulator.read_second(state[0]);
            regulator.read_fan(state[2]);
            let control = regulator.step(300.0, PERIOD_S, limits);
            let duty: Duty = compensator.duty(control, 0.0);
            regulator.pass(control, PERIOD_S);
            state = over.apply(&state, if duty.percent() > 0.0 { control } else { 0.0 });
        }
    }
    Some(state[0])
}

/// The result of a design on the machine itself.
fn design() -> Option<f64> {
    let plant = Linear::three_poles(827.2, 3.896, 3.896).sampled(PERIOD_S).ok()?;
    critical_gain(&Gains::pi(0.01, 15.0), &plant).value()
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("position {:?} mm, critical gain {:?}", fly(), design());
}

#[cfg(target_os = "none")]
mod entry {
    /// The entry point of a machine without an operating system.
    #[expect(unsafe_code, reason = "a linker asks for this symbol; nothing in its body is unsafe")]
    #[unsafe(no_mangle)]
    extern "C" fn _start() -> ! {
        let found = core::hint::black_box((super::fly(), super::design()));
        assert!(found.0.is_some());
        loop {}
    }

    #[panic_handler]
    fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {}
    }
}
