//! What an effect is: one small module with its equation, parameters, looks and mend, and an [`Entry`] that
//! the config file, the simulator, the diagnosis and the report all read.

use control::check::{OutOfRange, within};

/// Where on the signal path an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Between the duty and the force of the air.
    Actuator,
    /// The air column.
    Air,
    /// The ball and what it touches.
    Ball,
    /// Between the ball and the reading.
    Sensor,
}

/// A number of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Param {
    /// Its key in the config file, with its unit.
    pub name: &'static str,
    /// Smallest value accepted.
    pub min: f64,
    /// Largest value accepted.
    pub max: f64,
    /// The value at which the effect does nothing.
    pub neutral: f64,
}

/// An effect's line in the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its table under `[plant.effects]`.
    pub name: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// Its numbers.
    pub params: &'static [Param],
    /// Sizes that a rig may show, small and large: where a search for the effect starts.
    pub sizes: &'static [&'static [f64]],
    /// How a log shows it.
    pub in_a_log: &'static str,
    /// How to mend it on a rig.
    pub mend: &'static str,
}

/// Implemented by each effect of the catalogue.
pub trait Effect {
    /// The effect's line in the catalogue.
    const ENTRY: Entry;

    /// The values of `ENTRY.params`, in their order.
    fn values(&self) -> Vec<f64>;

    /// The effect with these values of `ENTRY.params`, in their order. A value that is missing is neutral.
    fn from_values(values: &[f64]) -> Self;

    /// Checks every value against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first value outside its bounds.
    fn check(&self) -> Result<(), OutOfRange> {
        let params = Self::ENTRY.params.iter();
        params.zip(self.values()).try_for_each(|(param, value)| within(param.name, value, param.min, param.max))
    }
}
