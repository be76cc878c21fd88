//! What a reading measures of the state: its expectation, and its slopes by the states.
//!
//! ```text
//! reading = s + h(s, v, A, own states) + noise       h: what written effects add in the sensor; 0 without
//! H = ∂reading/∂x                                    by automatic differentiation of their formulas
//! ```
//!
//! s is the height behind a sensor's lag, and that of the ball without one. At a kink of h, H is the slope of one side.

use super::active::Active;
use super::covariance::motion_of;
use super::{Square, State};
use plant::{Input, Model, Motion};

/// The slopes of a reading by the states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measured {
    /// The reading is this state.
    State(usize),
    /// H.
    Slopes(State),
}

impl Measured {
    /// The slopes about a state.
    pub(super) fn of(model: &Model, active: &Active, state: &State, input: Input) -> Self {
        let seen = seen_state(model);
        if !model.effects.acts_on_reading() {
            return Self::State(seen);
        }
        let mut slopes = State::zeros();
        for &index in active.indices() {
            let mut unit = State::zeros();
            unit[index] = 1.0;
            // Without a lag of the sensor, what it sees moves with the ball.
            unit[4] = unit[seen];
            slopes[index] = model.seen_along(&seen_motion(model, state), input, &motion_of(&unit));
        }
        Self::Slopes(slopes)
    }

    /// H·δ: the change of a reading with a change of the state.
    pub(super) fn change(&self, of_state: &State) -> f64 {
        match self {
            Self::State(index) => of_state[*index],
            Self::Slopes(slopes) => slopes.dot(of_state),
        }
    }

    /// P·Hᵀ: the covariance of the states with a reading.
    pub(super) fn towards(&self, covariance: &Square) -> State {
        match self {
            Self::State(index) => covariance.column(*index).into_owned(),
            Self::Slopes(slopes) => covariance * slopes,
        }
    }
}

/// The expectation of a reading in a state, mm.
pub(super) fn expected_mm(model: &Model, state: &State, input: Input) -> f64 {
    model.seen_mm(&seen_motion(model, state), input)
}

/// The motion of a state as the sensor sees it: an update leaves states behind that a model does not have.
fn seen_motion(model: &Model, state: &State) -> Motion {
    Motion { sensed_mm: state[seen_state(model)], ..motion_of(state) }
}

/// The index of the state that the sensor sees.
fn seen_state(model: &Model) -> usize {
    if model.effects.has_sensor_state() { 4 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::{Active, Measured, State, expected_mm};
    use crate::filter::written_support::with_written;
    use crate::log_likelihood;
    use crate::tests_support::{model, record};
    use plant::{Input, Model, Stage};

    /// A sensor whose scale bends with height, that shows some of the speed, and has a state of its own.
    fn bent(k: f64) -> Model {
        let adds = "k * ((x - 300) / 100)^2 + 0.001 * k * (v + s) + k * max(x - 250, 0) / 100";
        with_written(model(), Stage::Sensor, adds, Some(["(fan - s) / 0.5", "fan"]), k)
    }

    #[test]
    fn the_slopes_of_a_reading_are_those_of_central_differences_behind_a_lag_and_without() {
        let state = State::from([280.0, 120.0, 90.0, 10.0, 275.0, 40.0, 0.0]);
        let input = Input { time_s: 3.0, ..Input::of(100.0) };
        let mut lagging = bent(8.0);
        lagging.effects.set("sensor_lag", &[0.05]);
        for model in [bent(8.0), lagging] {
            let active = Active::of(&model);
            let Measured::Slopes(slopes) = Measured::of(&model, &active, &state, input) else { panic!("no slopes") };
            for index in 0..7 {
                let mut by = State::zeros();
                by[index] = 1e-3;
                let at = |state: State| expected_mm(&model, &state, input);
                let is_active = active.indices().contains(&index);
                let exact = if is_active { (at(state + by) - at(state - by)) / 2e-3 } else { 0.0 };
                assert!((slopes[index] - exact).abs() < 1e-8, "{index}: {}, exact {exact}", slopes[index]);
            }
        }
    }

    #[test]
    fn a_record_of_a_bent_sensor_is_likeliest_under_its_own_bend() {
        let recording = record(&bent(8.0), 3, 40);
        let nats = |k: f64| log_likelihood(&bent(k), &recording, &model(), None);
        let [own, less, more, none] = [8.0, 5.0, 11.0, 0.0].map(nats);
        assert!(own > less && own > more + 20.0 && own > none + 20.0, "{own}, {less}, {more}, {none}");
        assert!((none - log_likelihood(&model(), &recording, &model(), None)).abs() < 1e-6);
    }
}
