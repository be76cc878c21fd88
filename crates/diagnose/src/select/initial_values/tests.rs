//! A rate limit against a lag: rigs that are simulated here, with equations of their own.

use crate::select::tests_support::{ClosedLoop, STEP_S, seeking};
use crate::{Diagnosis, Recording, diagnose};
use plant::effects::{FanLag, RateLimit, Saturation, SensorLag, SpinAsymmetry, TransportDelay};
use plant::{Effect, Effects, Model, Noise};

/// A cart with viscous friction, ẍ = 40·(r − 50) − 3·ẋ mm/s², in closed loop; 0.2 mm of noise. `moved`: what acts after
/// a step, from what acted and the duty.
fn driven(seed: u32, moved: impl Fn(f64, f64) -> f64) -> Recording {
    let closed_loop = ClosedLoop {
        seed,
        middle_mm: 400.0,
        range_mm: 600.0,
        noise_draws: 3,
        noise_mm: 0.4,
        hover_percent: 50.0,
        proportional: 0.15,
        derivative: 0.12,
    };
    let mut acts = 50.0;
    closed_loop.record(|[x, v], duty_percent| {
        acts = moved(acts, duty_percent);
        let v = v + STEP_S * (40.0 * (acts - 50.0) - 3.0 * v);
        [x + STEP_S * v, v]
    })
}

/// The diagnosis from a belief that knows all but how the input acts.
fn found(recording: &Recording) -> Diagnosis {
    let belief = Model {
        gain_mm_per_s2_per_percent: 40.0,
        drag_per_s: 3.0,
        hover_duty_percent: 50.0,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 1000.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 0.2, acceleration_psd_mm2_per_s3: 1.0 },
        effects: Effects::default(),
    };
    let sought = [
        RateLimit::ENTRY.name,
        FanLag::ENTRY.name,
        SpinAsymmetry::ENTRY.name,
        SensorLag::ENTRY.name,
        TransportDelay::ENTRY.name,
        Saturation::ENTRY.name,
    ];
    diagnose(&belief, std::slice::from_ref(recording), &seeking(&sought))
}

#[test]
fn a_rate_limit_is_found_with_its_rate() {
    let step = 80.0 * STEP_S;
    for seed in [3, 4] {
        let diagnosis = found(&driven(seed, |acts, duty| acts + (duty - acts).clamp(-step, step)));
        let named: Vec<_> = diagnosis.effects.iter().map(|named| named.candidate.entry.name).collect();
        assert_eq!(named, [RateLimit::ENTRY.name], "{}", diagnosis.verdict_in_words());
        let seconds = diagnosis.mended.model.effects.values(RateLimit::ENTRY.name).unwrap()[0];
        assert!((seconds / 1.25 - 1.0).abs() < 0.05, "{seconds} s");
    }
}

#[test]
fn a_lag_is_no_rate_limit() {
    for seed in [3, 4] {
        let diagnosis = found(&driven(seed, |acts, duty| acts + STEP_S / 0.15 * (duty - acts)));
        let rate = diagnosis.effects.iter().find(|named| named.candidate.entry.name == RateLimit::ENTRY.name);
        assert!(rate.is_none_or(|named| named.probability < 0.5), "{}", diagnosis.verdict_in_words());
        assert!(!diagnosis.effects.is_empty(), "{}", diagnosis.verdict_in_words());
    }
}
