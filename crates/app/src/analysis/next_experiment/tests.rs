//! Tests of the choice of the next experiment.

use super::candidates::{Candidate, candidates};
use super::score::fly_all;
use super::{Rival, all_pairs, between};
use crate::analysis::closed_loop::tests::project;
use crate::analysis::virtual_flight::Desk;
use crate::flight::experiment::Experiment;
use control::waveform::Waveform;
use diagnose::{Recording, Sample};
use plant::{Effects, Model};

fn desk() -> Desk {
    Desk::of(&project()).unwrap()
}

fn rival(name: &'static str, values: &[f64]) -> Rival {
    let mut model = project().plant.unwrap();
    assert!(model.effects.set(name, values));
    (name, model)
}

fn any_log() -> Recording {
    let row =
        |k| Sample { time_s: 0.02 * f64::from(k), duty_percent: 21.4, position_mm: Some(300.0), ..Sample::default() };
    Recording::new((0..100).map(row).collect()).unwrap()
}

fn list() -> Vec<Candidate> {
    candidates(&desk(), &[rival("dead_zone", &[-0.3, 0.3])])
}

fn read(text: &str) -> Experiment {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("next.toml");
    std::fs::write(&path, text).unwrap();
    Experiment::read(&path, &desk().safety).unwrap()
}

#[test]
fn every_experiment_of_the_list_is_a_file_that_run_accepts_and_that_says_what_was_flown() {
    let list = list();
    assert!(list.len() > 9);
    for candidate in list {
        assert_eq!(read(&super::file(&candidate)), candidate.experiment);
    }
}

#[test]
fn two_rivals_are_separated_by_an_experiment_that_flies_safely() {
    let rivals = [rival("force_asymmetry", &[1.4]), rival("thrust_curve", &[0.05])];
    let advice = between(&rivals, &desk(), &any_log());
    let next = advice.experiment.unwrap();
    assert_eq!((next.separates.as_slice(), advice.findings.len()), (&["force_asymmetry", "thrust_curve"][..], 0));
    assert!(next.expected_nats >= 5.0, "{next:?}");
    for (_, model) in &rivals {
        let flown = desk().fly(model, &read(&next.file), 5);
        assert!(flown.fault.is_none() && flown.cycles.len() > 2000, "{:?}", flown.fault);
    }
}

#[test]
fn twins_are_sent_to_another_signal_unless_it_is_there() {
    let twins = [rival("transport_delay", &[0.08]), rival("sensor_delay", &[0.08])];
    let advice = between(&twins, &desk(), &any_log());
    assert!(advice.experiment.is_none());
    let said = &advice.findings[0];
    assert!(said.contains("fan_rpm") && said.contains("position2_mm"), "{said}");
    let with_speed = any_log().samples().iter().map(|row| Sample { fan_rpm: Some(900.0), ..*row }).collect();
    let with_speed = Recording::new(with_speed).unwrap();
    let said = &between(&twins, &desk(), &with_speed).findings[0];
    assert!(!said.contains("fan_rpm") && said.contains("position2_mm"), "{said}");
}

#[test]
fn a_third_rival_is_told_from_twins_and_the_twins_are_still_named() {
    let rivals = [rival("transport_delay", &[0.08]), rival("sensor_delay", &[0.08]), rival("dead_zone", &[-0.3, 0.3])];
    let advice = between(&rivals, &desk(), &any_log());
    assert_eq!(advice.experiment.unwrap().separates, ["transport_delay", "dead_zone"]);
    assert!(advice.findings[0].starts_with("transport_delay and sensor_delay look alike"), "{:?}", advice.findings);
}

#[test]
fn an_experiment_that_brings_the_ball_to_an_end_or_the_duty_to_a_limit_is_dropped() {
    let rivals = [rival("dead_zone", &[-0.3, 0.3])];
    let safe = list().into_iter().find(|candidate| candidate.name == "still hover").unwrap();
    assert!(fly_all(&safe, &rivals, &desk()).is_some());
    let mut high = safe.clone();
    high.experiment.limits.position_max_mm = None;
    high.experiment.change(1, |moving| moving.setpoint_mm = Some(Waveform::Constant { value: 581.0 }));
    assert!(fly_all(&high, &rivals, &desk()).is_none());
    let mut hard = safe;
    let hardest = Waveform::Square { low: -20.0, high: 20.0, period_s: 0.1 };
    hard.experiment.change(1, |moving| moving.excitation_percent = Some(hardest));
    assert!(fly_all(&hard, &rivals, &desk()).is_none());
}

#[test]
fn what_the_base_parameters_can_imitate_separates_nothing() {
    let truth = project().plant.unwrap();
    let other = Model { gain_mm_per_s2_per_percent: 1.1 * truth.gain_mm_per_s2_per_percent, ..truth.clone() };
    let rivals = [("a", truth), ("b", other)];
    let squares = list().into_iter().find(|candidate| candidate.name == "fast squares").unwrap();
    let records = fly_all(&squares, &rivals, &desk()).unwrap();
    let (_, fixed) = records.rank(&rivals, &all_pairs(2), false);
    let (separated, moved) = records.rank(&rivals, &all_pairs(2), true);
    assert!(fixed > 20.0 && moved < 2.0 && separated.is_empty(), "{fixed} nats, {moved} once moved");
}

#[test]
fn a_gentle_controller_keeps_the_ball_of_rigs_that_bring_none() {
    let own = project().plant.unwrap();
    let slow = Model { gain_mm_per_s2_per_percent: 60.0, drag_per_s: 0.4, ..own.clone() };
    let delay = Some(plant::effects::SensorDelay { delay_s: 0.15 });
    let late = Model { effects: Effects { sensor_delay: delay, ..own.effects.clone() }, ..own.clone() };
    let arm = Model { gain_mm_per_s2_per_percent: 15.77, pipe_length_mm: 180.0, effects: Effects::default(), ..own };
    for model in [slow, late, arm] {
        let desk = Desk::gentle(&model, 0.02).unwrap();
        let rivals = [("believed", model)];
        let list = candidates(&desk, &rivals);
        let safe = list.iter().filter(|candidate| fly_all(candidate, &rivals, &desk).is_some()).count();
        assert!(safe >= 5, "{safe} of {} are safe for {:?}", list.len(), rivals[0].1);
    }
}

#[test]
fn a_rig_whose_hover_is_no_duty_is_not_flown() {
    let model = Model { hover_duty_percent: -3.0, ..project().plant.unwrap() };
    assert!(Desk::gentle(&model, 0.02).is_none());
}
