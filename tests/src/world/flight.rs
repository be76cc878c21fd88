//! A flight: the programme flies the rig, and rows are written.

use crate::case::Case;
use crate::chance::Source;
use crate::forms::STEP_S;
use crate::programme::{Gains, Programme};
use crate::rig::Rig;
use std::fmt::Write;

/// Flight time before the record starts, s.
const SETTLE_S: f64 = 8.0;
/// Limit of the control, percent about hover.
const CONTROL_LIMIT: f64 = 20.0;

/// One row of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row {
    /// When the position was read, s.
    pub(crate) time_s: f64,
    /// The setpoint, mm.
    pub(crate) setpoint_mm: f64,
    /// Control, percent about hover.
    pub(crate) control_percent: f64,
    /// Duty written in response and in force until the next row, percent.
    pub(crate) duty_percent: f64,
    /// Position read, mm.
    pub(crate) position_mm: f64,
}

/// Flies a case. `watch` gets the rig after every step of the record.
pub(crate) fn fly(case: &Case, source: &Source, mut watch: impl FnMut(&Rig)) -> Vec<Row> {
    let programme = &case.programme;
    let mut rig = Rig::new(&case.parts(), source, programme.setpoint(0.0), SETTLE_S);
    let mut clock = source.stream("clock");
    let (mut rows, mut pilot, mut wait_s) = (Vec::new(), Pilot::new(programme.gains), 0.018);
    while rig.time() <= programme.seconds {
        let t = rig.time();
        if t >= 0.0 && rows.is_empty() {
            pilot = Pilot::new(programme.gains);
        }
        let row = act(&mut rig, &mut pilot, programme, case.belief.hover_duty_percent, wait_s);
        if t >= 0.0 {
            rows.push(row);
        }
        // Whole milliseconds, 17 to 20. The last row before the record ends at its start.
        wait_s = (17.0 + (4.0 * clock.unit()).floor()) / 1000.0;
        if t < 0.0 {
            wait_s = wait_s.min(-t);
        }
        for _ in 0..(wait_s / STEP_S).round() as usize {
            rig.advance();
            if t >= 0.0 {
                watch(&rig);
            }
        }
    }
    rows
}

/// Reads, decides, writes.
fn act(rig: &mut Rig, pilot: &mut Pilot, programme: &Programme, hover: f64, dt: f64) -> Row {
    let (time_s, position_mm) = (rig.time(), rig.read());
    let setpoint_mm = programme.setpoint(time_s);
    let wanted = pilot.control(setpoint_mm - position_mm, dt) + programme.wobble(time_s);
    let control_percent = round(wanted.clamp(-CONTROL_LIMIT, CONTROL_LIMIT));
    let duty_percent = round((hover + control_percent).clamp(0.0, 100.0));
    rig.duty = duty_percent;
    Row { time_s, setpoint_mm, control_percent, duty_percent, position_mm }
}

/// Four decimals, as in the file: the flown value is the written one.
fn round(percent: f64) -> f64 {
    (percent * 1e4).round() / 1e4
}

/// The controller's memory.
struct Pilot {
    gains: Gains,
    sum: f64,
    rate: f64,
    last: Option<f64>,
}

impl Pilot {
    fn new(gains: Gains) -> Self {
        Self { gains, sum: 0.0, rate: 0.0, last: None }
    }

    fn control(&mut self, error: f64, dt: f64) -> f64 {
        let Gains { kp, ki, kd, lag_s } = self.gains;
        let change = error - self.last.replace(error).unwrap_or(error);
        self.rate += (change / dt - self.rate) * dt / (lag_s + dt);
        let raw = kp * error + self.sum + kd * self.rate;
        if raw.abs() < CONTROL_LIMIT {
            self.sum += ki * error * dt;
        }
        raw
    }
}

/// The record as CSV.
pub(crate) fn csv(rows: &[Row]) -> String {
    let mut text = String::from("time_s,setpoint_mm,control_percent,duty_percent,position_mm\n");
    for Row { time_s, setpoint_mm, control_percent, duty_percent, position_mm } in rows {
        let row =
            format_args!("{time_s:.4},{setpoint_mm:.1},{control_percent:.4},{duty_percent:.4},{position_mm:.2}\n");
        let _ = text.write_fmt(row);
    }
    text
}
