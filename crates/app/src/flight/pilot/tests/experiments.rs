//! Tests of experiments that are started in flight.

use super::{fly, pilot, segment};
use crate::flight::command::{Command, GainChange, Refusal};
use crate::flight::experiment::offers::Offer;
use crate::flight::experiment::{Experiment, Limits, Segment};
use crate::flight::name::Name;
use crate::flight::pilot::{Pilot, Seen};
use crate::flight::vocabulary::Mode;
use control::waveform::Waveform;

fn name(word: &str) -> Name {
    Name::new(word).unwrap()
}

/// A pilot that holds 300 mm for a minute and offers a second at 200 mm by another gain and a second of duty.
fn offering() -> Pilot {
    let at_200 = Segment {
        setpoint_mm: Some(Waveform::Constant { value: 200.0 }),
        gains: Some(GainChange { kp_per_mm: Some(0.02), ..GainChange::default() }),
        ..segment(1.0)
    };
    let pulse = Segment { setpoint_mm: None, duty_percent: Some(Waveform::Constant { value: 22.0 }), ..segment(1.0) };
    let offer = |word, segments: Vec<Segment>| Offer {
        name: name(word),
        experiment: Experiment { title: word.into(), limits: Limits::default(), segments: segments.into() },
    };
    pilot(vec![segment(60.0)]).offering(vec![offer("low", vec![at_200]), offer("pulse", vec![pulse])])
}

#[test]
fn an_experiment_is_flown_from_its_start_and_then_the_programme_goes_on_with_its_own_gains() {
    let mut pilot = offering();
    fly(&mut pilot, 0.0, &[Seen::Ball(300.0); 50]);
    pilot.command(Command::Experiment(name("low"))).unwrap();
    fly(&mut pilot, 1.0, &[Seen::Ball(300.0); 45]);
    assert_eq!((pilot.setpoint_mm(1.9), pilot.experiment()), (Some(200.0), Some(name("low"))));
    assert_eq!(pilot.gains().unwrap().kp_per_mm, 0.02);
    fly(&mut pilot, 1.9, &[Seen::Ball(300.0); 10]);
    assert_eq!((pilot.setpoint_mm(2.1), pilot.experiment()), (Some(300.0), None));
    assert_eq!(pilot.gains().unwrap().kp_per_mm, 0.01);
    assert!(!pilot.is_over(2.1) && pilot.is_over(60.1));
}

#[test]
fn an_experiment_drives_the_fan_too_and_a_setpoint_or_the_programme_ends_one() {
    let mut pilot = offering();
    fly(&mut pilot, 0.0, &[Seen::Ball(300.0); 5]);
    pilot.command(Command::Experiment(name("pulse"))).unwrap();
    assert_eq!(fly(&mut pilot, 0.1, &[Seen::Ball(300.0); 5]), (Mode::OpenLoop, 22.0));
    assert_eq!(pilot.command(Command::Setpoint(250.0)), Err(Refusal::OpenLoop));
    pilot.command(Command::Programme).unwrap();
    assert_eq!(fly(&mut pilot, 0.2, &[Seen::Ball(300.0); 5]).0, Mode::Flying);
    pilot.command(Command::Experiment(name("low"))).unwrap();
    pilot.command(Command::Setpoint(250.0)).unwrap();
    assert_eq!(pilot.experiment(), None);
    fly(&mut pilot, 0.3, &[Seen::Ball(300.0); 5]);
    assert_eq!(pilot.setpoint_mm(0.4), Some(250.0));
}

#[test]
fn an_experiment_that_is_not_on_offer_or_asked_for_with_the_fan_off_is_refused_and_a_stop_ends_one() {
    let mut pilot = offering();
    let unknown = name("high");
    assert_eq!(pilot.command(Command::Experiment(unknown)), Err(Refusal::Experiment { asked: unknown }));
    fly(&mut pilot, 0.0, &[Seen::Ball(300.0); 5]);
    pilot.command(Command::Experiment(name("low"))).unwrap();
    pilot.command(Command::Stop).unwrap();
    assert_eq!(pilot.experiment(), None);
    assert_eq!(pilot.command(Command::Experiment(name("low"))), Err(Refusal::Stopped));
    pilot.command(Command::Fly).unwrap();
    assert_eq!(fly(&mut pilot, 0.2, &[Seen::Ball(300.0); 5]).0, Mode::Flying);
    assert_eq!(pilot.setpoint_mm(0.3), Some(300.0));
}

#[test]
fn an_experiment_asked_for_before_the_first_position_leaves_a_programme_to_come_back_to() {
    let mut pilot = offering();
    pilot.command(Command::Experiment(name("low"))).unwrap();
    assert_eq!(fly(&mut pilot, 0.0, &[Seen::Ball(300.0); 60]).0, Mode::Flying);
    assert_eq!((pilot.setpoint_mm(1.2), pilot.experiment()), (Some(300.0), None));
}
