//! What an effect is: one small module with its equation, its parameters and what it does to the signal path, and an
//! [`Entry`] that the config file, the simulator, the diagnosis and the report all read.

use crate::acts::{Acts, Summary};
use crate::model::Model;
use crate::unsound::Unsound;
use control::check::within;
use serde::{Deserialize, Serialize};

/// Where on the signal path an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
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

impl Stage {
    /// All stages in the order of the signal path.
    pub const ALL: [Self; 4] = [Self::Actuator, Self::Air, Self::Ball, Self::Sensor];

    /// Its name in tables and documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Actuator => "actuator",
            Self::Air => "air",
            Self::Ball => "ball",
            Self::Sensor => "sensor",
        }
    }
}

/// A parameter: of an effect, or one of the base parameters of a model.
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
    /// The size of the steps that a fit takes.
    pub scale: Scale,
}

/// Where a parameter does nothing, the others of its effect being neutral too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Neutral {
    /// At this value.
    At(f64),
    /// At the lower end of the model's pipe.
    PipeBottom,
    /// At the upper end of the model's pipe.
    PipeTop,
    /// At any value, as long as the others are neutral; this value stands for all.
    Any(f64),
}

/// The size of the steps that a fit takes in a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The value itself, but no less than a tenth of the first of the entry's sizes.
    Value,
    /// The value itself, a speed, which a fit keeps within those of the record.
    Speed,
    /// This many mm at every value: for a height, whose value does not determine its resolution.
    Height(f64),
    /// No steps: the value is given with the effect, and no fit changes it.
    Given,
}

/// An effect that is similar to another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Similar {
    /// The other effect's name.
    pub name: &'static str,
    /// How a log shows that it is not the other one, and what to fly for it.
    pub distinguished_by: &'static str,
}

/// The initial values of the search for an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// At the entry's sizes.
    Sizes,
    /// At these values of its parameters.
    Values(&'static [&'static [f64]]),
    /// At these values of its one parameter by the length of the record in seconds: for a drift.
    OverRecord(&'static [f64]),
    /// At the entry's sizes, and at the value where the believed gain would balance the slope of duty over height;
    /// hover moves so that the ball remains balanced at its mean height.
    DutyOverHeight,
    /// At these values of its parameters, and at the force against the motion that a regression finds, with the gain, drag
    /// and hover beside it.
    AgainstMotion(&'static [&'static [f64]]),
    /// At shares of the range of commanded acceleration: limits that the record never reaches have no gradient.
    CommandedRange,
    /// At values with which the usual range of duties takes so many seconds: its one parameter is the time for 100 %.
    RampsOver(&'static [f64]),
    /// At the heights beyond which there are hardly any readings.
    HeightsSeen,
    /// At the steps of duty with the highest score: the likelihood has a narrow maximum for each.
    DutySteps,
    /// At the step of the grid of the readings; it is measured from the readings, and no fit changes it.
    ReadingStep,
    /// At the time for which readings repeat; it is measured from the readings, and no fit changes it.
    ReadingHold,
}

impl Start {
    /// Whether the value is measured from the readings, so that no fit changes it.
    #[must_use]
    pub const fn is_read_off(self) -> bool {
        matches!(self, Self::ReadingStep | Self::ReadingHold)
    }

    /// Whether the initial values come from the record, so that others would not be nearer to the optimum.
    #[must_use]
    pub const fn is_of_the_record(self) -> bool {
        matches!(self, Self::CommandedRange | Self::HeightsSeen | Self::DutySteps | Self::RampsOver(_))
            || self.is_read_off()
    }
}

/// The accuracy of the catalogue's equation for real rigs: it determines how much the intervals of the parameters are
/// widened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// As accurate as most.
    Usual,
    /// A shape that no rig has exactly: a truncated series, one play for a distribution of them, a lag of first order.
    Approximate,
    /// Impacts, after which the errors of a filter are not normally distributed.
    Impacts,
}

/// Two parameters of which the difference is known far better than each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The name of the difference.
    pub name: &'static str,
    /// Its name with its unit, as a key.
    pub key: &'static str,
    /// The indices of the parameters: the one that is subtracted, and the one that it is subtracted from.
    pub of: [usize; 2],
}

