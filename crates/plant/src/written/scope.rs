//! The names that a formula may use, their values, and the bounds within which it must have a value.

use crate::acts::{Along, Conditions};
use crate::effect::Stage;

/// The most parameters of an effect.
pub(super) const MOST_PARAMETERS: usize = 8;

/// A name and the bounds of its values on any rig: mm, mm/s, percent, s, mm/s².
type Variable = (&'static str, [f64; 2]);

const LENGTH: [f64; 2] = [-1e6, 1e6];
const SPEED: [f64; 2] = [-1e7, 1e7];
const DUTY: [f64; 2] = [-1e4, 1e4];
const TIME: [f64; 2] = [0.0, 1e7];
const ACCELERATION: [f64; 2] = [-1e8, 1e8];
/// A state has the unit that its rate gives it.
pub(super) const STATE: [f64; 2] = [-1e12, 1e12];

const OF_DUTY: [Variable; 3] = [("u", DUTY), ("duty", DUTY), ("t", TIME)];
const OF_FORCE: [Variable; 6] =
    [("x", LENGTH), ("v", SPEED), ("u", DUTY), ("duty", DUTY), ("t", TIME), ("fan", ACCELERATION)];

/// The variables of a stage; the own states and then the parameters follow.
pub(super) const fn variables(stage: Stage) -> &'static [Variable] {
    match stage {
        Stage::Actuator => &OF_DUTY,
        _ => &OF_FORCE,
    }
}

/// The indices of what a force may be linear in.
pub(super) const ALL_BUT_PARAMETERS: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

/// The values of the names of a formula in the actuator.
pub(super) fn of_duty(
    about_hover_percent: f64,
    duty_percent: f64,
    time_s: f64,
    parameters: &[f64; MOST_PARAMETERS],
) -> [f64; 3 + MOST_PARAMETERS] {
    let mut values = [0.0; 3 + MOST_PARAMETERS];
    values[..3].copy_from_slice(&[about_hover_percent, duty_percent, time_s]);
    values[3..].copy_from_slice(parameters);
    values
}

/// The values of the names of a formula in the air, at the ball or in the sensor. `u` is the commanded acceleration by the gain.
pub(super) fn of_force(conditions: &Conditions, parameters: &[f64; MOST_PARAMETERS]) -> [f64; 8 + MOST_PARAMETERS] {
    let u = conditions.commanded_mm_per_s2 / conditions.gain_mm_per_s2_per_percent;
    let mut values = [0.0; 8 + MOST_PARAMETERS];
    values[..8].copy_from_slice(&[
        conditions.position_mm,
        conditions.velocity_mm_per_s,
        u,
        conditions.hover_duty_percent + u,
        conditions.time_s,
        conditions.fan_mm_per_s2,
        conditions.own[0],
        conditions.own[1],
    ]);
    values[8..].copy_from_slice(parameters);
    values
}

/// The speeds of the same names, the parameters being constant.
pub(super) fn of_speeds(along: &Along) -> [f64; 8] {
    [along.position, along.velocity, 0.0, 0.0, 0.0, along.fan, along.own[0], along.own[1]]
}
