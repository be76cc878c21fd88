//! What can be changed in flight: every number of controllers, observer and compensation, and their words and switches,
//! by name, with units and bounds.
//!
//! ```text
//! values(t) = from + λ·(to − from)        λ = t/T, 0 to 1: the control value does not jump, whatever changes
//! ```
//!
//! Words have no way between them: a new one is in force at once, and the controller is set up so that its control
//! value stays ([`crate::regulator::Regulator::adopt`]). A correction of the dead zone comes and goes on the way. What
//! a config does not have and no switch adds cannot be changed. A predistortion keeps the number of its points, and is
//! not switched: the unit of all gains depends on it. Bounds are those of the checks of the tables, found by asking
//! them.

mod parameter;
mod words;

pub use parameter::{COUNT, Parameter};

use crate::check::OutOfRange;
use crate::compensation::{Compensation, DeadZoneCorrection};
use crate::controller::Controllers;
use crate::observer::Observer;
use parameter::Place;

/// Controllers, observer and compensation of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// `[controller]`
    pub controllers: Controllers,
    /// `[observer]`
    pub observer: Option<Observer>,
    /// `[compensation]`
    pub compensation: Compensation,
}

/// Values of parameters, in the order of [`Parameter::ALL`]; `None` where one is absent or is not meant.
pub type Values = [Option<f64>; COUNT];

impl Numbers {
    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// The table and the first number outside its bounds there.
    pub fn check(&self) -> Result<(), (&'static str, OutOfRange)> {
        let at = |table: &'static str| move |error| (table, error);
        self.controllers.check()?;
        self.compensation.check().map_err(at("compensation"))?;
        let Some(observer) = &self.observer else { return Ok(()) };
        observer.check().map_err(at("observer"))?;
        observer.believed.check().map_err(at("observer.believed"))
    }

    /// The numbers at `share`, 0 to 1, of the way from `from` to these. What is not finite on the way is as here.
    #[must_use]
    pub fn on_the_way(&self, from: &Self, share: f64) -> Self {
        let (mut between, mut from) = (self.clone(), from.clone());
        let zones = (from.compensation.dead_zone, self.compensation.dead_zone);
        if zones.0.is_some() != zones.1.is_some() {
            let none = DeadZoneCorrection::NONE;
            from.compensation.dead_zone.get_or_insert(none);
            between.compensation.dead_zone.get_or_insert(none);
        }
        for parameter in &Parameter::ALL {
            let Place::Number(place) = parameter.place else { continue };
            if let (Some(to), Some(from)) = (place(&mut between), place(&mut from)) {
                let value = *from + share * (*to - *from);
                if value.is_finite() {
                    *to = value;
                }
            }
        }
        between
    }
}

#[cfg(test)]
mod tests;
