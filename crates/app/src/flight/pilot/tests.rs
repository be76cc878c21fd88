//! Tests of the pilot.

mod experiments;
mod signals;

use super::{Orders, Pilot, Seen, Signals};
use crate::flight::command::{Command, GainChange, Refusal};
use crate::flight::experiment::{Experiment, Limits, Segment};
use crate::flight::vocabulary::{Fault, Mode};
use config::{Safety, Stuck};
use control::compensation::Compensation;
use control::controller::{Controllers, Kind};
use control::pid::{DerivativeOn, Pid};
use control::regulator::Regulator;
use control::waveform::Waveform;

const T: f64 = 0.02;

fn segment(duration_s: f64) -> Segment {
    let setpoint = Waveform::Constant { value: 300.0 };
    Segment { duration_s, setpoint_mm: Some(setpoint), ..Segment::default() }
}

fn pilot(segments: Vec<Segment>) -> Pilot {
    let limits = Limits { position_min_mm: Some(50.0), position_max_mm: Some(550.0) };
    let pid = Pid::new(0.01, 5.0, 0.3, 10.0, DerivativeOn::Measurement);
    Pilot::new(Orders {
        regulator: Regulator::new(Controllers::only_pid(pid), None, T).unwrap(),
        compensation: Compensation::bare(21.4),
        safety: Safety {
            setpoint_min_mm: 20.0,
            setpoint_max_mm: 560.0,
            duty_min_percent: 5.0,
            duty_max_percent: 40.0,
            coast_s: 0.3,
            stall_s: 0.5,
            stuck: None,
        },
        experiment: Experiment { title: "t".into(), limits, segments: segments.into() },
        reading_period_s: T,
        signals: Signals::default(),
        top_mm: 583.0,
    })
}

/// A pilot that holds `setpoint_mm` for `duration_s`.
pub(crate) fn pilot_holding(setpoint_mm: f64, duration_s: f64) -> Pilot {
    let setpoint = Some(Waveform::Constant { value: setpoint_mm });
    pilot(vec![Segment { setpoint_mm: setpoint, ..segment(duration_s) }])
}

/// Flies `pilot` through `seen`, one a period, and returns the last mode and duty.
fn fly(pilot: &mut Pilot, start_s: f64, seen: &[Seen]) -> (Mode, f64) {
    let mut last = (pilot.mode(), 0.0);
    for (k, seen) in seen.iter().enumerate() {
        let decision = pilot.decide(start_s + T * k as f64, *seen);
        last = (decision.mode, decision.duty.percent());
    }
    last
}

#[test]
fn the_fan_is_off_until_the_first_position() {
    let mut pilot = pilot(vec![segment(60.0)]);
    assert_eq!(fly(&mut pilot, 0.0, &[Seen::Nothing(None); 20]), (Mode::Waiting, 0.0));
    assert_eq!(fly(&mut pilot, 0.4, &[Seen::Ball(0.0)]).0, Mode::Flying);
}

#[test]
fn a_ball_that_never_shows_ends_the_wait_with_its_cause() {
    let mut pilot = pilot(vec![segment(60.0)]);
    let no_ball = Fault::NoBall { reported_mm: 8190 };
    assert_eq!(fly(&mut pilot, 0.0, &[Seen::Nothing(Some(no_ball)); 250]).0, Mode::Waiting);
    assert_eq!(fly(&mut pilot, 5.0, &[Seen::Nothing(Some(no_ball)); 3]), (Mode::Stopped, 0.0));
    assert_eq!(pilot.fault(), Some(no_ball));
}

