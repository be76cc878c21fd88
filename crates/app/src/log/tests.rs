//! Tests of complete logs: written, cut, damaged, read, exported. Flights and their files for the tests of the parts.

mod csv;
mod damage;
mod mcap;
mod parquet;

use super::header::{Header, SIMULATED_START};
use super::writer::LogWriter;
use crate::flight::vocabulary::{Cycle, End, Event, Fault, Mode, What};
use std::{io::Cursor, path::Path};

/// Cycles at 50 Hz with numbers that have no short decimal form; every seventh reading is a repeated one.
pub(crate) fn cycles(count: u32) -> Vec<Cycle> {
    let cycle = |k: u32| {
        let time_s = f64::from(k) * 0.02 + 1e-5 / f64::from(k + 3);
        Cycle {
            time_s,
            period_s: 0.02,
            lateness_s: 1e-5 / f64::from(k + 3),
            mode: if k < 5 { Mode::Waiting } else { Mode::Flying },
            setpoint_mm: (k >= 5).then_some(300.0),
            control_percent: (k >= 5).then(|| (3.7 * time_s).sin()),
            commanded_duty_percent: 21.4 + (3.7 * time_s).sin(),
            duty_percent: ((21.4 + (3.7 * time_s).sin()) * 40.95).round() / 40.95,
            position_mm: (k >= 2).then(|| 300.0 + 40.0 * (2.1 * time_s).cos()),
            fresh: k >= 2 && !k.is_multiple_of(7),
            position2_mm: None,
            fan_rpm: None,
            velocity_mm_per_s: (k >= 3).then(|| -84.0 * (2.1 * time_s).sin()),
            control_mm_per_s2: None,
            estimated_position_mm: None,
            estimated_fan_percent: None,
            estimated_disturbance_percent: None,
            innovation_mm: None,
            innovation_test_ratio: None,
        }
    };
    (0..count).map(cycle).collect()
}

/// A mode, a fault and the end.
pub(super) fn events() -> Vec<Event> {
    let what = [
        What::Mode { from: Mode::Waiting, to: Mode::Flying },
        What::Fault(Fault::SensorSilent { silent_s: 0.25 }),
        What::End(End::Finished),
    ];
    what.into_iter().zip([0.1, 0.5, 1.0]).map(|(what, time_s)| Event { time_s, what }).collect()
}

/// A simulated flight's header.
pub(crate) fn header() -> Header {
    Header {
        version: "0.1.0".into(),
        command: "airball simulate --seed 7".into(),
        seed: Some(7),
        started: SIMULATED_START,
        config_toml: "[plant]\nhover_duty_percent = 21.4   # ü\n".into(),
    }
}

/// The bytes of a whole file with these cycles and [`events`].
pub(super) fn file(cycles: &[Cycle]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = LogWriter::to(Cursor::new(&mut bytes), Path::new("flight.mcap"), &header()).unwrap();
    cycles.iter().for_each(|cycle| writer.cycle(cycle).unwrap());
    events().iter().for_each(|event| writer.event(event).unwrap());
    writer.finish().unwrap();
    bytes
}
