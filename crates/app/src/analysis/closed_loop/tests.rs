//! Tests of the closed-loop metrics.

use super::critical_gain::critical_gain;
use super::median;
use crate::analysis::virtual_flight::Desk;
use crate::log::header::About;
use crate::log::reader::{LoadedLog, sample};
use config::Tables;
use diagnose::Recording;
use plant::effects::TransportDelay;
use plant::{Effects, Model, Noise};

pub(crate) fn project() -> Tables {
    toml::from_str(include_str!("../../../../../config.toml")).unwrap()
}

pub(crate) fn log(samples: Vec<diagnose::Sample>) -> LoadedLog {
    LoadedLog {
        recording: Recording::new(samples).unwrap(),
        about: About::default(),
        config_toml: None,
        cycles: Vec::new(),
        events: Vec::new(),
        truncated: None,
    }
}

/// A flight of `rig` by the project's controller along the project's reference.
fn flight(rig: &Model, seconds: f64) -> LoadedLog {
    let tables = project();
    let mut programme = crate::flight::experiment::Experiment::of_reference(tables.reference.as_ref().unwrap());
    programme.change(0, |only| only.duration_s = seconds);
    let flown = Desk::of(&tables).unwrap().fly(rig, &programme, 11);
    log(flown.cycles.iter().map(sample).collect())
}

#[test]
fn the_mended_model_flies_the_steps_as_the_rig_did_and_the_believed_one_does_not() {
    let tables = project();
    let belief = tables.plant.clone().unwrap();
    let late = Effects { transport_delay: Some(TransportDelay { delay_s: 0.12 }), ..belief.effects.clone() };
    let rig = Model { effects: late, ..belief.clone() };
    let found = super::measure(&[flight(&rig, 64.0)], &tables, &belief, Some(&rig));
    assert_eq!(found.steps, 8);
    let of = |c: super::Compared| [c.recorded, c.nominal, c.mended].map(Option::unwrap);
    let [recorded, nominal, mended] = of(found.overshoot_percent);
    assert!((recorded - mended).abs() < 4.0 && recorded > nominal + 4.0, "{recorded}, {nominal}, {mended} %");
    // The believed loop hardly overshoots: half of its steps have no peak.
    let (recorded, mended) = found.peak_time_s.recorded.zip(found.peak_time_s.mended).unwrap();
    assert!((recorded / mended - 1.0).abs() < 0.15, "{recorded}, {mended} s");
    let critical = found.critical_gain_ratio;
    assert!(critical.mended.unwrap() < 0.9 * critical.nominal.unwrap(), "{critical:?}");
}

#[test]
fn a_record_whose_controller_nobody_knows_has_only_its_own_figures() {
    let tables = project();
    let belief = tables.plant.clone().unwrap();
    let plant_only = Tables { plant: Some(belief.clone()), ..Tables::default() };
    let found = super::measure(&[flight(&belief, 40.0)], &plant_only, &belief, Some(&belief));
    assert!(found.steps == 5 && found.overshoot_percent.recorded.is_some(), "{found:?}");
    assert_eq!((found.overshoot_percent.nominal, found.settling_s.mended), (None, None));
    assert_eq!((found.critical_gain_ratio.nominal, found.critical_gain_ratio.mended), (None, None));
}

#[test]
fn the_steps_of_several_logs_are_taken_together() {
    let tables = project();
    let belief = tables.plant.clone().unwrap();
    let flight = flight(&belief, 40.0);
    let [once, twice] = [1, 2].map(|logs| super::measure(&vec![flight.clone(); logs], &tables, &belief, None));
    assert_eq!((once.steps, twice.steps), (5, 10));
    assert_eq!(once.overshoot_percent.recorded, twice.overshoot_percent.recorded);
    assert!(twice.overshoot_percent.nominal.is_some() && twice.critical_gain_ratio == once.critical_gain_ratio);
}

#[test]
fn a_record_without_setpoints_has_no_steps() {
    let tables = project();
    let belief = tables.plant.clone().unwrap();
    let samples = flight(&belief, 20.0).recording.samples().to_vec();
    let bare = samples.iter().map(|s| diagnose::Sample { setpoint_mm: None, ..*s }).collect();
    let found = super::measure(&[log(bare)], &tables, &belief, None);
    assert_eq!((found.steps, found.overshoot_percent), (0, super::Compared::default()));
    assert!(found.critical_gain_ratio.nominal.is_some() && found.critical_gain_ratio.mended.is_none());
}

#[test]
fn a_log_that_holds_its_config_is_flown_by_that_and_not_by_the_one_at_hand() {
    let tables = project();
    let mut other = tables.clone();
    other.controller.as_mut().unwrap().pid.as_mut().unwrap().kp_per_mm *= 2.0;
    let model = tables.plant.clone().unwrap();
    let own = LoadedLog { config_toml: Some(toml::to_string(&other).unwrap()), ..flight(&model, 20.0) };
    let ratio = |log: &LoadedLog| critical_gain(&Desk::that_flew(log, &tables).unwrap(), &model).unwrap();
    let without = LoadedLog { config_toml: None, ..own.clone() };
    assert!((ratio(&own) * 2.0 / ratio(&without) - 1.0).abs() < 0.05, "{}, {}", ratio(&own), ratio(&without));
}

#[test]
fn the_critical_gain_is_that_of_the_characteristic_equation() {
    // P control with period T of K/(s(s + a)): the held duty and the cycle's own time delay the loop by about T/2, so
    // that at the critical gain the phase is −π/2 − atan(ω/a) − ω·T/2 = −π and kp·K = ω·√(ω² + a²).
    let (gain, drag, period_s) = (254.6, 4.0, 0.1);
    let model = Model {
        gain_mm_per_s2_per_percent: gain,
        drag_per_s: drag,
        hover_duty_percent: 50.0,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 2000.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 1.0, acceleration_psd_mm2_per_s3: 100.0 },
        effects: Effects::default(),
    };
    let kp = 0.02;
    let mut desk = Desk::gentle(&model, period_s).unwrap();
    desk.set_proportional(kp);
    let omega = (0..100_000)
        .map(|k| f64::from(k) * 1e-3)
        .find(|w| (w / drag).atan() + w * period_s / 2.0 > 0.5 * std::f64::consts::PI);
    let omega = omega.unwrap();
    let exact = omega * (omega * omega + drag * drag).sqrt() / gain / kp;
    let found = critical_gain(&desk, &model).unwrap();
    assert!((found / exact - 1.0).abs() < 0.06, "{found}, exact {exact}");
}

#[test]
fn what_never_settled_is_slower_than_what_did() {
    assert_eq!(median([Some(3.0), None, Some(1.0)].into_iter()), Some(3.0));
    assert_eq!(median([Some(3.0), None].into_iter()), None);
    assert_eq!(median([Some(3.0), Some(1.0)].into_iter()), Some(2.0));
    assert_eq!(median(std::iter::empty()), None);
}
