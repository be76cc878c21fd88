//! The motion of the filter over one step, and its transition matrix.
//!
//! ```text
//! friction = −f·E sign(v)      v: normal with the filter's standard deviation, where that is large beside f·dt
//! ```
//!
//! Without the mean a filter would take a slow ball for a stopped one, with too small a covariance.

use super::active::Active;
use super::covariance::vector;
use super::{Square, State};
use plant::effects::WallFriction;
use plant::{Derivatives, Friction, Input, Model, Motion};
use std::f64::consts::{FRAC_2_SQRT_PI, SQRT_2};

/// Longest integration step of a motion that may be fast, seconds: RK4 is accurate to 1e-6 of a rig's motion there.
pub(super) const MAX_STEP_S: f64 = 0.02;
/// Longest step of a motion that is slow, by its fastest rate: where h·rate is so small, a step errs by less than 1e-7.
const MAX_STEP_BY_RATE: f64 = 0.1;
/// Over more than so many of them longer steps do, seconds: over a gap a forecast is uncertain by far more than they
/// err, and rows that are far apart must not take longer in proportion.
const FINE_STEPS: f64 = 5.0;
const GAP_STEP_S: f64 = 0.1;
/// Friction is smoothed over at least this speed, or over the speed that friction takes off in a step if that is less.
const SLOWEST_MM_PER_S: f64 = 1.0;
/// Friction is smoothed where the velocity's standard deviation exceeds this share of the speed that friction takes off
/// in a step.
const KNOWN: f64 = 0.25;

/// The longest step, seconds, of a motion with this fastest rate, 1/s; `None`: it is not known.
pub(super) fn longest_step_s(rate_per_s: Option<f64>) -> f64 {
    rate_per_s.map_or(MAX_STEP_S, |rate| (MAX_STEP_BY_RATE / rate).clamp(MAX_STEP_S, GAP_STEP_S))
}

/// The number of parts of a step of `dt` seconds, none longer than the time constant of the drag. RK4 is unstable for
/// steps of 2.8 time constants; at one it errs by 2 % of what is left of a transient.
/// Source: the stability function of RK4, 1 + z + z²/2 + z³/6 + z⁴/24 at z = −drag·dt, against exp z.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to 100, as the longest step is")]
pub(super) fn parts_by_drag(drag_per_s: f64, dt: f64) -> u32 {
    (drag_per_s * dt).ceil().clamp(1.0, Model::DRAG.max * GAP_STEP_S) as u32
}

/// The number of steps in which `ahead` seconds are integrated, the first ones no longer than `longest_s`.
pub(super) fn steps_over(ahead: f64, longest_s: f64) -> f64 {
    let fine = (ahead / longest_s).ceil().clamp(1.0, FINE_STEPS);
    fine + ((ahead - FINE_STEPS * longest_s) / GAP_STEP_S).ceil().max(0.0)
}

/// A step of the filter.
pub(super) struct Step<'a> {
    pub(super) model: &'a Model,
    input: Input,
    pub(super) dt: f64,
    friction: Option<WallFriction>,
    /// The speed over which friction is smoothed, mm/s; `None`: it is not.
    smoothed: Option<f64>,
}

impl<'a> Step<'a> {
    /// A step of a ball whose velocity has the standard deviation `roughness`, mm/s.
    pub(super) fn new(model: &'a Model, input: Input, dt: f64, roughness: f64) -> Self {
        let friction = model.effects.friction();
        let taken = friction.map_or(0.0, |friction| friction.acceleration_mm_per_s2) * dt;
        let smoothed =
            (friction.is_some() && roughness > KNOWN * taken).then(|| roughness.max(SLOWEST_MM_PER_S.min(taken)));
        Self { model, input, dt, friction, smoothed }
    }

    /// The motion after a step that touches an end of the pipe, where friction is not smoothed.
    pub(super) fn after(&self, motion: &Motion) -> Motion {
        motion.step(self.model, self.input, self.dt)
    }

    /// The friction during the whole step, if the ball does not stop: the expected friction where it is smoothed.
    /// `None`: the ball is at rest.
    pub(super) fn friction(&self, motion: &Motion) -> Option<Friction> {
        let Some(friction) = self.friction else { return Some(Friction::default()) };
        let (velocity, most) = (motion.velocity_mm_per_s, friction.acceleration_mm_per_s2);
        let Some(smooth) = self.smoothed else {
            let mm_per_s2 = friction.acceleration(velocity.signum());
            return (velocity != 0.0).then_some(Friction { mm_per_s2, slope_per_s: 0.0 });
        };
        let share = velocity / (SQRT_2 * smooth);
        let slope_per_s = -most * FRAC_2_SQRT_PI * libm::exp(-share * share) / (SQRT_2 * smooth);
        Some(Friction { mm_per_s2: -most * libm::erf(share), slope_per_s })
    }

