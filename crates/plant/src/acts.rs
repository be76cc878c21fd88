//! What an effect may do to the signal path: one function per place, in the order of the path, as constants of the
//! effect's type.
//!
//! ```text
//! duty → delays_duty → on_duty → slews → − hover − shifts_hover → plays → on_command → · gain → limits → follows (fan)
//!   → force, coloured_force, friction, ends → senses → delays_reading → spreads → outliers → rounds
//!   → holds → reading                          a written effect of the sensor acts behind `senses`
//! ```
//!
//! The code of a place is the only statement that an effect acts there: states, linearity and speed of the motion
//! follow from it. Places with one owner at most are slots: two effects that fill the same one exclude each other.

use crate::effects::{EndStop, SensorOutliers, StaleSamples, Turbulence, WallFriction};
use crate::motion::OWN_STATES;
use control::design::Linear;

/// What a record and its model let expect of the readings: the input of the check whether an effect can show in them.
#[derive(Clone, Copy, Debug)]
pub struct Readings {
    /// Standard deviation of one reading as it is believed, mm.
    pub sigma_mm: f64,
    /// Time from one reading to the next, seconds.
    pub period_s: f64,
}

/// An error of a reading within so many standard deviations is a tail of the noise. Normal noise exceeds it once in 1.7
/// million readings.
const BEYOND_SIGMAS: f64 = 5.0;

/// Whether an error of a reading, mm, is no tail of noise of this standard deviation, mm.
#[must_use]
pub fn is_beyond_the_noise(error_mm: f64, sigma_mm: f64) -> bool {
    error_mm > BEYOND_SIGMAS * sigma_mm
}

/// What a force or the rate of an own state may depend on: the state of the plant at an
/// instant, its input, and the base parameters of the model.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// Time since the start of the flight, seconds.
    pub time_s: f64,
    /// The setpoint in force, mm.
    pub setpoint_mm: f64,
    /// Height of the ball, mm.
    pub position_mm: f64,
    /// Velocity of the ball, mm/s, upward.
    pub velocity_mm_per_s: f64,
    /// The acceleration that the duty commands, mm/s² about hover: that of the fan's air once its inertia is overcome.
    pub commanded_mm_per_s2: f64,
    /// The acceleration that the fan's air gives to a ball at rest, mm/s² about hover.
    pub fan_mm_per_s2: f64,
    /// The own states of the written effect that has some.
    pub own: [f64; OWN_STATES],
    /// The model's gain, mm/s² per percent.
    pub gain_mm_per_s2_per_percent: f64,
    /// The model's linear drag, 1/s.
    pub drag_per_s: f64,
    /// The model's duty at hover, percent.
    pub hover_duty_percent: f64,
    /// Middle of the pipe, mm.
    pub middle_mm: f64,
}

/// Step of finite differences, in mm, mm/s and mm/s²: far below what a flight covers, far above rounding.
pub(crate) const NUDGE: f64 = 1e-2;

impl Conditions {
    /// The derivatives of a force by position, velocity and the fan's acceleration: central differences, exact where it
    /// is linear.
    pub(crate) fn slopes_of(&self, force: impl Fn(&Self) -> f64) -> [f64; 3] {
        let along =
            |moved: fn(&Self, f64) -> Self| (force(&moved(self, NUDGE)) - force(&moved(self, -NUDGE))) / (2.0 * NUDGE);
        [
            along(|now, by| Self { position_mm: now.position_mm + by, ..*now }),
            along(|now, by| Self { velocity_mm_per_s: now.velocity_mm_per_s + by, ..*now }),
            along(|now, by| Self { fan_mm_per_s2: now.fan_mm_per_s2 + by, ..*now }),
        ]
    }
}

/// A direction in the state space, along which derivatives are taken.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Direction {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) fan: f64,
    pub(crate) own: [f64; OWN_STATES],
}

/// The duty that acts from what it was, from a constant duty, and from the seconds since; see [`Acts::slews`].
pub type Slews<E> = fn(&E, f64, f64, f64) -> f64;
/// The fan's acceleration from a constant command, from what it was, and from the seconds since; see [`Acts::follows`].
pub type Follows<E> = fn(&E, f64, f64, f64) -> f64;
/// The sensed position from what it was, from the path of the ball since, and from the seconds since; see
/// [`Acts::senses`].
pub type Senses<E> = fn(&E, f64, [f64; 3], f64) -> f64;

