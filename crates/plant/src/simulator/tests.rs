//! What `simulator.rs` promises.

use super::Simulator;
use crate::effects::Effects;
use crate::model::{Model, Noise, tests::thesis};

#[test]
fn one_seed_gives_one_flight_bit_for_bit_and_another_seed_another() {
    let fly = |seed| {
        let mut rig = Simulator::new(thesis(), seed);
        rig.drive(22.0);
        (1..200)
            .map(|k| {
                rig.advance_to(0.02 * f64::from(k));
                rig.reading_mm()
            })
            .collect::<Vec<f64>>()
    };
    assert_eq!(fly(3), fly(3));
    assert_ne!(fly(3), fly(4));
}

#[test]
fn white_acceleration_grows_the_variance_of_the_velocity_as_configured() {
    // Without drag the velocity is a random walk: variance PSD·t.
    let noise = Noise { sensor_mm: 0.0, acceleration_psd_mm2_per_s3: 360.0 };
    let model = Model { drag_per_s: 0.0, pipe_length_mm: 1e6, noise, effects: Effects::default(), ..thesis() };
    let runs: u32 = 2000;
    let sum: f64 = (0..runs)
        .map(|seed| {
            let mut rig = Simulator::new(model.clone(), u64::from(seed));
            rig.motion.position_mm = 5e5;
            rig.drive(model.hover_duty_percent);
            rig.advance_to(0.05);
            rig.motion().velocity_mm_per_s.powi(2)
        })
        .sum();
    let variance = sum / f64::from(runs);
    let exact = 360.0 * 0.05;
    // Five standard errors of a variance from 2000 runs.
    assert!((variance - exact).abs() < 5.0 * exact * (2.0 / f64::from(runs)).sqrt(), "{variance}, exact {exact}");
}

#[test]
fn readings_scatter_by_the_configured_noise() {
    let noise = Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 0.0 };
    let mut rig = Simulator::new(Model { noise, ..thesis() }, 11);
    let n = 20_000;
    let variance = (0..n).map(|_| rig.reading_mm().powi(2)).sum::<f64>() / f64::from(n);
    assert!((variance.sqrt() - 2.5).abs() < 0.07, "σ = {} mm", variance.sqrt());
}

/// A rig without drag or noise in a long pipe.
fn quiet(effects: &[(&str, &[f64])]) -> Model {
    let noise = Noise { sensor_mm: 0.0, acceleration_psd_mm2_per_s3: 0.0 };
    let mut model = Model { drag_per_s: 0.0, pipe_length_mm: 1e6, noise, effects: Effects::default(), ..thesis() };
    for (name, values) in effects {
        assert!(model.effects.set(name, values), "{name}");
    }
    model
}

#[test]
fn a_transport_delay_shifts_the_flight_by_itself_and_nothing_else() {
    let fly = |model: Model, t: f64| {
        let mut rig = Simulator::new(model, 0);
        rig.drive(23.0);
        rig.advance_to(0.3);
        rig.drive(21.0);
        rig.advance_to(t);
        rig.motion().position_mm
    };
    let (now, later) = (fly(quiet(&[]), 0.8), fly(quiet(&[("transport_delay", &[0.05371])]), 0.85371));
    assert!((now - later).abs() < 1e-9, "{now} mm now, {later} mm later");
}

#[test]
fn transport_delay_and_sensor_delay_give_the_same_readings() {
    let fly = |model: Model| {
        let mut rig = Simulator::new(model, 0);
        (0..100_u32)
            .map(|k| {
                rig.advance_to(0.02 * f64::from(k));
                rig.drive(if k % 40 < 20 { 23.0 } else { 20.5 });
                rig.reading_mm()
            })
            .collect::<Vec<f64>>()
    };
    let (duty, sensor) = (fly(quiet(&[("transport_delay", &[0.05])])), fly(quiet(&[("sensor_delay", &[0.05])])));
    for (duty, sensor) in duty.iter().zip(&sensor) {
        assert!((duty - sensor).abs() < 1e-2, "{duty} mm and {sensor} mm");
    }
}

#[test]
fn a_drifting_hover_is_the_closed_form() {
    // From rest at hover, a = K·r·t: y = K·r·t³/6.
    let mut rig = Simulator::new(quiet(&[("hover_drift", &[-0.02])]), 0);
    rig.drive(21.4);
    rig.advance_to(3.0);
    let exact = 827.2 * 0.02 * 27.0 / 6.0;
    let position = rig.motion().position_mm;
    assert!((position - exact).abs() < 1e-4, "{position} mm, exact {exact} mm");
}

