//! What is known of the state before the first reading.

use super::covariance::vector;
use super::{Square, State};
use plant::{Input, Model};

/// Standard deviation of the velocity before the first reading: a ball in a pipe stays below 2 m/s.
pub(crate) const VELOCITY_PRIOR_MM_PER_S: f64 = 1000.0;

/// State and covariance before the first reading, which then updates them as every other does.
pub(super) fn prior(model: &Model, reading_mm: f64, input: Input) -> (State, Square) {
    let effects = &model.effects;
    // Standard deviation of the fan from its command: it may stand still.
    let fan = if effects.has_fan_state() {
        model.hover_duty_percent.abs().max(1.0) * model.gain_mm_per_s2_per_percent
    } else {
        0.0
    };
    let air = effects.coloured_force().map_or(0.0, |force| force.sigma_mm_per_s2);
    let sensed = if effects.has_sensor_state() { model.pipe_length_mm } else { 0.0 };
    let [first, second] = model.own_spread();
    let deviations = State::from([model.pipe_length_mm, VELOCITY_PRIOR_MM_PER_S, fan, air, sensed, first, second]);
    let state = vector(&model.at_rest_under(reading_mm, input));
    (state, Square::from_diagonal(&deviations.component_mul(&deviations)))
}
