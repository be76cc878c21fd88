//! The campaign of the optional signals: faults that only a rig with tachometer and second sensor detects, and faults
//! that it survives.

use super::faults::{Case, DOUBTFUL, FAN, Lasting, Mishap, SECOND, SENSOR};
use super::{check, fly, logged};
use crate::flight::vocabulary::{Cycle, End, Fault as Ended, Mode};
use crate::report::flight::signals::Signals;
use config::Tables;
use hal::emulator::Fault;
use std::path::Path;

/// The project's rig with all tables that its config has as comments.
pub(crate) fn rich() -> Tables {
    let text = include_str!("../../../../../config.toml");
    let shown = text.find("# [rig.tachometer]").unwrap()..text.find("[bus]").unwrap();
    let uncommented = |line: &str| line.strip_prefix('#').unwrap_or(line).trim_start().to_owned() + "\n";
    let signals: String = text[shown.clone()].lines().map(uncommented).collect();
    let mut whole = text.to_owned();
    whole.replace_range(shown, &signals);
    let whole =
        ["second_sensor_mm =", "tachometer ="].iter().fold(whole, |all, key| all.replace(&format!("# {key}"), key));
    let tables: Tables = toml::from_str(&whole).unwrap();
    let observer = tables.observer.unwrap();
    assert!(observer.second_sensor_mm.is_some() && observer.tachometer.is_some());
    assert_eq!((tables.check(), tables.check_words()), (Ok(()), Ok(())));
    tables
}

fn wires(chips: &'static [u8], fault: Fault) -> Case {
    Case { mishap: Mishap::Wires { chips, register: None, fault }, lasting: Lasting::ForEver }
}

fn lasting(mishap: Mishap) -> Case {
    Case { mishap, lasting: Lasting::ForEver }
}

#[test]
fn a_fan_that_stalls_sensors_that_disagree_and_the_faults_of_any_rig_end_the_flight_within_their_bounds() {
    let tables = rich();
    let cases = [
        lasting(Mishap::FanStalled),
        lasting(Mishap::TachometerCut),
        // With the other sign a ball near the bottom would be beyond the pipe, which is refused as no ball.
        lasting(Mishap::SecondOff { mm: -60.0 }),
        lasting(Mishap::BallLost),
        lasting(DOUBTFUL),
        lasting(Mishap::Power),
        lasting(Mishap::Pause { seconds: 0.6 }),
        wires(&[SENSOR, SECOND], Fault::Nack),
        wires(&[SENSOR, SECOND], Fault::Timeout { seconds: 0.1 }),
        wires(&[FAN], Fault::Nack),
        wires(&[FAN], Fault::StuckLow),
        wires(&[SENSOR, SECOND, FAN], Fault::StuckHigh),
    ];
    for (k, case) in (0..).zip(cases) {
        for seed in 0..3 {
            check(&tables, case, 100 * seed + k);
        }
    }
}

#[test]
fn a_stalled_fan_and_sensors_apart_are_named_with_their_numbers() {
    let tables = rich();
    let stalled = fly(&tables, lasting(Mishap::FanStalled), 7).outcome;
    let Some(Ended::FanStalled { duty_percent, for_s }) = stalled.fault else { panic!("{stalled:?}") };
    assert!(duty_percent >= 10.0 && for_s >= 0.5, "{stalled:?}");
    let apart = fly(&tables, lasting(Mishap::SecondOff { mm: 60.0 }), 7).outcome;
    let Some(Ended::SensorsDisagree { first_mm, second_mm, for_s }) = apart.fault else { panic!("{apart:?}") };
    assert!((first_mm - second_mm - 60.0).abs() < 15.0 && for_s >= 0.2, "{apart:?}");
}

#[test]
fn a_flight_goes_on_by_the_other_sensor_when_one_is_silent_and_says_so_once() {
    let tables = rich();
    for (chip, name) in [(&[SENSOR][..], "the first range"), (&[SECOND], "the second range")] {
        for fault in [Fault::Nack, Fault::StuckLow] {
            let flown = fly(&tables, wires(chip, fault), 3);
            assert_eq!((flown.outcome.end, flown.outcome.fan_still_on), (End::Finished, None), "{name} {fault:?}");
            let log = logged::parse(Path::new("f.mcap"), &flown.log).unwrap();
            let said = log.events.iter().filter(|event| event.kind == "fault" && event.text.contains(name)).count();
            assert_eq!(said, 1, "{name} {fault:?}: {:?}", log.events);
            let last = &log.cycles[log.cycles.len() - 50..];
            assert!(last.iter().all(|cycle| cycle.mode == Mode::Flying), "{name} {fault:?}");
            let off = |mm: f64| (mm - 300.0).abs() < 60.0;
            assert!(last.iter().all(|cycle| cycle.position_mm.is_some_and(off)), "{name} {fault:?}");
        }
    }
}

