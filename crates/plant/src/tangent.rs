//! The directional derivative of a step of the smooth motion by its start.
//!
//! ```text
//! dx/dt = f(x, t)      dδ/dt = ∂f/∂x · δ      one RK4 step of both together
//! ```
//!
//! This is the derivative of the RK4 step itself, to rounding, and not that of the exact motion. Written formulas are
//! differentiated automatically; at a kink, as of `max`, theirs is the derivative of one side (see
//! [`formula::Formula::dual`]). The effects of the catalogue have no derivatives in closed form: those of their forces
//! and of the fan's lag are central differences, exact where they are linear.
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, section I.14.

use crate::acts::{Conditions, Direction};
use crate::flow::{Drive, Flow};
use crate::motion::{Motion, OWN_STATES};
use crate::rk4;

/// Step of the differences along a direction, per unit of it: far below what a flight covers, far above rounding.
const NUDGE: f64 = 1e-2;
/// y, v and the own states, then their directional derivatives.
const STATES: usize = 2 * (2 + OWN_STATES);

/// Dry friction during a step, mm/s², and its derivative by the velocity at the start, 1/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// The acceleration by friction.
    pub mm_per_s2: f64,
    /// Its derivative by the velocity.
    pub slope_per_s: f64,
}

impl Flow<'_> {
    /// The directional derivative of [`Flow::free`] by the start, along `along`.
    pub(crate) fn free_along(&self, motion: &Motion, friction: Friction, dt_s: f64, along: &Motion) -> Motion {
        let drives = self.drives(self.fans(motion, dt_s), self.turbulences(motion, dt_s), friction.mm_per_s2, dt_s);
        let fan = self.fans_along(motion, along.fan_mm_per_s2, dt_s);
        let turbulence = self.turbulences(along, dt_s);
        let moving = self.drives(fan, turbulence, friction.slope_per_s * along.velocity_mm_per_s, dt_s);
        let both = std::array::from_fn(|i| (drives[i], moving[i]));
        let start = flat(motion, along);
        let end = rk4::step(|x, (drive, moving)| self.rate_along(x, drive, moving), &start, both, dt_s);
        let [.., y, v, p, q] = end;
        Motion {
            position_mm: y,
            velocity_mm_per_s: v,
            fan_mm_per_s2: fan[2],
            turbulence_mm_per_s2: turbulence[2],
            // A sensor's lag is linear.
            sensed_mm: self.sensed(along, [y, v], dt_s),
            own: [p, q],
        }
    }

    /// The rates of y, v and the own states, and those of their directional derivatives.
    fn rate_along(&self, x: &[f64; STATES], drive: Drive, moving: Drive) -> [f64; STATES] {
        let [y, v, p, q, y_along, v_along, p_along, q_along] = *x;
        let effects = &self.model.effects;
        let conditions = self.conditions([y, v], [p, q], drive);
        let along = Direction { position: y_along, velocity: v_along, fan: moving.fan, own: [p_along, q_along] };
        let linear = moving.force - self.model.drag_per_s * v_along;
        let [dp, dq] = effects.own_rates(&conditions);
        let [dp_along, dq_along] = effects.written.own_rates_along(&conditions, &along);
        let built_in = if effects.has_built_in_force() {
            let at = |by: f64| effects.built_in_force(&conditions.moved(&along, by));
            (at(NUDGE) - at(-NUDGE)) / (2.0 * NUDGE)
        } else {
            0.0
        };
        let a_along = linear + built_in + effects.written.force_along(&conditions, &along);
        [v, self.acceleration([y, v], [p, q], drive), dp, dq, v_along, a_along, dp_along, dq_along]
    }

    /// The derivative of the fan's acceleration at the start, the middle and the end of `dt_s`.
    fn fans_along(&self, motion: &Motion, along: f64, dt_s: f64) -> [f64; 3] {
        if along == 0.0 || !self.model.effects.has_fan_state() {
            return [0.0; 3];
        }
        let at = |by: f64| self.fans(&Motion { fan_mm_per_s2: motion.fan_mm_per_s2 + by * along, ..*motion }, dt_s);
        let (after, before) = (at(NUDGE), at(-NUDGE));
        std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * NUDGE))
    }
}

/// y, v and the own states, then the same of the direction.
const fn flat(motion: &Motion, along: &Motion) -> [f64; STATES] {
    let ([p, q], [p_along, q_along]) = (motion.own, along.own);
    let (v, v_along) = (motion.velocity_mm_per_s, along.velocity_mm_per_s);
    [motion.position_mm, v, p, q, along.position_mm, v_along, p_along, q_along]
}

impl Conditions {
    /// The same where the state has moved so far along a direction.
    fn moved(&self, along: &Direction, by: f64) -> Self {
        Self {
            position_mm: self.position_mm + by * along.position,
            velocity_mm_per_s: self.velocity_mm_per_s + by * along.velocity,
            fan_mm_per_s2: self.fan_mm_per_s2 + by * along.fan,
            own: std::array::from_fn(|state| self.own[state] + by * along.own[state]),
            ..*self
        }
    }
}