/// What an effect of type `E` does at each place of the signal path; `None`: nothing.
#[derive(Debug)]
pub struct Acts<E: 'static> {
    /// By how much a duty acts late, seconds.
    pub delays_duty: Option<fn(&E) -> f64>,
    /// The duty that the fan makes of one, both in percent.
    pub on_duty: Option<fn(&E, f64) -> f64>,
    /// Slot. The duty that acts, from what it was (first), so many seconds (third) later under a constant duty
    /// (second); both in percent.
    pub slews: Option<Slews<E>>,
    /// How far hover has moved at a time in seconds, percent.
    pub shifts_hover: Option<fn(&E, f64) -> f64>,
    /// Slot. The new state of a play, from its old state (first) and the duty (second), all in percent about hover.
    pub plays: Option<fn(&E, f64, f64) -> f64>,
    /// The effective duty of one, both in percent about hover.
    pub on_command: Option<fn(&E, f64) -> f64>,
    /// What the gain is multiplied by at an effective duty, percent about hover.
    pub gain_by_command: Option<fn(&E, f64) -> f64>,
    /// What the gain is multiplied by at a time, seconds.
    pub gain_by_time: Option<fn(&E, f64) -> f64>,
    /// The acceleration that the fan gives of a commanded one, both in mm/s² about hover.
    pub limits: Option<fn(&E, f64) -> f64>,
    /// Slot. The fan's acceleration, mm/s², so many seconds (third) after it was this (second) under a constant command
    /// (first).
    pub follows: Option<Follows<E>>,
    /// The acceleration that it adds to the ball, mm/s².
    pub force: Option<fn(&E, &Conditions) -> f64>,
    /// The derivatives of `force` by position (1/s²), velocity (1/s) and the fan's acceleration; `None`: they are taken
    /// by differences, which costs more.
    pub force_slopes: Option<fn(&E, &Conditions) -> [f64; 3]>,
    /// Slot. The random force of the air.
    pub coloured_force: Option<fn(&E) -> Turbulence>,
    /// Slot. Dry friction.
    pub friction: Option<fn(&E) -> WallFriction>,
    /// Slot. The ends of the ball's way.
    pub ends: Option<fn(&E) -> EndStop>,
    /// Slot. The sensed position, mm, so many seconds (third) after it was this (first) on a path through start, middle
    /// and end (second).
    pub senses: Option<Senses<E>>,
    /// How old a reading is, seconds.
    pub delays_reading: Option<fn(&E) -> f64>,
    /// Standard deviation of a reading, mm, of the one without the effect.
    pub spreads: Option<fn(&E, f64) -> f64>,
    /// Slot. Wild readings.
    pub outliers: Option<fn(&E) -> SensorOutliers>,
    /// Slot. The step of the readings, mm.
    pub rounds: Option<fn(&E) -> f64>,
    /// Slot. Readings that are held.
    pub holds: Option<fn(&E) -> StaleSamples>,
    /// Whether `follows` and `force` are linear in the state, so that their derivatives are the same everywhere; `None`:
    /// they are not.
    pub is_linear: Option<fn(&E) -> bool>,
    /// The time constants of a lag, up and down, seconds.
    pub lag_s: Option<fn(&E) -> [f64; 2]>,
    /// What it does to the linear plant about hover; `None`: it bends, sticks, drifts or scatters, and is left out of a
    /// design.
    pub linearise: Option<fn(&E, &mut Linear)>,
    /// Whether such values can show in readings as the effect's own; `None`: any can.
    pub can_show: Option<fn(&E, &Readings) -> bool>,
}

impl<E> Acts<E> {
    /// An effect that does nothing.
    pub const NONE: Self = Self {
        delays_duty: None,
        on_duty: None,
        slews: None,
        shifts_hover: None,
        plays: None,
        on_command: None,
        gain_by_command: None,
        gain_by_time: None,
        limits: None,
        follows: None,
        force: None,
        force_slopes: None,
        coloured_force: None,
        friction: None,
        ends: None,
        senses: None,
        delays_reading: None,
        spreads: None,
        outliers: None,
        rounds: None,
        holds: None,
        is_linear: None,
        lag_s: None,
        linearise: None,
        can_show: None,
    };

