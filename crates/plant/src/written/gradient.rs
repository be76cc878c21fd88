//! A formula's value and its derivatives by the states, in one evaluation.

use super::scope::{OF_STATE, STATES};
use formula::Formula;

/// The states that a formula uses. Most use few of them, and an evaluation takes the longer the more derivatives it
/// has.
#[derive(Debug)]
pub(super) struct UsedStates {
    states: [usize; STATES],
    count: usize,
}

impl UsedStates {
    pub(super) fn of(formula: &Formula) -> Self {
        let (mut states, mut count) = ([0; STATES], 0);
        for state in (0..STATES).filter(|state| formula.uses(OF_STATE[*state])) {
            states[count] = state;
            count += 1;
        }
        Self { states, count }
    }

    /// The value of the formula, and its derivatives by position, velocity, the fan's acceleration and the own states.
    pub(super) fn value_and_slopes(&self, formula: &Formula, values: &[f64]) -> (f64, [f64; STATES]) {
        match self.count {
            0 => (formula.value(values), [0.0; STATES]),
            1 => self.by::<1>(formula, values),
            2 => self.by::<2>(formula, values),
            3 => self.by::<3>(formula, values),
            _ => self.by::<STATES>(formula, values),
        }
    }

    /// The same by the first `N` of them.
    fn by<const N: usize>(&self, formula: &Formula, values: &[f64]) -> (f64, [f64; STATES]) {
        let own: [usize; N] = std::array::from_fn(|k| self.states[k]);
        let (value, by_own) = formula.gradient(values, &own.map(|state| OF_STATE[state]));
        let mut slopes = [0.0; STATES];
        // Beyond the count there is none.
        for (state, slope) in own.iter().zip(by_own).take(self.count) {
            slopes[*state] = slope;
        }
        (value, slopes)
    }
}
