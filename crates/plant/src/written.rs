//! Effects that users write: the ones that are known to a model, and of these the ones that are on.
//!
//! They act as those of the catalogue do: on the duty about hover, as a force, or on what the sensor shows. A force and
//! a sensor have up to two states of their own.

mod apart;
mod definition;
mod entry;
mod gradient;
mod intern;
mod names;
mod scope;
mod table;
#[cfg(test)]
mod tests;
mod text;

use crate::acts::{Conditions, Direction};
use crate::effect::{Entry, Stage};
use crate::motion::OWN_STATES;
use crate::unsound::Unsound;
use control::check::within;
pub use definition::Definition;
use scope::MOST_PARAMETERS;
pub(crate) use scope::STATES;
pub use table::{DefinitionError, DefinitionTable, ParameterTable, StateTable};

/// An effect that is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct On {
    definition: &'static Definition,
    /// In the order of the entry; what is beyond its parameters is 0.
    values: [f64; MOST_PARAMETERS],
}

impl On {
    /// What it adds in the air, at the ball or in the sensor, in the unit of its stage.
    fn adds(&self, conditions: &Conditions) -> f64 {
        self.definition.adds(&scope::of_force(conditions, &self.values))
    }

    /// The directional derivative of that by the state.
    fn adds_along(&self, conditions: &Conditions, along: &Direction) -> f64 {
        self.definition.adds_along(&scope::of_force(conditions, &self.values), &scope::of_direction(along))
    }
}

/// The effects that a user wrote.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrittenEffects {
    known: Vec<&'static Definition>,
    on: Vec<On>,
}

impl WrittenEffects {
    /// Makes an effect known, in the place of an older one of its name, which is switched off.
    pub fn define(&mut self, definition: &'static Definition) {
        let name = definition.entry().name;
        self.remove(name);
        self.known.retain(|known| known.entry().name != name);
        self.known.push(definition);
    }

