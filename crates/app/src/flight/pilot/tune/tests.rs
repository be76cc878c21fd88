//! Tests that numbers change without a bump, as a whole or not at all, and back.

use crate::flight::command::{Command, GainChange, Refusal};
use crate::flight::experiment::{Experiment, Limits, Segment};
use crate::flight::pilot::{Orders, Pilot, Seen, Signals};
use config::Tables;
use control::controller::Kind;
use control::inputs::Source;
use control::numbers::{COUNT, Numbers, Parameter, Values};
use control::predistortion::Predistortion;
use control::regulator::Regulator;
use control::schedule::Schedule;
use control::waveform::Waveform;

const T: f64 = 0.02;

/// A flight of the project's rig, whose ball is where `mm` says.
struct Flown {
    pilot: Pilot,
    cycles: u32,
}

impl Flown {
    fn with(change: impl FnOnce(&mut Tables)) -> Self {
        let mut tables: Tables = toml::from_str(include_str!("../../../../../../config.toml")).unwrap();
        change(&mut tables);
        let setpoint_mm = Some(Waveform::Constant { value: 300.0 });
        let segments = vec![Segment { duration_s: 600.0, setpoint_mm, ..Segment::default() }].into();
        let pilot = Pilot::new(Orders {
            regulator: Regulator::new(tables.controller.clone().unwrap(), tables.observer.as_ref(), T).unwrap(),
            compensation: tables.compensation.clone().unwrap(),
            safety: tables.safety.unwrap(),
            experiment: Experiment { title: "t".into(), limits: Limits::default(), segments },
            reading_period_s: T,
            signals: Signals::default(),
            top_mm: 583.0,
        });
        Self { pilot, cycles: 0 }
    }

    /// Duties of so many cycles.
    fn fly(&mut self, cycles: u32, mm: impl Fn(u32) -> f64) -> Vec<f64> {
        let flown = (0..cycles).map(|k| {
            let time_s = T * f64::from(self.cycles);
            self.cycles += 1;
            self.pilot.decide(time_s, Seen::Ball(mm(k))).duty.percent()
        });
        flown.collect()
    }

    fn send(&mut self, numbers: &[(&str, f64)]) -> Result<(), Refusal> {
        self.pilot.command(Command::Numbers(values(numbers)))
    }
}

fn values(numbers: &[(&str, f64)]) -> Values {
    let mut values = [None; COUNT];
    numbers.iter().for_each(|(name, value)| values[Parameter::named(name).unwrap()] = Some(*value));
    values
}

/// The largest change from one duty to the next.
fn largest_step(duties: &[f64]) -> f64 {
    duties.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
}

#[test]
fn no_number_of_any_controller_makes_the_duty_jump() {
    for kind in Kind::ALL.into_iter().filter(|kind| *kind != Kind::OpenLoop) {
        for (parameter, value) in Parameter::ALL.iter().zip(Flown::with(|_| ()).pilot.numbers().values()) {
            let Some(value) = value.filter(|value| *value != 0.0 && parameter.words.is_empty()) else { continue };
            let changed = if parameter.name == "observer.gate_sigma" { 6.0 } else { value * 0.9 };
            let mut flown = Flown::with(|tables| tables.controller.as_mut().unwrap().active = Some(kind));
            // 20 mm below the setpoint, at rest.
            flown.fly(300, |_| 280.0);
            let usual = largest_step(&flown.fly(50, |_| 280.0));
            flown.send(&[(parameter.name, changed)]).unwrap();
            let step = largest_step(&flown.fly(50, |_| 280.0));
            assert!(step < usual + 0.15, "{} at {}: {step:.3} beside {usual:.3}", parameter.name, kind.name());
        }
    }
}

#[test]
fn a_new_hover_leaves_the_duty_where_an_integral_has_found_it() {
    let mut flown = Flown::with(|_| ());
    flown.fly(500, |_| 298.0);
    let before = *flown.fly(1, |_| 298.0).last().unwrap();
    flown.send(&[("compensation.hover_duty_percent", 22.4)]).unwrap();
    let after = *flown.fly(40, |_| 298.0).last().unwrap();
    assert!((after - before).abs() < 0.05, "{before} to {after}");
    assert_eq!(flown.pilot.numbers().compensation.hover_duty_percent, 22.4);
}

