//! The smooth motion between two events (a stop, a break-away, a hit).
//!
//! ```text
//! dy/dt = v
//! dv/dt = A + w − a·v − c·v·|v| − gradient·(y − centre) ± friction
//! A: acceleration by the fan's air about hover, behind its lag    w: turbulence    a: linear drag
//! ```
//!
//! A, w and the sensor's lag have closed forms, exact for any step; y, v and the own states of an effect take an RK4
//! step under them.
//! Linear about hover: v_f − v_eq and v are small beside v_eq.
//! Source: the thesis, equations 3.1.1.8 and 3.1.1.10 with K_g = gain.

use crate::acts::Conditions;
use crate::model::Model;
use crate::motion::{Input, Motion, OWN_STATES};
use crate::rk4;

/// What drives the ball during a step: a constant command.
#[derive(Clone, Copy)]
pub(crate) struct Flow<'a> {
    pub(crate) model: &'a Model,
    /// The command, and the time at the start of the step.
    pub(crate) input: Input,
}

/// What drives the ball at one instant of a step.
#[derive(Clone, Copy)]
pub(crate) struct Drive {
    /// The acceleration by everything that depends on neither height nor velocity, mm/s².
    pub(crate) force: f64,
    /// The part of it by the fan, mm/s².
    pub(crate) fan: f64,
    /// Seconds since the start of the flight.
    pub(crate) time_s: f64,
}

