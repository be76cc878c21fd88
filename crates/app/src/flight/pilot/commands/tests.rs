//! Tests that the limits of the config hold for every sequence of commands.

use crate::flight::command::{Command, GainChange};
use crate::flight::experiment::{Experiment, Limits, Segment};
use crate::flight::pilot::{Orders, Pilot, Seen, Signals};
use config::Tables;
use control::Duty;
use control::controller::Kind;
use control::regulator::Regulator;
use control::waveform::Waveform;
use proptest::prelude::*;

const T: f64 = 0.02;

/// The project's rig with all its controllers.
fn pilot(tables: &Tables) -> Pilot {
    let setpoint_mm = Some(Waveform::Constant { value: 300.0 });
    let limits = Limits { position_min_mm: None, position_max_mm: None };
    let segments = vec![Segment { duration_s: 600.0, setpoint_mm, ..Segment::default() }].into();
    Pilot::new(Orders {
        regulator: Regulator::new(tables.controller.clone().unwrap(), tables.observer.as_ref(), T).unwrap(),
        compensation: tables.compensation.clone().unwrap(),
        safety: tables.safety.unwrap(),
        experiment: Experiment { title: "t".into(), limits, segments },
        reading_period_s: T,
        signals: Signals::default(),
        top_mm: 583.0,
    })
}

/// Numbers of every size, infinities and NaN.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -10.0..1000.0_f64,
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(0.0),
        Just(f64::MIN_POSITIVE)
    ]
}

fn command() -> impl Strategy<Value = Command> {
    let gain = || prop::option::of(prop_oneof![number(), 0.0..1.0_f64]);
    prop_oneof![
        number().prop_map(Command::Setpoint),
        (gain(), gain(), gain()).prop_map(|(kp_per_mm, ti_s, td_s)| Command::Gains(GainChange {
            kp_per_mm,
            ti_s,
            td_s
        })),
        prop::sample::select(Kind::ALL.to_vec()).prop_map(Command::Controller),
        Just(Command::Stop),
        Just(Command::Fly),
        Just(Command::Programme),
    ]
}

fn seen() -> impl Strategy<Value = Seen> {
    prop_oneof![5 => (-100.0..700.0_f64).prop_map(Seen::Ball), 1 => Just(Seen::Nothing(None))]
}

proptest! {
    #[test]
    fn no_command_takes_setpoint_duty_or_gains_beyond_their_limits(
        steps in prop::collection::vec((prop::option::of(command()), seen()), 1..300)
    ) {
        let tables: Tables = toml::from_str(include_str!("../../../../../../config.toml")).unwrap();
        let (mut pilot, safety) = (pilot(&tables), tables.safety.unwrap());
        let duties = safety.duty_min_percent..=safety.duty_max_percent;
        for (k, (command, seen)) in steps.into_iter().enumerate() {
            let time_s = T * k as f64;
            let _refused_or_not = command.map(|command| pilot.command(command));
            let decision = pilot.decide(time_s, seen);
            prop_assert!(decision.duty == Duty::OFF || duties.contains(&decision.duty.percent()), "{decision:?}");
            let setpoint_mm = pilot.setpoint_mm(time_s);
            let safe = safety.setpoint_min_mm..=safety.setpoint_max_mm;
            prop_assert!(setpoint_mm.is_none_or(|mm| safe.contains(&mm)), "{setpoint_mm:?} mm");
            prop_assert!(pilot.gains().unwrap().check().is_ok(), "{:?}", pilot.gains());
        }
    }
}
