//! The motion of the filter over one step, and its transition matrix.
//!
//! ```text
//! friction = −f·E sign(v)      v: normal with the filter's standard deviation, where that is large beside f·dt
//! ```
//!
//! Without the mean a filter would take a slow ball for a stopped one, with too small a covariance.

use super::Square;
use super::active::Active;
use super::covariance::{derivative, motion_of, vector};
use plant::{Friction, Input, Model, Motion};
use std::f64::consts::{FRAC_2_SQRT_PI, SQRT_2};

/// Friction is smoothed over at least this speed, or over the speed that friction takes off in a step if that is less.
const SLOWEST_MM_PER_S: f64 = 1.0;
/// Friction is smoothed where the velocity's standard deviation exceeds this share of the speed that friction takes off
/// in a step.
const KNOWN: f64 = 0.25;

/// A step of the filter.
pub(super) struct Step<'a> {
    model: &'a Model,
    input: Input,
    dt: f64,
    /// Friction, mm/s², and the speed over which it is smoothed, mm/s.
    smoothed: Option<(f64, f64)>,
    has_friction: bool,
}

impl<'a> Step<'a> {
    /// A step of a ball whose velocity has the standard deviation `roughness`, mm/s.
    pub(super) fn new(model: &'a Model, input: Input, dt: f64, roughness: f64) -> Self {
        let friction = model.effects.friction().map(|friction| friction.acceleration_mm_per_s2);
        let smoothed = friction.filter(|friction| roughness > KNOWN * friction * dt);
        let smoothed = smoothed.map(|friction| (friction, roughness.max(SLOWEST_MM_PER_S.min(friction * dt))));
        Self { model, input, dt, smoothed, has_friction: friction.is_some() }
    }

    /// The motion after the step.
    pub(super) fn after(&self, motion: &Motion) -> Motion {
        if self.has_friction { self.endless(motion) } else { motion.step(self.model, self.input, self.dt) }
    }

    /// The same in an endless pipe: an end stops the ball but does not reduce the uncertainty.
    fn endless(&self, motion: &Motion) -> Motion {
        match self.smoothed {
            Some(_) => motion.slide(self.model, self.input, self.friction(motion).mm_per_s2, self.dt),
            None => motion.step_in_endless_pipe(self.model, self.input, self.dt),
        }
    }

    /// Φ: the derivative of the motion by the active states. By differences, unless a written effect moves the ball
    /// smoothly: its formulas may be as steep as their author likes, and are differentiated exactly.
    pub(super) fn transition(&self, active: &Active, motion: &Motion) -> Square {
        if !self.model.effects.has_written_motion() || (self.has_friction && self.smoothed.is_none()) {
            return derivative(active, |nudged| self.endless(nudged), motion);
        }
        let (mut transition, friction) = (Square::zeros(), self.friction(motion));
        for &index in active.indices() {
            let unit = Square::identity().column(index).into_owned();
            let along = motion.slide_along(self.model, self.input, friction, self.dt, &motion_of(&unit));
            transition.set_column(index, &vector(&along));
        }
        transition
    }

    /// The expected friction; none where it is not smoothed.
    fn friction(&self, motion: &Motion) -> Friction {
        self.smoothed.map_or_else(Friction::default, |(friction, smooth)| {
            let share = motion.velocity_mm_per_s / (SQRT_2 * smooth);
            let slope_per_s = -friction * FRAC_2_SQRT_PI * libm::exp(-share * share) / (SQRT_2 * smooth);
            Friction { mm_per_s2: -friction * libm::erf(share), slope_per_s }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Active, Square, Step, motion_of, vector};
    use crate::filter::written_support::with_written;
    use crate::tests_support::model;
    use plant::{Effects, Input, Model, Motion, Stage};

    const DT: f64 = 0.02;
    const INPUT: Input = Input { commanded_mm_per_s2: 300.0, time_s: 2.0, setpoint_mm: Some(310.0) };

    fn somewhere() -> Motion {
        Motion {
            position_mm: 280.0,
            velocity_mm_per_s: 120.0,
            fan_mm_per_s2: 90.0,
            turbulence_mm_per_s2: 40.0,
            sensed_mm: 275.0,
            own: [70.0, 0.0],
        }
    }

    /// A force and a state whose rate are non-linear in all that they may depend on.
    fn non_linear(model: Model) -> Model {
        let adds = "k * tanh(v / 50) * exp(-(x / 300)^2) + 0.1 * k * fan * sin(x / 20) / 100 \
                    + k * s^2 / 1000 + k * (t + setpoint / 100)";
        with_written(model, Stage::Air, adds, Some(["(fan + v * x / 100 - s) / 0.3 + cos(s)", "fan"]), 20.0)
    }

    /// The transition by central differences with the step `by`; one-sided with `sides` [0, 1] or [-1, 0].
    fn by_differences(step: &Step<'_>, active: &Active, motion: &Motion, by: f64, sides: [f64; 2]) -> Square {
        let column = |index: usize, row: usize| {
            let at = |sign: f64| {
                let mut state = vector(motion);
                state[index] += sign * by;
                vector(&step.endless(&motion_of(&state)))[row]
            };
            (at(sides[1]) - at(sides[0])) / (by * (sides[1] - sides[0]))
        };
        Square::from_fn(|row, index| if active.indices().contains(&index) { column(index, row) } else { 0.0 })
    }

    #[test]
    fn the_transition_of_a_written_effect_is_that_of_central_differences_beside_every_other_effect() {
        let bare = Model { effects: Effects::default(), ..model() };
        for entry in Effects::CATALOGUE.iter() {
            let mut model = non_linear(bare.clone());
            model.effects.set(entry.name, entry.sizes[0]);
            let step = Step::new(&model, INPUT, DT, 60.0);
            let active = Active::of(&model);
            let found = step.transition(&active, &somewhere());
            let expected = by_differences(&step, &active, &somewhere(), 1e-3, [-1.0, 1.0]);
            let off = (found - expected).abs().max();
            assert!(off < 1e-6, "{}: {off}: {found} for {expected}", entry.name);
        }
    }

    // Central differences would mix the slopes of both sides.
    #[test]
    fn the_transition_at_a_kink_is_that_of_one_side_and_never_a_mixture() {
        for (adds, above) in
            [("-k * max(x - 280, 0)", true), ("-k * max(0, x - 280)", false), ("-k * abs(x - 280)", true)]
        {
            let none = Model { effects: Effects::default(), ..model() };
            let model = with_written(none, Stage::Air, adds, None, 50.0);
            let still = Motion::at_rest(280.0, 0.0);
            let step = Step::new(&model, Input::of(0.0), DT, 60.0);
            let active = Active::of(&model);
            let sides = if above { [0.0, 1.0] } else { [-1.0, 0.0] };
            let expected = by_differences(&step, &active, &still, 1e-3, sides);
            let found = step.transition(&active, &still);
            assert!((found.column(0) - expected.column(0)).abs().max() < 1e-6, "{adds}: {found} for {expected}");
        }
    }

    #[test]
    fn a_ball_that_friction_may_stop_within_the_step_keeps_its_differences() {
        let mut model = non_linear(model());
        model.effects.set("wall_friction", &[200.0]);
        let step = Step::new(&model, INPUT, DT, 1e-3);
        let active = Active::of(&model);
        let slow = Motion { velocity_mm_per_s: 0.1, ..somewhere() };
        let found = step.transition(&active, &slow);
        let expected = super::derivative(&active, |nudged| step.endless(nudged), &slow);
        assert_eq!(found, expected);
    }
}
