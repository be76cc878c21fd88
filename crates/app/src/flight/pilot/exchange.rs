//! Inputs and outputs of the pilot: orders before the flight, then readings and decisions, cycle by cycle.

use crate::flight::experiment::Experiment;
use crate::flight::vocabulary::{Fault, Mode};
use config::{Loop, Rig, Safety, SecondSensor, Tables, Tachometer};
use control::Duty;
use control::compensation::Compensation;
use control::observer::{Estimate, Innovation};
use control::regulator::{Regulator, Unready};
use hal::BUDGET_US;

/// The orders before a flight.
#[derive(Clone, Debug)]
pub struct Orders {
    /// Estimate and control.
    pub regulator: Regulator,
    /// From control value to duty.
    pub compensation: Compensation,
    /// Limits.
    pub safety: Safety,
    /// The programme over time.
    pub experiment: Experiment,
    /// Time between readings, seconds: the period of the loop or of the sensor, whichever is longer.
    pub reading_period_s: f64,
    /// The optional signals of the rig.
    pub signals: Signals,
    /// The upper end of the ball's way, mm. Infinite where it is not known.
    pub top_mm: f64,
}

/// Why a config cannot be flown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoOrders {
    /// A table is missing.
    #[error("the config has no table [{0}]")]
    Missing(&'static str),
    /// The controllers are invalid.
    #[error(transparent)]
    Unready(#[from] Unready),
}

impl Orders {
    /// The orders of a config for a flight of this experiment.
    ///
    /// # Errors
    /// [`NoOrders`]: a table is missing, or the controllers make no regulator.
    pub fn of(tables: &Tables, experiment: Experiment) -> Result<Self, NoOrders> {
        let missing = |table| move || NoOrders::Missing(table);
        let reading_period_s = reading_period_s(tables.r#loop.as_ref().ok_or_else(missing("loop"))?);
        let safety = tables.safety.ok_or_else(missing("safety"))?;
        let controllers = tables.controller.clone().ok_or_else(missing("controller"))?;
        let regulator = Regulator::new(controllers, tables.observer.as_ref(), reading_period_s)?;
        let compensation = tables.compensation.clone().ok_or_else(missing("compensation"))?;
        let signals = tables.rig.as_ref().map(Signals::from).unwrap_or_default();
        let top_mm = tables.rig.as_ref().map_or(f64::INFINITY, |rig| rig.sensor_to_bottom_mm);
        Ok(Self { regulator, compensation, safety, experiment, reading_period_s, signals, top_mm })
    }
}

/// Time between readings of a rig's sensor under a loop, seconds: the longer of the two periods.
#[must_use]
pub fn reading_period_s(table: &Loop) -> f64 {
    table.period_s.max(1e-6 * f64::from(BUDGET_US))
}

/// The optional signals of a rig, as its tables have them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signals {
    /// The fan's speed.
    pub tachometer: Option<Tachometer>,
    /// The second sensor.
    pub second_sensor: Option<SecondSensor>,
}

impl From<&Rig> for Signals {
    fn from(rig: &Rig) -> Self {
        Self { tachometer: rig.tachometer, second_sensor: rig.second_sensor }
    }
}

/// A sensor's result in one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// The ball, mm above the bottom.
    Ball(f64),
    /// No new reading, because of this fault if there is one.
    Nothing(Option<Fault>),
}

/// All inputs of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Senses {
    /// By the range sensor.
    pub ball: Seen,
    /// By the second one; `None` where there is none.
    pub second: Option<Seen>,
    /// The fan's speed, rpm; `None` where it is not measured.
    pub fan_rpm: Option<f64>,
}

impl From<Seen> for Senses {
    fn from(ball: Seen) -> Self {
        Self { ball, second: None, fan_rpm: None }
    }
}

impl Seen {
    /// The position of the ball, if it was seen, mm.
    #[must_use]
    pub const fn position_mm(self) -> Option<f64> {
        match self {
            Self::Ball(position_mm) => Some(position_mm),
            Self::Nothing(_) => None,
        }
    }
}

/// The decision of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// What the loop is doing.
    pub mode: Mode,
    /// Commanded position, mm.
    pub setpoint_mm: Option<f64>,
    /// The control value in percent of duty about hover.
    pub control_percent: Option<f64>,
    /// The control value itself where predistortion makes it an acceleration, mm/s².
    pub control_mm_per_s2: Option<f64>,
    /// The duty to write.
    pub duty: Duty,
    /// The estimated velocity, mm/s.
    pub velocity_mm_per_s: Option<f64>,
    /// The last position seen, mm, by the second sensor while the first is silent.
    pub position_mm: Option<f64>,
    /// The observer's estimate, fan and hover in percent of duty.
    pub estimate: Option<Estimate>,
    /// The observer's innovation.
    pub innovation: Option<Innovation>,
}
