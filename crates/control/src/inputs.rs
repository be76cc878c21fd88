//! The inputs of a control law: reference, position, time since the last step, limits of the fan.

use crate::Limits;
use crate::observer::Estimate;

/// The source of the velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Source {
    /// The derivative filter of the readings.
    #[default]
    Filter,
    /// The observer.
    Observer,
}

/// The reference: position, velocity, and the control for it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// Position, mm.
    pub position_mm: f64,
    /// Velocity, mm/s.
    pub velocity_mm_per_s: f64,
    /// The fan's contribution for it, control value.
    pub fan: f64,
    /// The command for that, control value.
    pub control: f64,
}

impl Reference {
    /// A constant position.
    #[must_use]
    pub fn at(position_mm: f64) -> Self {
        Self { position_mm, ..Self::default() }
    }
}

/// All inputs of a control law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// The reference.
    pub reference: Reference,
    /// The reading, and the velocity of the derivative filter.
    pub filtered: Estimate,
    /// The observer's estimate; without an observer, the filter's.
    pub observed: Estimate,
    /// Time since the last control value of this law, seconds.
    pub dt_s: f64,
    /// What the fan can still follow.
    pub limits: Limits,
}

impl Inputs {
    /// Setpoint minus reading, mm.
    #[must_use]
    pub fn error_mm(&self) -> f64 {
        self.reference.position_mm - self.filtered.position_mm
    }

    /// The velocity by its source, mm/s.
    #[must_use]
    pub const fn velocity_mm_per_s(&self, source: Source) -> f64 {
        match source {
            Source::Filter => self.filtered.velocity_mm_per_s,
            Source::Observer => self.observed.velocity_mm_per_s,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::{Inputs, Reference};
    use crate::Limits;
    use crate::observer::Estimate;

    /// A ball at `position_mm` with `velocity_mm_per_s` and the setpoint `setpoint_mm`, 20 ms after the last step,
    /// without limits.
    pub(crate) fn inputs(setpoint_mm: f64, position_mm: f64, velocity_mm_per_s: f64) -> Inputs {
        let seen = Estimate { position_mm, velocity_mm_per_s, ..Estimate::default() };
        let limits = Limits { lower: -1e9, upper: 1e9 };
        Inputs { reference: Reference::at(setpoint_mm), filtered: seen, observed: seen, dt_s: 0.02, limits }
    }
}
