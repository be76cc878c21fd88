//! The value of a formula and its derivatives by the states, in one evaluation.

use super::scope::{MOVING, OF_STATE, STATES};
use formula::Formula;

/// The value, and the derivatives by position, velocity, the fan's acceleration and the own states.
pub(super) fn of(formula: &Formula, values: &[f64]) -> (f64, [f64; STATES]) {
    let (mut used, mut count) = ([0; STATES], 0);
    for (state, variable) in OF_STATE.into_iter().enumerate() {
        if formula.uses(variable) {
            used[count] = state;
            count += 1;
        }
    }
    // Most formulas use few of the states, and an evaluation takes the longer the more derivatives it has.
    match count {
        0 => (formula.value(values), [0.0; STATES]),
        1 => by::<1>(formula, values, &used),
        2 => by::<2>(formula, values, &used),
        _ => by::<STATES>(formula, values, &std::array::from_fn(|state| state)),
    }
}

/// The same by the first `N` states of `used`.
fn by<const N: usize>(formula: &Formula, values: &[f64], used: &[usize; STATES]) -> (f64, [f64; STATES]) {
    let (mut towards, mut slopes) = ([[0.0; N]; MOVING], [0.0; STATES]);
    for (direction, state) in used.iter().take(N).enumerate() {
        towards[OF_STATE[*state]][direction] = 1.0;
    }
    let (value, along) = formula.duals(values, &towards);
    for (state, slope) in used.iter().zip(along) {
        slopes[*state] = slope;
    }
    (value, slopes)
}
