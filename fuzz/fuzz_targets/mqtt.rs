//! Any messages on any topics: refused with a short printable reason, or obeyed within the limits of the config.
#![no_main]

use airball::fuzzing::{Asked, Experiment, ORIGINAL_SETPOINT, Orders, Pilot, Seen, Tables, Topics, parse_message};
use control::Duty;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static TABLES: LazyLock<Tables> =
    LazyLock::new(|| toml::from_str(include_str!("../../config.toml")).expect("the project's config"));

/// The project's pilot, made once: a flight begins with a copy.
static PILOT: LazyLock<Pilot> = LazyLock::new(|| {
    let experiment = Experiment::of_reference(TABLES.reference.as_ref().expect("a reference"));
    Pilot::new(Orders::of(&TABLES, experiment).expect("orders"))
});

const TOPICS: [&str; 8] = [
    "airball/rig1/set/setpoint_mm",
    "airball/rig1/set/gains",
    "airball/rig1/set/controller",
    "airball/rig1/set/mode",
    ORIGINAL_SETPOINT,
    "airball/rig1/set/\u{7}",
    "airball/rig1/set/experiment",
    "airball/rig1/set/stream",
];

// One message a line: a character that picks the topic, then the payload.
fuzz_target!(|bytes: &[u8]| {
    let (topics, safety) = (Topics::new("rig1").expect("a name"), TABLES.safety.expect("limits"));
    let mut pilot = PILOT.clone();
    for (k, line) in (0_u32..).zip(bytes.split(|byte| *byte == b'\n')) {
        let Some((topic, payload)) = line.split_first() else { continue };
        let time_s = 0.02 * f64::from(k);
        match parse_message(&topics, TOPICS[usize::from(*topic) % TOPICS.len()], payload) {
            Ok(Asked::Loop(command)) => {
                let _ = pilot.command(command);
            }
            Ok(Asked::Stream(_)) => {}
            Err(why) => {
                let why = why.to_string();
                assert!(why.len() < 1000 && !why.chars().any(char::is_control), "{why:?}");
            }
        }
        let position_mm = 300.0 + 250.0 * f64::from(*topic).sin();
        let duty = pilot.decide(time_s, Seen::Ball(position_mm)).duty;
        let allowed = safety.duty_min_percent..=safety.duty_max_percent;
        assert!(duty == Duty::OFF || allowed.contains(&duty.percent()), "{duty:?}");
        let setpoint_mm = pilot.setpoint_mm(time_s);
        let allowed = safety.setpoint_min_mm..=safety.setpoint_max_mm;
        assert!(setpoint_mm.is_none_or(|mm| allowed.contains(&mm)), "{setpoint_mm:?}");
        assert!(pilot.gains().is_none_or(|gains| gains.check().is_ok()));
    }
});
