//! What an effect is: one small module with its equation, parameters, looks and mend, and an [`Entry`] that
//! the config file, the simulator, the diagnosis and the report all read.

use crate::model::Model;
use crate::unsound::Unsound;
use control::check::within;

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
    pub neutral: Neutral,
}

/// Where a number does nothing, the others of its effect being neutral too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Neutral {
    /// At this value.
    At(f64),
    /// At the model's length of the pipe.
    PipeLength,
}

/// What an effect is easily taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbour {
    /// The other effect's name.
    pub name: &'static str,
    /// How a log shows that it is not the other one, and what to fly for it.
    pub told_by: &'static str,
}

/// An effect's line in the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its table under `[plant.effects]`.
    pub name: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// Its numbers, as far as a log can tell them.
    pub params: &'static [Param],
    /// Sizes that a rig may show: where a search for the effect starts.
    pub sizes: &'static [&'static [f64]],
    /// How a log shows it.
    pub in_a_log: &'static str,
    /// How to mend it on a rig.
    pub mend: &'static str,
    /// Its nearest neighbours, the nearest first.
    pub told_from: &'static [Neighbour],
}

impl Entry {
    /// The values at which the effect does nothing to `model`, in the order of `params`.
    #[must_use]
    pub fn neutral(&self, model: &Model) -> Vec<f64> {
        let value = |param: &Param| match param.neutral {
            Neutral::At(value) => value,
            Neutral::PipeLength => model.pipe_length_mm,
        };
        self.params.iter().map(value).collect()
    }
}

/// Implemented by each effect of the catalogue.
pub trait Effect: Sized {
    /// The effect's line in the catalogue.
    const ENTRY: Entry;

    /// The values of `ENTRY.params`, in their order.
    fn values(&self) -> Vec<f64>;

    /// The effect with these values of `ENTRY.params`. A missing one is NaN, which no check accepts.
    fn from_values(values: &[f64]) -> Self;

    /// Changes the values of `ENTRY.params` and nothing else.
    fn set_values(&mut self, values: &[f64]) {
        *self = Self::from_values(values);
    }

    /// Checks every value against its bounds.
    ///
    /// # Errors
    /// [`Unsound`] names the first value outside its bounds, or what contradicts what.
    fn check(&self) -> Result<(), Unsound> {
        within_bounds(self)
    }
}

/// Checks the values of `ENTRY.params` against their bounds.
pub(crate) fn within_bounds<E: Effect>(effect: &E) -> Result<(), Unsound> {
    let mut params = E::ENTRY.params.iter().zip(effect.values());
    params.try_for_each(|(param, value)| Ok(within(param.name, value, param.min, param.max)?))
}

/// `values` and `from_values` of an effect whose fields are its parameters, in the order of its entry.
macro_rules! values_in_order {
    ($($field:ident),+) => {
        fn values(&self) -> Vec<f64> {
            vec![$(self.$field),+]
        }

        fn from_values(values: &[f64]) -> Self {
            let mut values = values.iter().copied();
            Self { $($field: values.next().unwrap_or(f64::NAN)),+ }
        }
    };
}
pub(crate) use values_in_order;