    /// The same without its types.
    #[must_use]
    pub const fn summary(&self) -> Summary {
        let late = if self.lag_s.is_some() {
            Some(Late::Lag)
        } else if self.delays_duty.is_some() || self.delays_reading.is_some() {
            Some(Late::DeadTime)
        } else {
            None
        };
        let changes = if self.outliers.is_some() || self.rounds.is_some() || self.holds.is_some() {
            Changes::Density
        } else if self.coloured_force.is_some() || self.spreads.is_some() {
            Changes::Scatter
        } else {
            Changes::Path
        };
        Summary {
            changes,
            late,
            slots: self.slots(),
            reaches_rotor: self.reaches_rotor(),
            is_linear: self.linearise.is_some(),
        }
    }

    /// One bit for each slot that it fills.
    const fn slots(&self) -> u16 {
        (self.plays.is_some() as u16)
            | (self.follows.is_some() as u16) << 1
            | ((self.coloured_force.is_some() as u16) * COLOURED_FORCE)
            | (self.friction.is_some() as u16) << 3
            | (self.ends.is_some() as u16) << 4
            | ((self.senses.is_some() as u16) * SENSES)
            | ((self.outliers.is_some() as u16) * OUTLIERS)
            | (self.rounds.is_some() as u16) << 7
            | (self.holds.is_some() as u16) << 8
            | (self.slews.is_some() as u16) << 10
    }

    /// Whether it acts between the duty and the speed of the rotor.
    const fn reaches_rotor(&self) -> bool {
        self.delays_duty.is_some() || self.on_duty.is_some() || self.slews.is_some() || self.follows.is_some()
    }
}

/// The bits of the slots that are asked for by themselves.
const COLOURED_FORCE: u16 = 1 << 2;
const SENSES: u16 = 1 << 5;
const OUTLIERS: u16 = 1 << 6;
const OWN_STATES_SLOT: u16 = 1 << 9;

/// What an effect changes of the readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changes {
    /// Their expectation: the ball takes another path.
    Path,
    /// Their variance.
    Scatter,
    /// The shape of their density.
    Density,
}

/// The kind of delay of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Late {
    /// A dead time: the signal is unchanged.
    DeadTime,
    /// A lag, which smooths the signal that it delays.
    Lag,
}

impl Late {
    /// Why a record does not tell such an effect of the duty from one of the reading.
    #[must_use]
    pub const fn why_twins(self) -> &'static str {
        match self {
            Self::DeadTime => {
                "a duty that acts late and a reading that is late shift the same readings by the same time"
            }
            Self::Lag => {
                "a lag before the ball and one behind it turn the same duty into the same readings, but for the colour of the noise"
            }
        }
    }
}

/// What an effect does to the signal path, without its types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// What of the readings it changes.
    pub changes: Changes,
    /// The kind of delay, if any.
    pub late: Option<Late>,
    /// Whether it moves the speed of the rotor.
    pub reaches_rotor: bool,
    /// Whether a design can use its linear part.
    pub is_linear: bool,
    slots: u16,
}

impl Summary {
    /// Of an effect that does nothing.
    pub const NONE: Self = Acts::<()>::NONE.summary();

    /// Of what is added to the duty, the acceleration or the reading, with own states or without.
    pub(crate) const fn written(has_states: bool) -> Self {
        Self { slots: if has_states { OWN_STATES_SLOT } else { 0 }, ..Self::NONE }
    }

    /// Whether the two fill the same slot of the signal path, and so exclude each other.
    #[must_use]
    pub const fn excludes(&self, other: &Self) -> bool {
        self.slots & other.slots != 0
    }

    /// Whether it draws random numbers.
    #[must_use]
    pub const fn is_random(&self) -> bool {
        matches!(self.changes, Changes::Scatter) || self.slots & OUTLIERS != 0
    }

    /// Whether it is a random force of the air, which can follow any force that a model lacks.
    #[must_use]
    pub const fn follows_any_force(&self) -> bool {
        self.slots & COLOURED_FORCE != 0
    }

    /// Whether it smooths the positions that are read, and with them what a random force does to them.
    #[must_use]
    pub const fn smooths_readings(&self) -> bool {
        self.slots & SENSES != 0
    }
}