/// What a parameter is in a column of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InColumn {
    /// An input, given in percent of duty about hover.
    Input,
    /// An input, given as the acceleration that it commands about hover, mm/s².
    InputByForce,
    /// A difference of two inputs, percent of duty.
    InputDifference,
    /// A difference of two inputs, given as that of the accelerations that they command, mm/s².
    InputDifferenceByForce,
    /// A position, mm.
    Position,
    /// A difference of two positions, mm.
    PositionDifference,
}

/// An effect's line in the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its table under `[plant.effects]`.
    pub name: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// The article before its name in a sentence, with a space; empty where it is spoken of without one.
    pub article: &'static str,
    /// Its parameters, as far as they are identifiable from a log.
    pub params: &'static [Param],
    /// The number of its last parameters that its simple form lacks, and that a search adds or leaves out.
    pub optional: usize,
    /// Sizes that a rig may show, as values of its parameters, of the first ones alone for its simplest form. The first
    /// size is the scale of a fit.
    pub sizes: &'static [&'static [f64]],
    /// The initial values of a search for it.
    pub start: Start,
    /// The accuracy of its equation for real rigs.
    pub form: Form,
    /// Effects that look the same in duty and position whatever is flown, or nearly so.
    pub twins: &'static [&'static str],
    /// The simpler effect that it is a generalisation of.
    pub contains: Option<&'static str>,
    /// Two of its parameters of which the difference is known far better than each.
    pub difference: Option<Difference>,
    /// Its place among the effects that represent all others in the choice of an experiment: together they need small
    /// force, large force, speed and height.
    pub represents_its_stage: Option<u8>,
    /// The values on its page of the gallery, where the last of its sizes is too small for that flight or out of the
    /// ball's reach.
    pub shown_at: Option<&'static [f64]>,
    /// What its first parameters are in the columns of a log, in order.
    pub in_columns: &'static [InColumn],
    /// How a log shows it.
    pub in_a_log: &'static str,
    /// How to correct it on a rig.
    pub mend: &'static str,
    /// The same on a rig that is no ball in a pipe; empty where `mend` fits any rig.
    pub mend_elsewhere: &'static str,
    /// Similar effects, the most similar first.
    pub similar: &'static [Similar],
    /// What it does to the signal path; the catalogue fills it in from [`Effect::ACTS`].
    pub acts: Summary,
}

impl Entry {
    /// An entry with defaults: the values for a new effect that does not set them.
    pub const PLAIN: Self = Self {
        name: "",
        stage: Stage::Air,
        article: "",
        params: &[],
        optional: 0,
        sizes: &[],
        start: Start::Sizes,
        form: Form::Usual,
        twins: &[],
        contains: None,
        difference: None,
        represents_its_stage: None,
        shown_at: None,
        in_columns: &[],
        in_a_log: "",
        mend: "",
        mend_elsewhere: "",
        similar: &[],
        acts: Summary::NONE,
    };

    /// The same entry with these actions.
    pub(crate) const fn acting(self, acts: Summary) -> Self {
        Self { acts, ..self }
    }

    /// The values at which the effect does nothing to `model`, in the order of `params`.
    #[must_use]
    pub fn neutral(&self, model: &Model) -> Vec<f64> {
        let value = |param: &Param| match param.neutral {
            Neutral::At(value) | Neutral::Any(value) => value,
            Neutral::PipeBottom => model.pipe_mm().0,
            Neutral::PipeTop => model.pipe_mm().1,
        };
        self.params.iter().map(value).collect()
    }

    /// The number of parameters of its simple form.
    #[must_use]
    pub const fn simple_count(&self) -> usize {
        self.params.len() - self.optional
    }

    /// The size of the steps that a fit takes in parameter `index` where it has this value, in its unit.
    #[must_use]
    pub fn step_size(&self, index: usize, value: f64) -> f64 {
        match self.params.get(index).map(|param| param.scale) {
            Some(Scale::Height(size)) => size,
            Some(Scale::Value | Scale::Speed | Scale::Given) | None => {
                let usual = self.sizes.first().and_then(|sizes| sizes.get(index)).copied().unwrap_or(1.0);
                value.abs().max(0.1 * usual.abs())
            }
        }
    }
}

/// Implemented by each effect of the catalogue.
pub trait Effect: Sized + 'static {
    /// The effect's line in the catalogue.
    const ENTRY: Entry;

    /// What it does to the signal path.
    const ACTS: Acts<Self>;

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
