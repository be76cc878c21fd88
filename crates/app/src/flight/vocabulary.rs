//! The terms of a flight: its modes and faults, and its data: one [`Cycle`] per control period and an [`Event`] for
//! everything that is not periodic.
//!
//! Both are plain copies without pointers, so that the loop hands them over without allocating; they become
//! JSON on the side of a log's writer.

use super::command::{Command, Refusal};
use super::lateness::Histogram;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What the loop is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Fan off until the first plausible position.
    Waiting,
    /// Closed loop.
    Flying,
    /// Duty from the programme, no control.
    OpenLoop,
    /// Sensor silent: hover duty, for a limited time.
    Coasting,
    /// Fan off until told to fly.
    Stopped,
}

/// One control period, in the order of the signal path. The message of the log's channel `cycle`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cycle {
    /// When the position was read, seconds since the start of the flight.
    pub time_s: f64,
    /// Time since the previous cycle, seconds.
    pub period_s: f64,
    /// How long after its deadline the cycle began, seconds.
    pub lateness_s: f64,
    /// What the loop was doing.
    pub mode: Mode,
    /// Commanded position, millimetres. Absent while the fan is driven without control.
    pub setpoint_mm: Option<f64>,
    /// What the controller asked for, percent of duty about hover. Absent while the fan is driven without control.
    pub control_percent: Option<f64>,
    /// The control value itself where predistortion makes it an acceleration, nominal mm/s².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub control_mm_per_s2: Option<f64>,
    /// What compensation made of it, percent of duty.
    pub commanded_duty_percent: f64,
    /// The duty as the chip holds it, written in response to this position and in force until the next cycle.
    pub duty_percent: f64,
    /// The position of the ball, millimetres above the bottom of the pipe. Absent before the first reading.
    pub position_mm: Option<f64>,
    /// Whether the position was measured since the previous cycle; otherwise it is repeated, or the second sensor's.
    pub fresh: bool,
    /// The position by the second sensor, mm. Absent without one, and where it was not measured since the previous cycle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position2_mm: Option<f64>,
    /// The speed of the fan by its tachometer, revolutions a minute; 0 where it stands. Absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fan_rpm: Option<f64>,
    /// The estimated velocity, millimetres per second, upward. Absent before the first reading.
    pub velocity_mm_per_s: Option<f64>,
    /// The observer's estimate of the position, mm. Absent without an observer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_position_mm: Option<f64>,
    /// What the observer believes that the fan gives, percent of duty about hover: the control value behind the fan's lag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_fan_percent: Option<f64>,
    /// What the observer believes that hover lacks, percent of duty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_disturbance_percent: Option<f64>,
    /// The reading minus what the observer expected, millimetres. Absent without a reading or an observer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub innovation_mm: Option<f64>,
    /// The innovation's square over that of the gate: to 0.5 as expected, to 1.0 doubtful, above refused as an outlier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub innovation_test_ratio: Option<f64>,
}

/// Something that happened once. The log's channel `event` carries it in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Seconds since the start of the flight.
    pub time_s: f64,
    /// The event.
    pub what: What,
}

/// What happened.
#[expect(
    clippy::large_enum_variant,
    reason = "a box would allocate in the loop, and few commands are on their way at a time"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// The loop changed its mode.
    Mode {
        /// The mode before.
        from: Mode,
        /// The mode now.
        to: Mode,
    },
    /// Something went wrong; the loop reacted.
    Fault(Fault),
    /// A command, and its result.
    Command {
        /// The command.
        command: Command,
        /// Why it was refused, if it was.
        refused: Option<Refusal>,
    },
    /// How late the cycles of the flight began, up to now.
    Lateness(Histogram),
    /// The flight ended.
    End(End),
}