#[test]
fn a_lost_ball_is_no_silent_sensor_where_the_loop_is_faster_than_the_sensor() {
    let mut pilot = pilot(vec![segment(60.0)]);
    fly(&mut pilot, 0.0, &[Seen::Ball(250.0); 10]);
    let lost = Fault::NoBall { reported_mm: 2580 };
    let (report, none) = (Seen::Nothing(Some(lost)), Seen::Nothing(None));
    assert_eq!(fly(&mut pilot, 0.2, &[report, none].repeat(10)).0, Mode::Stopped);
    assert_eq!(pilot.fault(), Some(lost));
    // A report of long ago does not explain a silence.
    let mut pilot = self::pilot(vec![segment(60.0)]);
    fly(&mut pilot, 0.0, &[Seen::Ball(250.0); 10]);
    fly(&mut pilot, 0.2, &[&[report][..], &[none; 20]].concat());
    assert!(matches!(pilot.fault(), Some(Fault::SensorSilent { .. })), "{:?}", pilot.fault());
}

#[test]
fn a_ball_below_its_setpoint_gets_more_air_than_hover_and_one_above_less() {
    let mut low = pilot(vec![segment(60.0)]);
    assert!(fly(&mut low, 0.0, &[Seen::Ball(200.0); 3]).1 > 21.4);
    let mut high = pilot(vec![segment(60.0)]);
    assert!(fly(&mut high, 0.0, &[Seen::Ball(400.0); 3]).1 < 21.4);
}

#[test]
fn a_silent_sensor_means_hover_for_a_while_and_then_off() {
    let mut pilot = pilot(vec![segment(60.0)]);
    fly(&mut pilot, 0.0, &[Seen::Ball(250.0); 10]);
    assert_eq!(fly(&mut pilot, 0.2, &[Seen::Nothing(None); 2]).0, Mode::Flying);
    assert_eq!(fly(&mut pilot, 0.24, &[Seen::Nothing(None); 5]), (Mode::Coasting, 21.4));
    assert_eq!(fly(&mut pilot, 0.34, &[Seen::Nothing(None); 10]), (Mode::Stopped, 0.0));
    assert!(matches!(pilot.fault(), Some(Fault::SensorSilent { silent_s }) if silent_s > 0.3));
}

#[test]
fn a_position_after_coasting_flies_on_without_a_kick_of_the_derivative() {
    let mut pilot = pilot(vec![segment(60.0)]);
    let before = fly(&mut pilot, 0.0, &[Seen::Ball(300.0); 10]).1;
    fly(&mut pilot, 0.2, &[Seen::Nothing(None); 10]);
    let (mode, after) = fly(&mut pilot, 0.4, &[Seen::Ball(280.0)]);
    // K_p·20 mm = 0.2 %; the derivative of the jump would have been 2 % or more.
    assert!(mode == Mode::Flying && (after - before - 0.2).abs() < 0.05, "{before} % became {after} %");
}

#[test]
fn leaving_the_band_turns_the_fan_off_but_taking_off_through_it_does_not() {
    let mut pilot = pilot(vec![segment(60.0)]);
    assert_eq!(fly(&mut pilot, 0.0, &[Seen::Ball(0.0), Seen::Ball(60.0)]).0, Mode::Flying);
    assert_eq!(fly(&mut pilot, 0.04, &[Seen::Ball(551.0)]), (Mode::Stopped, 0.0));
    assert!(matches!(pilot.fault(), Some(Fault::OutsideBand { .. })));
}

#[test]
fn an_open_loop_segment_drives_the_duty_within_the_safe_limits() {
    let duty = Waveform::Ramp { from: 0.0, to: 40.0, over_s: 1.0 };
    let open = Segment { duty_percent: Some(duty), setpoint_mm: None, ..segment(1.0) };
    let mut pilot = pilot(vec![open, segment(1.0)]);
    let decision = pilot.decide(0.0, Seen::Ball(0.0));
    assert_eq!((decision.mode, decision.duty.percent(), decision.control_percent), (Mode::OpenLoop, 5.0, None));
    assert!((pilot.decide(0.5, Seen::Ball(10.0)).duty.percent() - 20.0).abs() < 1e-9);
    assert_eq!(pilot.command(Command::Setpoint(300.0)), Err(Refusal::OpenLoop));
    assert_eq!(pilot.decide(1.0, Seen::Ball(20.0)).mode, Mode::Flying);
    assert!(!pilot.is_over(1.9) && pilot.is_over(2.0));
}