#[test]
fn a_gain_that_is_lowered_while_the_fan_is_at_its_limit_leaves_nothing_in_the_integral() {
    let mut flown = Flown::with(|_| ());
    let gain = |kp_per_mm| Command::Gains(GainChange { kp_per_mm: Some(kp_per_mm), ..GainChange::default() });
    flown.fly(100, |_| 300.0);
    let hover = *flown.fly(1, |_| 300.0).last().unwrap();
    flown.pilot.command(gain(0.2)).unwrap();
    // 150 mm below: at the upper limit.
    assert_eq!(*flown.fly(40, |_| 150.0).last().unwrap(), 40.0);
    flown.pilot.command(gain(0.018)).unwrap();
    let back = *flown.fly(100, |_| 300.0).last().unwrap();
    assert!((back - hover).abs() < 0.5, "{hover} before, {back} after");
}

#[test]
fn a_transaction_is_in_force_as_a_whole_or_not_at_all() {
    let mut flown = Flown::with(|_| ());
    flown.fly(50, |_| 300.0);
    let before = flown.pilot.numbers().clone();
    let refused = flown.send(&[("lqg.fan", 0.5), ("observer.sensor_mm", -1.0)]).unwrap_err().to_string();
    assert_eq!(refused, "observer.sensor_mm = -1 is outside 0.001 to 1000");
    let refused = flown.send(&[("lqg.fan", 0.5), ("compensation.dead_zone.lower_percent", -0.1)]).unwrap_err();
    assert!(matches!(refused, Refusal::Absent("compensation.dead_zone.lower_percent")), "{refused}");
    let refused = flown.send(&[("compensation.hover_duty_percent", 60.0)]).unwrap_err().to_string();
    assert!(refused.contains("60 is outside 10 to 40"), "{refused}");
    assert_eq!(*flown.pilot.numbers(), before);
    flown.send(&[("lqg.fan", 0.5), ("observer.sensor_mm", 3.0)]).unwrap();
    let now = flown.pilot.numbers().clone();
    assert_eq!((now.controllers.lqg.unwrap().fan, now.observer.unwrap().sensor_mm), (0.5, 3.0));
}

#[test]
fn undo_takes_changes_back_in_their_order_and_says_when_none_is_left() {
    let mut flown = Flown::with(|_| ());
    flown.fly(50, |_| 300.0);
    let first = flown.pilot.numbers().clone();
    flown.send(&[("lqg.fan", 0.5)]).unwrap();
    let second = flown.pilot.numbers().clone();
    flown.pilot.command(Command::Gains(GainChange { td_s: Some(0.4), ..GainChange::default() })).unwrap();
    flown.fly(10, |_| 300.0);
    flown.pilot.command(Command::Undo).unwrap();
    assert_eq!(*flown.pilot.numbers(), second);
    flown.pilot.command(Command::Undo).unwrap();
    assert_eq!(*flown.pilot.numbers(), first);
    assert_eq!(flown.pilot.command(Command::Undo), Err(Refusal::NothingToUndo));
    flown.fly(60, |_| 300.0);
    assert_eq!(flown.pilot.orders.regulator.controllers(), &first.controllers);
}

#[test]
fn rows_of_the_gain_schedule_change_without_a_bump_and_stay_in_order() {
    let rows = Schedule { height_mm: [200.0, 400.0].into_iter().collect(), factor: [1.0, 1.2].into_iter().collect() };
    let mut flown = Flown::with(|tables| tables.controller.as_mut().unwrap().gain_schedule = Some(rows));
    flown.fly(300, |_| 280.0);
    let usual = largest_step(&flown.fly(50, |_| 280.0));
    flown.send(&[("gain_schedule.factor.1", 1.5), ("gain_schedule.height_mm.2", 420.0)]).unwrap();
    let step = largest_step(&flown.fly(50, |_| 280.0));
    assert!(step < usual + 0.15, "{step:.3} beside {usual:.3}");
    let in_force = flown.pilot.orders.regulator.controllers().gain_schedule.clone().unwrap();
    assert_eq!((in_force.factor[0], in_force.height_mm[1]), (1.5, 420.0));
    assert!(matches!(flown.send(&[("gain_schedule.height_mm.1", 500.0)]), Err(Refusal::Number { .. })));
    assert!(matches!(flown.send(&[("gain_schedule.factor.3", 1.0)]), Err(Refusal::Absent(_))));
}

/// The project's rig with the original curve of the fan, and gains for it.
fn predistorted() -> Flown {
    Flown::with(|tables| {
        let compensation = tables.compensation.as_mut().unwrap();
        compensation.predistortion = Some(Predistortion { points: None });
        let pid = tables.controller.as_mut().unwrap().pid.as_mut().unwrap();
        (pid.kp_per_mm, pid.ti_s) = (10.0, 15.0);
    })
}

