//! Tests of the pilot with a tachometer and a second sensor.

use super::{T, pilot_holding};
use crate::flight::pilot::{Pilot, Seen, Senses, Signals};
use crate::flight::vocabulary::{Fault, Mode, Which};
use config::{SecondSensor, Tachometer};

const NOTHING: Seen = Seen::Nothing(None);

fn pilot() -> Pilot {
    let tachometer = Tachometer { line: 1, pulses_per_revolution: 2, hover_rpm: 2400.0, stalled_after_s: 0.49 };
    let second_sensor: SecondSensor =
        toml::from_str("xshut_line = 2\naddress = 0x30\nto_bottom_mm = 583.0\ndisagree_mm = 40.0\ndisagree_s = 0.19")
            .unwrap();
    let mut pilot = pilot_holding(300.0, 60.0);
    pilot.orders.signals = Signals { tachometer: Some(tachometer), second_sensor: Some(second_sensor) };
    pilot
}

/// Flies with constant senses for `cycles` cycles from `from` on; the cycle in which it stopped, if it did.
fn fly(pilot: &mut Pilot, from: u32, cycles: u32, senses: Senses) -> Option<u32> {
    (0..cycles).find(|k| pilot.decide(T * f64::from(from + k), senses).mode == Mode::Stopped)
}

const fn senses(ball: Seen, second: Seen, rpm: f64) -> Senses {
    Senses { ball, second: Some(second), fan_rpm: Some(rpm) }
}

#[test]
fn a_driven_fan_without_edges_stops_the_flight_after_its_time_and_not_before() {
    let mut pilot = pilot();
    let stands = senses(Seen::Ball(250.0), Seen::Ball(250.0), 0.0);
    // The first cycle had no duty yet; 25 more are 0.5 s.
    assert_eq!(fly(&mut pilot, 0, 60, stands), Some(26));
    assert!(matches!(pilot.fault(), Some(Fault::FanStalled { for_s, .. }) if (for_s - 0.5).abs() < 1e-9));
}

#[test]
fn one_edge_in_time_is_enough_and_a_fan_that_is_off_may_stand() {
    let mut pilot = pilot();
    for k in 0..10 {
        assert_eq!(fly(&mut pilot, 20 * k, 19, senses(Seen::Ball(250.0), Seen::Ball(250.0), 0.0)), None);
        assert_eq!(fly(&mut pilot, 20 * k + 19, 1, senses(Seen::Ball(250.0), Seen::Ball(250.0), 900.0)), None);
    }
    let mut waiting = self::pilot();
    assert_eq!(fly(&mut waiting, 0, 200, senses(NOTHING, NOTHING, 0.0)), None);
}

#[test]
fn sensors_that_disagree_for_too_long_stop_the_flight_and_for_a_moment_do_not() {
    let mut pilot = pilot();
    let (agree, apart) =
        (senses(Seen::Ball(250.0), Seen::Ball(289.0), 2400.0), senses(Seen::Ball(250.0), Seen::Ball(291.0), 2400.0));
    for k in 0..5 {
        assert_eq!(fly(&mut pilot, 20 * k, 10, apart), None);
        assert_eq!(fly(&mut pilot, 20 * k + 10, 10, agree), None);
    }
    assert_eq!(fly(&mut pilot, 100, 30, apart), Some(10));
    let fault = pilot.fault();
    assert!(matches!(fault, Some(Fault::SensorsDisagree { first_mm: 250.0, second_mm: 291.0, .. })), "{fault:?}");
}

#[test]
fn two_disagreements_with_silence_between_them_are_not_one_that_lasted() {
    let mut pilot = pilot();
    let apart = senses(Seen::Ball(250.0), Seen::Ball(291.0), 2400.0);
    let alone = senses(Seen::Ball(250.0), NOTHING, 2400.0);
    assert_eq!(fly(&mut pilot, 0, 1, apart), None);
    assert_eq!(fly(&mut pilot, 1, 50, alone), None);
    assert_eq!(fly(&mut pilot, 51, 1, apart), None);
}

#[test]
fn the_second_sensor_stands_in_for_a_silent_first_and_the_flight_stops_when_both_are_silent() {
    let mut pilot = pilot();
    fly(&mut pilot, 0, 10, senses(Seen::Ball(250.0), Seen::Ball(252.0), 2400.0));
    assert_eq!(pilot.advisory(), None);
    assert_eq!(fly(&mut pilot, 10, 100, senses(NOTHING, Seen::Ball(260.0), 2400.0)), None);
    assert!(matches!(pilot.advisory(), Some(Fault::OneSensorSilent { which: Which::First, .. })));
    let decision = pilot.decide(T * 110.0, senses(NOTHING, Seen::Ball(260.0), 2400.0));
    assert_eq!((decision.mode, decision.position_mm), (Mode::Flying, Some(260.0)));
    // coast_s is 0.3 s.
    assert_eq!(fly(&mut pilot, 111, 60, senses(NOTHING, NOTHING, 2400.0)), Some(15));
}

#[test]
fn a_silent_second_sensor_is_said_and_changes_nothing() {
    let mut pilot = pilot();
    assert_eq!(fly(&mut pilot, 0, 100, senses(Seen::Ball(250.0), NOTHING, 2400.0)), None);
    assert!(matches!(pilot.advisory(), Some(Fault::OneSensorSilent { which: Which::Second, .. })));
    assert_eq!(pilot.mode(), Mode::Flying);
}

#[test]
fn a_second_sensor_does_not_begin_a_flight_that_the_first_does_not_see() {
    let mut pilot = pilot();
    fly(&mut pilot, 0, 50, senses(NOTHING, Seen::Ball(250.0), 0.0));
    assert_eq!(pilot.mode(), Mode::Waiting);
}