#[test]
fn an_excitation_shifts_the_control_by_itself() {
    let excited = Segment { excitation_percent: Some(Waveform::Constant { value: 0.5 }), ..segment(60.0) };
    let (mut with, mut without) = (pilot(vec![excited]), pilot(vec![segment(60.0)]));
    let (with, without) = (with.decide(0.0, Seen::Ball(250.0)), without.decide(0.0, Seen::Ball(250.0)));
    assert!((with.control_percent.unwrap() - without.control_percent.unwrap() - 0.5).abs() < 1e-12);
}

#[test]
fn commands_hold_a_setpoint_stop_fly_and_return_to_the_programme() {
    let mut pilot = pilot(vec![segment(60.0)]);
    fly(&mut pilot, 0.0, &[Seen::Ball(250.0); 3]);
    pilot.command(Command::Setpoint(123.0)).unwrap();
    assert_eq!(pilot.decide(0.06, Seen::Ball(250.0)).setpoint_mm, Some(123.0));
    pilot.command(Command::Programme).unwrap();
    assert_eq!(pilot.decide(0.08, Seen::Ball(250.0)).setpoint_mm, Some(300.0));
    pilot.command(Command::Stop).unwrap();
    assert_eq!(fly(&mut pilot, 0.1, &[Seen::Ball(250.0)]), (Mode::Stopped, 0.0));
    pilot.command(Command::Fly).unwrap();
    // The ball lies at the bottom now, below the experiment's band, and takes off through it once more.
    assert_eq!(fly(&mut pilot, 0.12, &[Seen::Ball(0.0), Seen::Ball(1.0)]).0, Mode::Flying);
}

#[test]
fn commands_beyond_the_limits_are_refused_with_them() {
    let mut pilot = pilot(vec![segment(60.0)]);
    for asked in [5.0, 561.0, f64::NAN] {
        let refusal = pilot.command(Command::Setpoint(asked)).unwrap_err();
        assert!(refusal.to_string().contains("20 to 560"), "{refusal}");
    }
    let change = GainChange { ti_s: Some(-1.0), ..GainChange::default() };
    let before = pilot.gains();
    assert!(matches!(pilot.command(Command::Gains(change)), Err(Refusal::Gain(_))));
    assert_eq!(pilot.gains(), before);
}

/// The controllers and the observer of the project's config.
fn all() -> Regulator {
    let tables: config::Tables = toml::from_str(include_str!("../../../../../config.toml")).unwrap();
    Regulator::new(tables.controller.unwrap(), tables.observer.as_ref(), T).unwrap()
}

#[test]
fn another_controller_takes_over_on_command_without_moving_the_duty() {
    let mut pilot = pilot(vec![segment(60.0)]);
    pilot.orders.regulator = all();
    let before = fly(&mut pilot, 0.0, &[Seen::Ball(300.0); 100]).1;
    for (k, kind) in [Kind::Mpc, Kind::Cascade, Kind::Lqg, Kind::StateFeedback, Kind::Pid].into_iter().enumerate() {
        pilot.command(Command::Controller(kind)).unwrap();
        assert_eq!(pilot.controller(), kind);
        let after = fly(&mut pilot, 2.0 + T * k as f64, &[Seen::Ball(300.0)]).1;
        assert!((after - before).abs() < 0.01, "{kind:?}: {before} % became {after} %");
    }
}

#[test]
fn the_observers_estimate_is_told_where_there_is_an_observer() {
    let mut pilot = pilot(vec![segment(60.0)]);
    assert_eq!(pilot.decide(0.0, Seen::Ball(300.0)).estimate, None);
    pilot.orders.regulator = all();
    let told = (1..200).filter_map(|k| pilot.decide(T * f64::from(k), Seen::Ball(300.0)).estimate).last().unwrap();
    assert!((told.position_mm - 300.0).abs() < 5.0 && told.fan.is_finite() && told.disturbance.is_finite(), "{told:?}");
}