/// Positions that the controller used after the fault, where a sensor marks its readings as not valid.
fn doubted(case: Case) -> (super::Flown, Vec<Cycle>) {
    let flown = fly(&rich(), case, 3);
    let cycles = logged::parse(Path::new("f.mcap"), &flown.log).unwrap().cycles;
    (flown, cycles)
}

#[test]
fn readings_of_either_sensor_that_it_does_not_vouch_for_are_not_fresh_and_not_flown_by() {
    let last = |cycles: &[Cycle]| cycles[cycles.len() - 50..].to_vec();
    let (first, cycles) = doubted(lasting(Mishap::Doubtful { sensors: &[SENSOR] }));
    assert_eq!(first.outcome.end, End::Finished);
    assert!(
        last(&cycles).iter().all(|cycle| !cycle.fresh && cycle.mode == Mode::Flying && cycle.position2_mm.is_some())
    );
    let (second, cycles) = doubted(lasting(Mishap::Doubtful { sensors: &[SECOND] }));
    assert_eq!(second.outcome.end, End::Finished);
    assert!(last(&cycles).iter().all(|cycle| cycle.fresh && cycle.position2_mm.is_none()));
    let (both, cycles) = doubted(lasting(DOUBTFUL));
    assert!(matches!(both.outcome.fault, Some(Ended::DoubtfulRange { .. })), "{:?}", both.outcome);
    assert!(!cycles.last().unwrap().fresh);
    let log = logged::parse(Path::new("f.mcap"), &both.log).unwrap();
    assert!(
        log.events.iter().any(|event| event.kind == "fault" && event.text.contains("range status 4")),
        "{:?}",
        log.events
    );
}

#[test]
fn a_fan_driver_that_cannot_be_written_is_stopped_by_its_output_enable() {
    let flown = fly(&rich(), wires(&[FAN], Fault::Nack), 5);
    assert!(flown.outcome.fan_still_on.is_some(), "the loop does not trust the pin alone");
    assert_eq!(flown.bus.with_world(|scene| scene.fan_now()), 0.0);
}

#[test]
fn a_flight_with_all_signals_to_which_nothing_happens_ends_well_with_the_fan_off() {
    let flown = fly(&rich(), lasting(Mishap::Pause { seconds: 0.0 }), 1);
    assert_eq!((flown.outcome.end, flown.outcome.fan_still_on), (End::Finished, None));
    assert_eq!(flown.bus.with_world(|scene| scene.fan_now()), 0.0);
    let log = logged::parse(Path::new("f.mcap"), &flown.log).unwrap();
    assert!(log.events.iter().all(|event| event.kind != "fault"), "{:?}", log.events);
}

#[test]
fn the_log_holds_the_speed_that_belongs_to_the_duty_and_the_position_as_the_second_sensor_sees_it() {
    let tables = rich();
    let flown = fly(&tables, lasting(Mishap::Pause { seconds: 0.0 }), 2);
    let cycles = logged::parse(Path::new("f.mcap"), &flown.log).unwrap().cycles;
    let late = &cycles[150..];
    let mean = |of: fn(&Cycle) -> f64| late.iter().map(of).sum::<f64>() / late.len() as f64;
    let (rpm, duty) = (mean(|cycle| cycle.fan_rpm.unwrap()), mean(|cycle| cycle.duty_percent));
    assert!((rpm / (2000.0 * duty / 21.4) - 1.0).abs() < 0.01, "{rpm} rpm at {duty} %");

    // Two independent noises of 2.5 mm, and two roundings to a millimetre.
    let apart = Signals::of(late).second_sensor.unwrap();
    let sigma_mm = (2.0 * 2.5_f64.powi(2) + 2.0 / 12.0).sqrt();
    assert!((apart.sigma_mm / sigma_mm - 1.0).abs() < 0.2, "{apart:?}, expected {sigma_mm} mm");
    assert!(apart.mean_mm.abs() < 1.0 && apart.fresh_percent > 95.0, "{apart:?}");
}