#[test]
fn the_limits_come_before_the_lag() {
    // The fan heads for the limit with its own lag; a limit behind the lag would be reached at once.
    let model = quiet(&[("saturation", &[-100.0, 100.0]), ("fan_lag", &[0.2])]);
    let mut rig = Simulator::new(model, 0);
    rig.drive(31.4);
    rig.advance_to(0.2);
    let exact = 100.0 - 200.0 * libm::exp(-1.0);
    let fan = rig.motion().fan_mm_per_s2;
    assert!((fan - exact).abs() < 1e-9, "{fan} mm/s², exact {exact} mm/s²");
}

#[test]
fn turbulence_is_stationary_and_scatters_the_velocity_as_its_theory_says() {
    // var v = 2σ²τ·(t − τ·(1 − e^(−t/τ))), cov(w₀, w) = σ²·e^(−t/τ).
    let (sigma, tau, t) = (100.0, 0.1, 0.2);
    let model =
        Model { pipe_length_mm: 1e6, ..quiet(&[("turbulence", &[sigma, tau]), ("end_stop", &[0.0, 1e6, 1.0])]) };
    let (mut v2, mut w2, mut ww) = (0.0, 0.0, 0.0);
    let runs: u32 = 4000;
    for seed in 0..runs {
        let mut rig = Simulator::new(model.clone(), u64::from(seed));
        rig.motion.position_mm = 5e5;
        rig.drive(21.4);
        let first = rig.motion().turbulence_mm_per_s2;
        rig.advance_to(t);
        v2 += rig.motion().velocity_mm_per_s.powi(2) / f64::from(runs);
        w2 += rig.motion().turbulence_mm_per_s2.powi(2) / f64::from(runs);
        ww += rig.motion().turbulence_mm_per_s2 * first / f64::from(runs);
    }
    let decay = libm::exp(-t / tau);
    let exact_v2 = 2.0 * sigma * sigma * tau * (t - tau * (1.0 - decay));
    // Five standard errors of a variance from 4000 runs are 11 %.
    assert!((v2 / exact_v2 - 1.0).abs() < 0.11, "{v2}, exact {exact_v2}");
    assert!((w2 / (sigma * sigma) - 1.0).abs() < 0.11, "{w2}");
    assert!((ww / (sigma * sigma) - decay).abs() < 0.08, "{ww}");
}

#[test]
fn the_velocity_is_the_integral_of_the_turbulence_even_when_that_is_fast() {
    // Correlated over 10 ms only: what comes in during a step matters to 5 %.
    let mut rig = Simulator::new(quiet(&[("turbulence", &[100.0, 0.01])]), 6);
    rig.motion.position_mm = 5e5;
    rig.drive(21.4);
    let (mut integral, mut last) = (0.0, rig.motion().turbulence_mm_per_s2);
    for k in 1..=2000_u32 {
        // A little below the longest step, so that each of these is one step.
        rig.advance_to(0.0009 * f64::from(k));
        let now = rig.motion().turbulence_mm_per_s2;
        integral += 0.0009 * (last + now) / 2.0;
        last = now;
    }
    let velocity = rig.motion().velocity_mm_per_s;
    assert!((velocity / integral - 1.0).abs() < 0.01, "{velocity} mm/s, integral {integral} mm/s");
}

#[test]
fn a_ball_held_by_friction_is_not_shaken_loose_by_weaker_turbulence() {
    let mut rig = Simulator::new(quiet(&[("turbulence", &[10.0, 0.1]), ("wall_friction", &[200.0])]), 3);
    rig.drive(21.4);
    rig.advance_to(5.0);
    assert_eq!((rig.motion().position_mm, rig.motion().velocity_mm_per_s), (0.0, 0.0));
}

#[test]
fn switching_a_random_effect_on_leaves_the_noise_of_the_others_alone() {
    let fly = |effects: &[(&str, &[f64])]| {
        let noise = Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 };
        let mut rig = Simulator::new(Model { noise, ..quiet(effects) }, 8);
        rig.drive(22.0);
        rig.advance_to(1.0);
        (rig.motion().velocity_mm_per_s, rig.reading_mm() - rig.motion().position_mm)
    };
    let bare = fly(&[]);
    let shaken = fly(&[("turbulence", &[1e-6, 0.1]), ("sensor_outliers", &[1e-9, 50.0])]);
    assert!((bare.0 - shaken.0).abs() < 1e-4 && (bare.1 - shaken.1).abs() < 1e-9, "{bare:?}, {shaken:?}");
}

#[test]
fn the_ball_starts_at_rest_at_the_bottom_of_its_way() {
    let rig = Simulator::new(quiet(&[("end_stop", &[40.0, 500.0, 0.5])]), 0);
    assert_eq!((rig.motion().position_mm, rig.motion().sensed_mm, rig.motion().velocity_mm_per_s), (40.0, 40.0, 0.0));
}