#[test]
fn a_controller_that_the_config_does_not_hold_is_refused_with_those_that_it_does() {
    let mut pilot = pilot(vec![segment(60.0)]);
    let refusal = pilot.command(Command::Controller(Kind::Lqg)).unwrap_err().to_string();
    assert!(refusal.contains("[controller.lqg]") && refusal.ends_with("it has pid"), "{refusal}");
}

#[test]
fn the_observers_controller_acts_between_readings_and_the_filters_waits_for_them() {
    for (kind, moves) in [(Kind::Lqg, true), (Kind::Pid, false)] {
        let mut pilot = pilot(vec![segment(60.0)]);
        pilot.orders.regulator = all();
        pilot.command(Command::Controller(kind)).unwrap();
        let before = fly(&mut pilot, 0.0, &[Seen::Ball(250.0); 10]).1;
        let after = fly(&mut pilot, 0.2, &[Seen::Nothing(None)]).1;
        assert_eq!(after != before, moves, "{kind:?}: {before} %, {after} %");
    }
}

#[test]
fn a_ball_that_is_pushed_and_does_not_move_turns_the_fan_off_within_the_time_stated() {
    let stuck = Some(Stuck { control_percent: 1.0, after_s: 1.0 });
    let mut jammed = pilot(vec![segment(60.0)]);
    jammed.orders.safety.stuck = stuck;
    // 200 mm below its setpoint: 2 % of control, and noise that alone would move no ball.
    let noise = |k: u32| Seen::Ball(100.0 + 2.5 * f64::from(k * 7 % 5));
    let cycles = (1..=60).find(|k| fly(&mut jammed, T * f64::from(*k), &[noise(*k)]).0 == Mode::Stopped);
    // after_s / period, and the cycle in which the push began.
    assert!(matches!(cycles, Some(50..=52)), "{cycles:?}");
    assert!(matches!(jammed.fault(), Some(Fault::BallStuck { control_percent: 1.0.., .. })), "{:?}", jammed.fault());
    assert_eq!(jammed.decide(2.0, Seen::Ball(100.0)).duty.percent(), 0.0);

    let mut rising = pilot(vec![segment(60.0)]);
    rising.orders.safety.stuck = stuck;
    let seen: Vec<Seen> = (0..100).map(|k| Seen::Ball(60.0 + 0.6 * f64::from(k))).collect();
    assert_eq!(fly(&mut rising, 0.0, &seen).0, Mode::Flying);
}

#[test]
fn a_ball_that_lies_at_the_end_towards_which_it_is_pushed_is_not_stuck_and_one_that_is_pushed_away_from_it_is() {
    let lies = |at_mm: f64, wanted_mm: f64| {
        let setpoint = Some(Waveform::Constant { value: wanted_mm });
        let mut pilot = pilot(vec![Segment { setpoint_mm: setpoint, ..segment(60.0) }]);
        pilot.orders.safety.stuck = Some(Stuck { control_percent: 0.2, after_s: 1.0 });
        pilot.orders.experiment.limits = Limits::default();
        fly(&mut pilot, 0.0, &[Seen::Ball(at_mm); 100]).0
    };
    assert_eq!(lies(2.0, -60.0), Mode::Flying);
    assert_eq!(lies(2.0, 60.0), Mode::Stopped);
    assert_eq!(lies(580.0, 640.0), Mode::Flying);
    assert_eq!(lies(580.0, 520.0), Mode::Stopped);
    assert_eq!(lies(100.0, 40.0), Mode::Stopped);
}

#[test]
fn without_the_table_no_ball_is_stuck() {
    let mut pilot = pilot(vec![segment(60.0)]);
    assert_eq!(fly(&mut pilot, 0.0, &[Seen::Ball(100.0); 1000]).0, Mode::Flying);
}

