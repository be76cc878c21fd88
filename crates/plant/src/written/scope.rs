//! The names that a formula may use, their values, and the bounds within which it must have a value.

use crate::acts::{Conditions, Direction};
use crate::effect::Stage;
use crate::motion::OWN_STATES;

/// The name of the variable that only some records have.
pub(super) const SETPOINT: &str = "setpoint";
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

const OF_DUTY: [Variable; 4] = [("u", DUTY), ("duty", DUTY), ("t", TIME), (SETPOINT, LENGTH)];
const OF_FORCE: [Variable; 7] =
    [("x", LENGTH), ("v", SPEED), ("u", DUTY), ("duty", DUTY), ("t", TIME), ("fan", ACCELERATION), (SETPOINT, LENGTH)];
/// A sensor does not know what the controller is asked for: the place of the setpoint has no name there.
const OF_SENSOR: [Variable; 7] = {
    let mut variables = OF_FORCE;
    variables[6].0 = "";
    variables
};

/// The variables of a stage; the own states and then the parameters follow.
pub(super) const fn variables(stage: Stage) -> &'static [Variable] {
    match stage {
        Stage::Actuator => &OF_DUTY,
        Stage::Air | Stage::Ball => &OF_FORCE,
        Stage::Sensor => &OF_SENSOR,
    }
}

/// Whether some stage has a variable of this name.
pub(super) fn is_variable(name: &str) -> bool {
    OF_FORCE.iter().chain(&OF_DUTY).any(|(known, _)| *known == name)
}

/// The number of the variables of a stage with states, and of the states.
pub(super) const MOVING: usize = OF_FORCE.len() + OWN_STATES;

/// The indices of what a force may be linear in.
pub(super) const ALL_BUT_PARAMETERS: [usize; MOVING] = [0, 1, 2, 3, 4, 5, 6, 7, 8];

/// The number of the states that a force depends on: position, velocity, the fan's acceleration, and the own states.
pub(crate) const STATES: usize = 3 + OWN_STATES;

/// The indices of these states among the variables.
pub(super) const OF_STATE: [usize; STATES] = [0, 1, 5, 7, 8];

/// The values of the names of a formula in the actuator: u, then duty, time and setpoint, then the parameters.
pub(super) fn of_duty(
    about_hover_percent: f64,
    at: [f64; 3],
    parameters: &[f64; MOST_PARAMETERS],
) -> [f64; OF_DUTY.len() + MOST_PARAMETERS] {
    let mut values = [0.0; OF_DUTY.len() + MOST_PARAMETERS];
    values[0] = about_hover_percent;
    values[1..OF_DUTY.len()].copy_from_slice(&at);
    values[OF_DUTY.len()..].copy_from_slice(parameters);
    values
}

/// The values of the names of a formula in the air, at the ball or in the sensor. `u` is the commanded acceleration by
/// the gain.
pub(super) fn of_force(
    conditions: &Conditions,
    parameters: &[f64; MOST_PARAMETERS],
) -> [f64; MOVING + MOST_PARAMETERS] {
    let u = conditions.commanded_mm_per_s2 / conditions.gain_mm_per_s2_per_percent;
    let mut values = [0.0; MOVING + MOST_PARAMETERS];
    values[..MOVING].copy_from_slice(&[
        conditions.position_mm,
        conditions.velocity_mm_per_s,
        u,
        conditions.hover_duty_percent + u,
        conditions.time_s,
        conditions.fan_mm_per_s2,
        conditions.setpoint_mm,
        conditions.own[0],
        conditions.own[1],
    ]);
    values[MOVING..].copy_from_slice(parameters);
    values
}

/// The direction of the same names, the parameters being constant.
pub(super) fn of_direction(along: &Direction) -> [f64; MOVING] {
    [along.position, along.velocity, 0.0, 0.0, 0.0, along.fan, 0.0, along.own[0], along.own[1]]
}