#[test]
fn points_of_a_predistortion_move_without_a_bump_and_back() {
    let mut flown = predistorted();
    let before = flown.pilot.numbers().clone();
    // 10 mm below the setpoint, at rest: the control value is not 0.
    flown.fly(300, |_| 290.0);
    let usual = largest_step(&flown.fly(50, |_| 290.0));
    let points = before.compensation.predistortion.as_ref().unwrap().points();
    let forces: Vec<(String, f64)> = (1..)
        .zip(points)
        .map(|(k, [_, force])| (k, 1.2 * force))
        .map(|(k, force)| (format!("compensation.predistortion.points.{k}.mm_per_s2"), force))
        .collect();
    let given: Vec<(&str, f64)> = forces.iter().map(|(name, force)| (name.as_str(), *force)).collect();
    flown.send(&given).unwrap();
    let step = largest_step(&flown.fly(50, |_| 290.0));
    assert!(step < usual + 0.1, "{step} beside {usual}");
    let now = flown.pilot.numbers().compensation.predistortion.clone().unwrap();
    assert_eq!(now.points()[0][1], 1.2 * points[0][1]);
    flown.pilot.command(Command::Undo).unwrap();
    let step = largest_step(&flown.fly(50, |_| 290.0));
    assert!(step < usual + 0.1, "{step} beside {usual} on the way back");
    let curve = |numbers: &Numbers| numbers.compensation.predistortion.as_ref().unwrap().curve();
    assert_eq!(curve(flown.pilot.numbers()), curve(&before));
}

#[test]
fn a_point_that_makes_no_curve_is_refused_with_its_bounds_and_a_curve_is_not_switched() {
    let mut flown = predistorted();
    flown.fly(50, |_| 300.0);
    let refused = flown.send(&[("compensation.predistortion.points.2.duty_percent", 17.0)]).unwrap_err().to_string();
    assert!(refused.contains("duty, rising") && refused.contains("17.6"), "{refused}");
    let mut plain = Flown::with(|_| ());
    let name = "compensation.predistortion.points.1.mm_per_s2";
    assert!(matches!(plain.send(&[(name, -800.0)]), Err(Refusal::Absent(_))));
}

#[test]
fn no_word_makes_the_duty_jump_and_undo_says_the_old_one() {
    for kind in Kind::ALL.into_iter().filter(|kind| *kind != Kind::OpenLoop) {
        for parameter in Parameter::ALL.iter().filter(|parameter| !parameter.words.is_empty()) {
            let at = Parameter::named(parameter.name).unwrap();
            for word in parameter.words {
                let mut flown = Flown::with(|tables| tables.controller.as_mut().unwrap().active = Some(kind));
                let Some(old) = flown.pilot.numbers().values()[at] else { continue };
                flown.fly(300, |_| 280.0);
                let usual = largest_step(&flown.fly(50, |_| 280.0));
                let own = match parameter.name {
                    "pid.anti_windup" => "pid.anti_windup.back_calculation.tracking_s",
                    "state_feedback.integral" => "state_feedback.integral.ti_s",
                    "feed_forward" => "feed_forward.time_constant_s",
                    "compensation.dead_zone" => "compensation.dead_zone.upper_percent",
                    // Dither steps by its very nature.
                    "compensation.dither" => continue,
                    _ => "pid.derivative_n",
                };
                let said = (parameter.name, parameter.value_of(word).unwrap());
                let is_off = matches!(*word, "off" | "none" | "clamping");
                let sent: Result<(), Refusal> =
                    if is_off { flown.send(&[said]) } else { flown.send(&[said, (own, 2.0)]) };
                sent.unwrap_or_else(|refused| panic!("{} {word}: {refused}", parameter.name));
                assert_eq!(flown.pilot.numbers().values()[at], Some(said.1));
                let step = largest_step(&flown.fly(60, |_| 280.0));
                assert!(step < usual + 0.2, "{} {word} at {}: {step} beside {usual}", parameter.name, kind.name());
                flown.pilot.command(Command::Undo).unwrap();
                let step = largest_step(&flown.fly(60, |_| 280.0));
                assert!(step < usual + 0.2, "{} back from {word}: {step} beside {usual}", parameter.name);
                assert_eq!(flown.pilot.numbers().values()[at], Some(old));
            }
        }
    }
}

#[test]
fn a_word_that_needs_the_observer_is_refused_without_one_by_its_name() {
    let mut flown = Flown::with(|tables| {
        tables.observer = None;
        let controllers = tables.controller.as_mut().unwrap();
        (controllers.lqg, controllers.mpc, controllers.feed_forward) = (None, None, None);
        controllers.cascade.as_mut().unwrap().velocity = Source::Filter;
        controllers.state_feedback.as_mut().unwrap().velocity = Source::Filter;
    });
    flown.fly(50, |_| 300.0);
    let refused = flown.send(&[("cascade.velocity", 1.0)]).unwrap_err().to_string();
    assert!(refused.contains("cascade.velocity") && refused.contains("observer"), "{refused}");
}