impl Flow<'_> {
    /// The acceleration of a ball that nothing touches, mm/s².
    pub(crate) fn net(&self, motion: &Motion) -> f64 {
        let fan = self.fan(motion, 0.0);
        let drive = Drive { force: fan + motion.turbulence_mm_per_s2, fan, time_s: self.input.time_s };
        self.acceleration([motion.position_mm, motion.velocity_mm_per_s], motion.own, drive)
    }

    /// `dt_s` of free motion; `friction` is the acceleration that friction adds.
    // Inlined so that the state stays in registers from step to step: through memory a step takes twice as long.
    #[inline(always)]
    pub(crate) fn free(&self, motion: &Motion, friction: f64, dt_s: f64) -> Motion {
        let (y, v) = (motion.position_mm, motion.velocity_mm_per_s);
        let (fan, turbulence) = (self.fans(motion, dt_s), self.turbulences(motion, dt_s));
        let drives = self.drives(fan, turbulence, friction, dt_s);
        let effects = &self.model.effects;
        let ([position_mm, velocity_mm_per_s], own) = if !effects.has_force() && !effects.has_own_states() {
            let rate = |x: &[f64; 2], force: f64| [x[1], force - self.model.drag_per_s * x[1]];
            (rk4::step(rate, &[y, v], drives.map(|drive| drive.force), dt_s), motion.own)
        } else {
            self.under_effects(motion, drives, dt_s)
        };
        Motion {
            position_mm,
            velocity_mm_per_s,
            fan_mm_per_s2: fan[2],
            turbulence_mm_per_s2: turbulence[2],
            sensed_mm: self.sensed(motion, [position_mm, velocity_mm_per_s], dt_s),
            own,
        }
    }

    /// The sensed position after `dt_s`, at whose end the ball is there.
    #[inline(always)]
    pub(crate) fn sensed(&self, motion: &Motion, [y, v]: [f64; 2], dt_s: f64) -> f64 {
        let start = motion.position_mm;
        let middle = f64::midpoint(start, y) + dt_s / 8.0 * (motion.velocity_mm_per_s - v);
        self.model.effects.sensed(motion.sensed_mm, [start, middle, y], dt_s)
    }

    /// What drives the ball at the start, the middle and the end of `dt_s`.
    #[inline(always)]
    pub(crate) fn drives(&self, fan: [f64; 3], turbulence: [f64; 3], friction: f64, dt_s: f64) -> [Drive; 3] {
        std::array::from_fn(|i| {
            #[expect(clippy::cast_precision_loss, reason = "0, 1 or 2")]
            let time_s = self.input.time_s + 0.5 * i as f64 * dt_s;
            Drive { force: fan[i] + turbulence[i] + friction, fan: fan[i], time_s }
        })
    }

    /// Position and velocity, and the own states, after `dt_s` under forces that depend on them.
    #[inline(always)]
    fn under_effects(&self, motion: &Motion, drives: [Drive; 3], dt_s: f64) -> ([f64; 2], [f64; OWN_STATES]) {
        let start = [motion.position_mm, motion.velocity_mm_per_s];
        if !self.model.effects.has_own_states() {
            let rate = |x: &[f64; 2], drive: Drive| [x[1], self.acceleration(*x, motion.own, drive)];
            return (rk4::step(rate, &start, drives, dt_s), motion.own);
        }
        let rate = |x: &[f64; 2 + OWN_STATES], drive: Drive| {
            let [y, v, p, q] = *x;
            let [dp, dq] = self.model.effects.own_rates(&self.conditions([y, v], [p, q], drive));
            [v, self.acceleration([y, v], [p, q], drive), dp, dq]
        };
        let [y, v, p, q] = rk4::step(rate, &[start[0], start[1], motion.own[0], motion.own[1]], drives, dt_s);
        ([y, v], [p, q])
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
            own: self.own_while_held(motion, dt_s),
        }
    }

    /// The own states after `dt_s` with the ball held where it is.
    fn own_while_held(&self, motion: &Motion, dt_s: f64) -> [f64; OWN_STATES] {
        if !self.model.effects.has_own_states() {
            return motion.own;
        }
        let drives = [0.0, dt_s / 2.0, dt_s].map(|t| {
            let fan = self.fan(motion, t);
            Drive { force: fan, fan, time_s: self.input.time_s + t }
        });
        let rate = |own: &[f64; OWN_STATES], drive: Drive| {
            self.model.effects.own_rates(&self.conditions([motion.position_mm, 0.0], *own, drive))
        };
        rk4::step(rate, &motion.own, drives, dt_s)
    }

    #[inline(always)]
    pub(crate) fn acceleration(&self, [y, v]: [f64; 2], own: [f64; OWN_STATES], drive: Drive) -> f64 {
        let linear = drive.force - self.model.drag_per_s * v;
        self.model.effects.accelerated(linear, &self.conditions([y, v], own, drive))
    }

    #[inline(always)]
    pub(crate) fn conditions(&self, [y, v]: [f64; 2], own: [f64; OWN_STATES], drive: Drive) -> Conditions {
        Conditions {
            time_s: drive.time_s,
            setpoint_mm: self.model.setpoint(self.input.setpoint_mm),
            position_mm: y,
            velocity_mm_per_s: v,
            commanded_mm_per_s2: self.input.commanded_mm_per_s2,
            fan_mm_per_s2: drive.fan,
            own,
            ..self.model.conditions()
        }
    }

    /// The fan's acceleration after `dt_s`.
    fn fan(&self, motion: &Motion, dt_s: f64) -> f64 {
        self.model.effects.fan(self.input.commanded_mm_per_s2, motion.fan_mm_per_s2, dt_s)
    }

    /// The fan's acceleration at the start, the middle and the end of `dt_s`.
    pub(crate) fn fans(&self, motion: &Motion, dt_s: f64) -> [f64; 3] {
        if self.model.effects.has_fan_state() {
            // Written out: `map` on an array is a call of its own here.
            [self.fan(motion, 0.0), self.fan(motion, dt_s / 2.0), self.fan(motion, dt_s)]
        } else {
            [self.input.commanded_mm_per_s2; 3]
        }
    }

    /// The turbulence at the start, the middle and the end of `dt_s`, without what it adds at random.
    pub(crate) fn turbulences(&self, motion: &Motion, dt_s: f64) -> [f64; 3] {
        self.model.effects.coloured_force().map_or([0.0; 3], |turbulence| {
            let after = |t| motion.turbulence_mm_per_s2 * turbulence.decay(t);
            [after(0.0), after(dt_s / 2.0), after(dt_s)]
        })
    }
}
