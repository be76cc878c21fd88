//! The smooth motion between two events (a stop, a break-away, a hit).
//!
//! ```text
//! dy/dt = v
//! dv/dt = A + w − a·v − c·v·|v| − gradient·(y − centre) ± friction
//! A: acceleration by the fan's air about hover, behind its lag    w: turbulence    a: linear drag
//! ```
//!
//! A, w and the sensor's lag have closed forms, exact for any step; y and v take an RK4 step under them.
//! Linear about hover: v_f − v_eq and v are small beside v_eq.
//! Source: the thesis, equations 3.1.1.8 and 3.1.1.10 with K_g = gain.

use crate::acts::Ball;
use crate::model::Model;
use crate::motion::Motion;
use crate::rk4;

/// What drives the ball during a step: a constant command.
#[derive(Clone, Copy)]
pub(crate) struct Flow<'a> {
    pub(crate) model: &'a Model,
    /// Commanded acceleration, mm/s².
    pub(crate) commanded: f64,
}

impl Flow<'_> {
    /// The acceleration of a ball that nothing touches, mm/s².
    pub(crate) fn net(&self, motion: &Motion) -> f64 {
        let force = self.fan(motion, 0.0) + motion.turbulence_mm_per_s2;
        self.acceleration(motion.position_mm, motion.velocity_mm_per_s, force)
    }

    /// `dt_s` of free motion; `friction` is the acceleration that friction adds.
    // Inlined so that the state stays in registers from step to step: through memory a step takes twice as long.
    #[inline(always)]
    pub(crate) fn free(&self, motion: &Motion, friction: f64, dt_s: f64) -> Motion {
        let (y, v) = (motion.position_mm, motion.velocity_mm_per_s);
        let (fan, turbulence) = (self.fans(motion, dt_s), self.turbulences(motion, dt_s));
        let force = std::array::from_fn(|i| fan[i] + turbulence[i] + friction);
        let effects = &self.model.effects;
        let [position_mm, velocity_mm_per_s] = if !effects.has_force() {
            rk4::step(|x, force| [x[1], force - self.model.drag_per_s * x[1]], &[y, v], force, dt_s)
        } else {
            rk4::step(|x, force| [x[1], self.acceleration(x[0], x[1], force)], &[y, v], force, dt_s)
        };
        Motion {
            position_mm,
            velocity_mm_per_s,
            fan_mm_per_s2: fan[2],
            turbulence_mm_per_s2: turbulence[2],
            sensed_mm: {
                let middle = f64::midpoint(y, position_mm) + dt_s / 8.0 * (v - velocity_mm_per_s);
                effects.sensed(motion.sensed_mm, [y, middle, position_mm], dt_s)
            },
        }
    }

    /// `dt_s` of everything but the ball, which is held where it is.
    pub(crate) fn held(&self, motion: &Motion, dt_s: f64) -> Motion {
        let y = motion.position_mm;
        Motion {
            position_mm: y,
            velocity_mm_per_s: 0.0,
            fan_mm_per_s2: self.fan(motion, dt_s),
            turbulence_mm_per_s2: self.turbulences(motion, dt_s)[2],
            sensed_mm: self.model.effects.sensed(motion.sensed_mm, [y; 3], dt_s),
        }
    }

    fn acceleration(&self, y: f64, v: f64, force: f64) -> f64 {
        let ball = Ball { position_mm: y, velocity_mm_per_s: v, pipe_length_mm: self.model.pipe_length_mm };
        self.model.effects.accelerated(force - self.model.drag_per_s * v, &ball)
    }

    /// The fan's acceleration after `dt_s`.
    fn fan(&self, motion: &Motion, dt_s: f64) -> f64 {
        self.model.effects.fan(self.commanded, motion.fan_mm_per_s2, dt_s)
    }

    /// The fan's acceleration at the start, the middle and the end of `dt_s`.
    fn fans(&self, motion: &Motion, dt_s: f64) -> [f64; 3] {
        if self.model.effects.has_fan_state() {
            [0.0, dt_s / 2.0, dt_s].map(|t| self.fan(motion, t))
        } else {
            [self.commanded; 3]
        }
    }

    /// The turbulence at the start, the middle and the end of `dt_s`, without what it adds at random.
    fn turbulences(&self, motion: &Motion, dt_s: f64) -> [f64; 3] {
        self.model.effects.coloured_force().map_or([0.0; 3], |turbulence| {
            [0.0, dt_s / 2.0, dt_s].map(|t| motion.turbulence_mm_per_s2 * turbulence.decay(t))
        })
    }
}