proptest::proptest! {
    #[test]
    fn whatever_is_seen_the_duty_is_off_or_within_the_safe_limits(
        seen in proptest::collection::vec((proptest::option::of(-1e4..1e4_f64), 0.0..0.1_f64), 1..200)
    ) {
        let mut pilot = pilot(vec![segment(2.0), segment(2.0)]);
        let mut t = 0.0;
        for (position, dt) in seen {
            t += dt;
            let duty = pilot.decide(t, position.map_or(Seen::Nothing(None), Seen::Ball)).duty.percent();
            proptest::prop_assert!(duty == 0.0 || (5.0..=40.0).contains(&duty), "{duty} %");
        }
    }
}

#[test]
fn a_segment_is_over_when_the_ball_has_gone_far_enough() {
    let drive = Segment {
        duty_about_hover_percent: Some(Waveform::Constant { value: 0.8 }),
        setpoint_mm: None,
        until_above_mm: Some(400.0),
        ..segment(10.0)
    };
    let mut pilot = pilot(vec![drive, segment(1.0)]);
    let duty = pilot.decide(0.0, Seen::Ball(390.0)).duty;
    assert!((duty.percent() - 22.2).abs() < 1e-12, "{duty:?}");
    assert_eq!(pilot.decide(T, Seen::Ball(399.0)).mode, Mode::OpenLoop);
    assert_eq!(pilot.decide(2.0 * T, Seen::Ball(401.0)).mode, Mode::Flying);
    assert!(!pilot.is_over(0.9) && pilot.is_over(1.0 + 3.0 * T));
}

#[test]
fn a_ball_that_swings_out_goes_on_to_the_last_segment_and_its_gains() {
    let gains = GainChange { kp_per_mm: Some(0.05), ..GainChange::default() };
    let wild = || Segment { gains: Some(gains), back_off_beyond_mm: Some(100.0), ..segment(5.0) };
    let mut pilot = pilot(vec![wild(), wild(), segment(2.0)]);
    let kp = |pilot: &Pilot| pilot.gains().unwrap().kp_per_mm;
    let _ = pilot.decide(0.0, Seen::Ball(250.0));
    let _ = pilot.decide(T, Seen::Ball(250.0));
    assert_eq!(kp(&pilot), 0.05);
    let _ = pilot.decide(2.0 * T, Seen::Ball(401.0));
    assert_eq!(kp(&pilot), 0.01, "the gains of the config are back");
    assert!(!pilot.is_over(2.0) && pilot.is_over(2.0 + 3.0 * T));
}

#[test]
fn gains_commanded_in_a_segment_are_those_that_come_back() {
    let gains = GainChange { kp_per_mm: Some(0.05), td_s: Some(0.0), ..GainChange::default() };
    let mut pilot = pilot(vec![Segment { gains: Some(gains), ..segment(0.1) }, segment(1.0)]);
    let now = |pilot: &Pilot| pilot.gains().map(|gains| (gains.kp_per_mm, gains.td_s)).unwrap();
    let _ = pilot.decide(0.0, Seen::Ball(300.0));
    let _ = pilot.decide(T, Seen::Ball(300.0));
    pilot.command(Command::Gains(GainChange { kp_per_mm: Some(0.02), ..GainChange::default() })).unwrap();
    let _ = pilot.decide(2.0 * T, Seen::Ball(300.0));
    assert_eq!(now(&pilot), (0.05, 0.0), "the segment keeps its own");
    let _ = pilot.decide(0.2, Seen::Ball(300.0));
    assert_eq!(now(&pilot), (0.02, 0.3), "of the segment's gains none stays");
    pilot.command(Command::Undo).unwrap();
    for k in 0..50 {
        let _ = pilot.decide(0.22 + T * f64::from(k), Seen::Ball(300.0));
    }
    assert_eq!(now(&pilot), (0.01, 0.3));
}