    /// The known effects.
    pub fn definitions(&self) -> impl Iterator<Item = &'static Definition> {
        self.known.iter().copied()
    }

    /// The definitions of the effects that are on.
    pub fn present(&self) -> impl Iterator<Item = &'static Definition> {
        self.on.iter().map(|on| on.definition)
    }

    /// The known effect of that name.
    #[must_use]
    pub fn definition(&self, name: &str) -> Option<&'static Definition> {
        self.definitions().find(|known| known.entry().name == name)
    }

    pub(crate) fn values(&self, name: &str) -> Option<Vec<f64>> {
        self.on.iter().find(|on| on.entry().name == name).map(|on| on.own_values().to_vec())
    }

    /// Switches an effect on, or changes its values. False: none of that name is known.
    pub(crate) fn set(&mut self, name: &str, values: &[f64]) -> bool {
        let Some(definition) = self.definition(name) else { return false };
        let mut all = [0.0; MOST_PARAMETERS];
        for (index, value) in all.iter_mut().take(definition.entry().params.len()).enumerate() {
            *value = values.get(index).copied().unwrap_or(f64::NAN);
        }
        match self.on.iter_mut().find(|on| on.entry().name == name) {
            Some(on) => on.values = all,
            None => self.on.push(On { definition, values: all }),
        }
        true
    }

    pub(crate) fn remove(&mut self, name: &str) -> bool {
        let before = self.on.len();
        self.on.retain(|on| on.entry().name != name);
        self.on.len() < before
    }

    pub(crate) fn check(&self) -> Result<(), (&'static str, Unsound)> {
        for on in &self.on {
            for (param, value) in on.entry().params.iter().zip(on.own_values()) {
                within(param.name, *value, param.min, param.max).map_err(|error| (on.entry().name, error.into()))?;
            }
        }
        Ok(())
    }

    /// The effective duty about hover, percent, at a duty in percent, a time in seconds and a setpoint in mm.
    pub(crate) fn effective(&self, about_hover_percent: f64, at: [f64; 3]) -> f64 {
        let of_duty = self.on.iter().filter(|on| on.definition.stage() == Stage::Actuator);
        of_duty.fold(about_hover_percent, |u, on| u + on.definition.adds(&scope::of_duty(u, at, &on.values)))
    }

    /// Whether the effective duty moves with time.
    pub(crate) fn command_drifts(&self) -> bool {
        self.on.iter().any(|on| on.definition.stage() == Stage::Actuator && on.definition.uses_time())
    }

    /// The acceleration that they add to the ball, mm/s².
    // Inlined up to the usual case, which is that there are none: the conditions then need not be in memory.
    #[inline(always)]
    pub(crate) fn force(&self, conditions: &Conditions) -> f64 {
        if self.on.is_empty() { 0.0 } else { self.sum_of_forces(*conditions) }
    }

    #[inline(never)]
    fn sum_of_forces(&self, conditions: Conditions) -> f64 {
        self.forces().map(|on| on.adds(&conditions)).sum()
    }

    /// [`Self::force`], and its derivatives by position, velocity, the fan's acceleration and the own states.
    pub(crate) fn force_with_slopes(&self, conditions: &Conditions) -> (f64, [f64; STATES]) {
        let each = self.forces().map(|on| on.definition.adds_with_slopes(&scope::of_force(conditions, &on.values)));
        each.fold((0.0, [0.0; STATES]), |(force, slopes), (own, own_slopes)| {
            (force + own, std::array::from_fn(|state| slopes[state] + own_slopes[state]))
        })
    }

    /// The effects that are a force.
    fn forces(&self) -> impl Iterator<Item = &On> {
        self.on.iter().filter(|on| matches!(on.definition.stage(), Stage::Air | Stage::Ball))
    }

    /// The effects that change what the sensor shows.
    fn of_sensor(&self) -> impl Iterator<Item = &On> {
        self.on.iter().filter(|on| on.definition.stage() == Stage::Sensor)
    }

    /// Whether one of them is on.
    pub(crate) fn acts_on_reading(&self) -> bool {
        self.of_sensor().next().is_some()
    }

    /// What they add to the reading of a ball that is seen at the height of `conditions`, mm.
    pub(crate) fn reading_shift(&self, conditions: &Conditions) -> f64 {
        self.of_sensor().map(|on| on.adds(conditions)).sum()
    }

    /// The directional derivative of [`Self::reading_shift`] by the state.
    pub(crate) fn reading_shift_along(&self, conditions: &Conditions, along: &Direction) -> f64 {
        self.of_sensor().map(|on| on.adds_along(conditions, along)).sum()
    }

    pub(crate) fn has_force(&self) -> bool {
        self.forces().next().is_some()
    }

    /// Whether all forces and the rates of the states are linear in the state, at all times.
    pub(crate) fn motion_is_linear(&self) -> bool {
        self.on.iter().all(|on| on.definition.motion_is_linear())
    }

    /// Whether a force or the rate of a state changes with the time itself.
    pub(crate) fn moves_with_time(&self) -> bool {
        self.on.iter().any(|on| on.definition.moves_with_time())
    }

    /// The effect whose states are the own states of the model.
    fn with_states(&self) -> Option<&On> {
        self.on.iter().find(|on| on.definition.states() > 0)
    }

    /// The number of own states.
    pub(crate) fn own_states(&self) -> usize {
        self.with_states().map_or(0, |on| on.definition.states())
    }

    pub(crate) fn own_rates(&self, conditions: &Conditions) -> Option<[f64; OWN_STATES]> {
        self.with_states().map(|on| on.definition.rates(&scope::of_force(conditions, &on.values)))
    }

    /// The rates of the own states, each with its derivatives as those of [`Self::force_with_slopes`].
    pub(crate) fn own_rates_with_slopes(&self, conditions: &Conditions) -> [(f64, [f64; STATES]); OWN_STATES] {
        let rates = |on: &On| on.definition.rates_with_slopes(&scope::of_force(conditions, &on.values));
        self.with_states().map_or_else(Default::default, rates)
    }

    pub(crate) fn own_settled(&self, conditions: &Conditions) -> Option<[f64; OWN_STATES]> {
        self.with_states().map(|on| on.definition.start(&scope::of_force(conditions, &on.values)))
    }

    /// Standard deviations of the states before the first reading: by how much a fan that stands still would have
    /// moved them.
    pub(crate) fn own_spread(&self, conditions: &Conditions) -> Option<[f64; OWN_STATES]> {
        let settled = self.own_settled(conditions)?;
        let down = -conditions.gain_mm_per_s2_per_percent * conditions.hover_duty_percent.abs().max(1.0);
        let still = Conditions { commanded_mm_per_s2: down, fan_mm_per_s2: down, ..*conditions };
        let there = self.own_settled(&still)?;
        Some(std::array::from_fn(|state| (there[state] - settled[state]).abs()))
    }
}

impl On {
    pub(crate) fn entry(&self) -> &'static Entry {
        self.definition.entry()
    }

    fn own_values(&self) -> &[f64] {
        &self.values[..self.entry().params.len()]
    }
}