/// What can go wrong in flight.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The sensor gave no new reading for longer than allowed.
    #[error("no new range for {silent_s:.2} s; check the sensor's wiring and that nothing blocks its window")]
    SensorSilent {
        /// How long it was silent, seconds.
        silent_s: f64,
    },
    /// The sensor saw no target, or one beyond the pipe.
    #[error("the sensor reported {reported_mm} mm, which is no ball in this pipe; check that the ball is in it")]
    NoBall {
        /// The sensor's reading.
        reported_mm: u16,
    },
    /// The sensor gave a distance and marked it as not valid.
    #[error(
        "the sensor reported {reported_mm} mm with range status {status}, and 11 is a valid range; such readings are not \
         flown by: clean its window, and check its supply and what else its beam meets"
    )]
    DoubtfulRange {
        /// The sensor's status of the distance.
        status: hal::RangeStatus,
        /// The distance.
        reported_mm: u16,
    },
    /// The range sensor could not be read.
    #[error("the range sensor cannot be read: I2C error {kind:?}; check its wiring")]
    SensorBus {
        /// The error of the bus.
        kind: embedded_hal::i2c::ErrorKind,
    },
    /// The fan driver could not be written.
    #[error("the fan driver cannot be written: I2C error {kind:?}; check its wiring and the fan's supply")]
    FanBus {
        /// The error of the bus.
        kind: embedded_hal::i2c::ErrorKind,
    },
    /// The ball does not move although it is pushed.
    #[error(
        "the ball at {position_mm:.0} mm has not moved for {still_s:.1} s although the controller asks for \
         {control_percent:+.1} % about hover; free it, check the fan's supply; if it is not stuck, change [safety] \
         stuck"
    )]
    BallStuck {
        /// Position of the ball.
        position_mm: f64,
        /// The control value, percent of duty about hover.
        control_percent: f64,
        /// Duration, seconds.
        still_s: f64,
    },
    /// The fan is driven and does not turn.
    #[error(
        "the fan got {duty_percent:.1} % and stood for {for_s:.2} s; check its supply, what blocks its rotor, and the wire of \
         its tachometer"
    )]
    FanStalled {
        /// The duty, percent.
        duty_percent: f64,
        /// Duration, seconds.
        for_s: f64,
    },
    /// The two range sensors see the ball at different positions.
    #[error(
        "the range sensors have disagreed for {for_s:.2} s: the first sees the ball at {first_mm:.0} mm, the second at \
         {second_mm:.0} mm; clean their windows, check [rig] sensor_to_bottom_mm and [rig.second_sensor] to_bottom_mm, \
         or raise disagree_mm"
    )]
    SensorsDisagree {
        /// Position by the first sensor.
        first_mm: f64,
        /// Position by the second sensor.
        second_mm: f64,
        /// Duration, seconds.
        for_s: f64,
    },
    /// One of two range sensors is silent; the flight goes on by the other.
    #[error(
        "the {which} range sensor gave no position for {silent_s:.2} s; flying on by the other, check its wiring and window"
    )]
    OneSensorSilent {
        /// The silent sensor.
        which: Which,
        /// Duration, seconds.
        silent_s: f64,
    },
    /// The cycles do not keep up with their deadlines.
    #[error(
        "the control cycles fell {behind_s:.2} s behind their deadlines; end other programs on this computer, check \
         the bus for transactions that hang, or raise [safety] stall_s"
    )]
    Late {
        /// Total lateness of consecutive cycles, seconds.
        behind_s: f64,
    },
    /// The ball left the band that the experiment allows.
    #[error("the ball at {position_mm:.0} mm left the experiment's band, {}", band(*.min_mm, *.max_mm))]
    OutsideBand {
        /// Position of the ball.
        position_mm: f64,
        /// Lower end of the band.
        min_mm: f64,
        /// Upper end of the band.
        max_mm: f64,
    },
}

impl Fault {
    /// Whether a flight can go on after it once its cause is removed. A sensor that fell silent must be started anew,
    /// and the loop does not trust a fan that it cannot write.
    #[must_use]
    pub const fn can_be_flown_from(&self) -> bool {
        match self {
            Self::NoBall { .. }
            | Self::DoubtfulRange { .. }
            | Self::BallStuck { .. }
            | Self::FanStalled { .. }
            | Self::SensorsDisagree { .. }
            | Self::OutsideBand { .. } => true,
            Self::SensorSilent { .. }
            | Self::SensorBus { .. }
            | Self::FanBus { .. }
            | Self::OneSensorSilent { .. }
            | Self::Late { .. } => false,
        }
    }
}

/// One of two range sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The sensor of every rig.
    First,
    /// The sensor of `[rig.second_sensor]`.
    Second,
}

impl fmt::Display for Which {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::First => "first",
            Self::Second => "second",
        })
    }
}

/// A band in words; either end may be open.
fn band(min_mm: f64, max_mm: f64) -> String {
    match (min_mm.is_finite(), max_mm.is_finite()) {
        (true, true) => format!("{min_mm:.0} to {max_mm:.0} mm"),
        (true, false) => format!("above {min_mm:.0} mm"),
        _ => format!("below {max_mm:.0} mm"),
    }
}

/// Why a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The duration or the experiment was over.
    Finished,
    /// SIGINT or SIGTERM.
    Signal,
    /// A fault that control cannot mend.
    Fault,
    /// It did not: the log goes on in another file.
    Continued,
}

/// The word that a log uses for a mode or an end.
pub fn word<T: Serialize>(value: T) -> String {
    serde_json::to_value(value).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}