    /// Whether a ball that slides from one state to another may do so without a stop.
    pub(super) fn slides(&self, from: &Motion, to: &Motion) -> bool {
        self.friction.is_none() || self.smoothed.is_some() || from.velocity_mm_per_s * to.velocity_mm_per_s >= 0.0
    }

    /// The state after a step in an endless pipe; writes Φ, its derivative by the active states, into their columns.
    pub(super) fn moved(&self, active: &Active, motion: &Motion, transition: &mut Square) -> State {
        let (after, derivatives) = match self.smoothed.and_then(|_| self.friction(motion)) {
            Some(friction) => motion.slide_with_derivatives(self.model, self.input, friction, self.dt),
            None => motion.step_with_derivatives(self.model, self.input, self.dt),
        };
        let Derivatives { by_position, by_velocity, by_fan, by_turbulence, by_sensed, by_own: [first, second] } =
            &derivatives;
        let columns = [by_position, by_velocity, by_fan, by_turbulence, by_sensed, first, second];
        for &index in active.indices() {
            transition.set_column(index, &vector(columns[index]));
        }
        vector(&after)
    }
}

#[cfg(test)]
mod tests {
    use super::super::covariance::motion_of;
    use super::{Active, MAX_STEP_S, Square, Step, longest_step_s, steps_over, vector};
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

    /// The motion after the step in an endless pipe, without derivatives.
    fn in_endless_pipe(step: &Step<'_>, motion: &Motion) -> Motion {
        if step.smoothed.is_none() {
            return motion.step_in_endless_pipe(step.model, step.input, step.dt);
        }
        let friction = step.friction(motion).unwrap_or_default();
        motion.slide(step.model, step.input, friction.mm_per_s2, step.dt)
    }

    /// The transition by central differences with the step `by`; one-sided with `sides` [0, 1] or [-1, 0].
    fn by_differences(step: &Step<'_>, active: &Active, motion: &Motion, by: f64, sides: [f64; 2]) -> Square {
        let column = |index: usize, row: usize| {
            let at = |sign: f64| {
                let mut state = vector(motion);
                state[index] += sign * by;
                vector(&in_endless_pipe(step, &motion_of(&state)))[row]
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
            let mut found = Square::zeros();
            step.moved(&active, &somewhere(), &mut found);
            let expected = by_differences(&step, &active, &somewhere(), 1e-3, [-1.0, 1.0]);
            let off = (found - expected).abs().max();
            assert!(off < 1e-6, "{}: {off}: {found} for {expected}", entry.name);
        }
    }

    #[test]
    fn the_longer_steps_of_a_gap_end_where_short_ones_do_and_are_few() {
        let fine = |ahead| steps_over(ahead, MAX_STEP_S);
        assert_eq!([0.0, 0.01, 0.02, 0.05, 0.1].map(fine), [1.0, 1.0, 1.0, 3.0, 5.0]);
        let mut curved = model();
        curved.effects.set("quadratic_drag", &[2e-3]);
        for gap_s in [0.2, 1.0, 10.0] {
            let after = |steps: f64| {
                let (dt, mut at, mut left) = (gap_s / steps, somewhere(), steps);
                while left > 0.5 {
                    at = at.step_in_endless_pipe(&curved, Input::of(50.0), dt);
                    left -= 1.0;
                }
                at
            };
            let (few, many) = (after(fine(gap_s)), after(1000.0 * gap_s));
            assert!(fine(gap_s) <= 5.0 + 10.0 * gap_s);
            let off = (few.position_mm - many.position_mm).abs();
            assert!(off < 0.02, "{off} mm after {gap_s} s");
        }
    }

    #[test]
    fn a_slow_motion_takes_one_step_of_a_tenth_of_a_second_that_ends_where_short_ones_do() {
        let mut slow = Model { drag_per_s: 0.8, effects: Effects::default(), ..model() };
        slow.effects.set("quadratic_drag", &[8e-4]);
        let rate = somewhere().fastest_rate_per_s(&slow, INPUT);
        assert_eq!(steps_over(0.1, longest_step_s(rate)), 1.0, "{rate:?}");
        let one = somewhere().step_in_endless_pipe(&slow, INPUT, 0.1);
        let five = (0..5).fold(somewhere(), |at, _| at.step_in_endless_pipe(&slow, INPUT, 0.02));
        let off = (one.velocity_mm_per_s - five.velocity_mm_per_s).abs() / five.velocity_mm_per_s;
        assert!(off < 1e-6, "{off} of the velocity");
        let fast = Model { drag_per_s: 6.0, ..slow };
        let rate = somewhere().fastest_rate_per_s(&fast, INPUT);
        assert_eq!(steps_over(0.1, longest_step_s(rate)), 5.0, "{rate:?}");
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
            let mut found = Square::zeros();
            step.moved(&active, &still, &mut found);
            assert!((found.column(0) - expected.column(0)).abs().max() < 1e-6, "{adds}: {found} for {expected}");
        }
    }
}
