//! The motion between two events and its derivatives by the states at its start.
//!
//! ```text
//! dx/dt = f(x, t)      dD/dt = ∂f/∂x · D, D = I at the start      one RK4 step of both together
//! ```
//!
//! A ball that is held keeps its position: its rates, and those of its derivatives, are 0.
//!
//! These are the derivatives of the RK4 step itself, to rounding, and not those of the exact motion. Written formulas
//! are differentiated automatically; at a kink, as of `max`, theirs is the derivative of one side (see
//! [`formula::Formula::dual`]). The effects of the catalogue state those of their forces, see
//! [`crate::Acts::force_slopes`]; that of the fan's lag is a difference, exact where the lag is linear.
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, section I.14.

use crate::acts::{Conditions, NUDGE};
use crate::flow::{Drive, Flow};
use crate::motion::{Motion, OWN_STATES};
use crate::rk4;
use crate::written::STATES;

/// What moves the ball between two events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Phase {
    /// It is free, but for friction.
    Sliding(Friction),
    /// It is held where it is.
    Held,
}

/// Dry friction during a step, mm/s², and its derivative by the velocity at the start, 1/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// The acceleration by friction.
    pub mm_per_s2: f64,
    /// Its derivative by the velocity.
    pub slope_per_s: f64,
}

/// The derivatives of the motion after a step by each state at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// By the position.
    pub by_position: Motion,
    /// By the velocity.
    pub by_velocity: Motion,
    /// By the fan's acceleration.
    pub by_fan: Motion,
    /// By the turbulence.
    pub by_turbulence: Motion,
    /// By the sensed position.
    pub by_sensed: Motion,
    /// By the own states.
    pub by_own: [Motion; OWN_STATES],
}

/// What drives the ball at one instant, and its derivatives by the fan's acceleration and by the turbulence at the
/// start of the step.
#[derive(Clone, Copy)]
struct Moving {
    drive: Drive,
    by_fan: f64,
    by_turbulence: f64,
}

/// The columns of D, in this order: position, velocity, fan, turbulence, own states.
const POSITION: usize = 0;
const VELOCITY: usize = 1;
const FAN: usize = 2;
const TURBULENCE: usize = 3;
const OWN: usize = 4;

/// Position and velocity with their derivatives by the first two; by the first four; all with own states.
const BARE: usize = 2 * (1 + FAN);
const PLAIN: usize = 2 * (1 + OWN);
const WITH_OWN: usize = (2 + OWN_STATES) * (1 + OWN + OWN_STATES);

impl Flow<'_> {
    /// [`Flow::free`] or [`Flow::held`], and its derivatives by the start.
    pub(crate) fn with_derivatives(&self, motion: &Motion, phase: Phase, dt_s: f64) -> (Motion, Derivatives) {
        let (fan, turbulence) = (self.fans(motion, dt_s), self.turbulences(motion, dt_s));
        let friction = if let Phase::Sliding(friction) = phase { friction.mm_per_s2 } else { 0.0 };
        let drives = self.drives(fan, turbulence, friction, dt_s);
        let by_fan = self.fans_slope(motion, fan, dt_s);
        let by_turbulence = self.turbulences(&Motion { turbulence_mm_per_s2: 1.0, ..*motion }, dt_s);
        let moving =
            std::array::from_fn(|i| Moving { drive: drives[i], by_fan: by_fan[i], by_turbulence: by_turbulence[i] });
        let effects = &self.model.effects;
        let (has_fan, has_turbulence) = (effects.has_fan_state(), effects.coloured_force().is_some());
        let (has_own, has_sensed) = (effects.has_own_states(), effects.has_sensor_state());
        let all = if has_own {
            self.with_columns::<{ 2 + OWN_STATES }, WITH_OWN>(motion, phase, moving, dt_s)
        } else if has_fan || has_turbulence {
            self.with_columns::<2, PLAIN>(motion, phase, moving, dt_s)
        } else {
            self.with_columns::<2, BARE>(motion, phase, moving, dt_s)
        };
        let after = |start: &Motion, [y, v, p, q]: [f64; 2 + OWN_STATES], fan: f64, turbulence: f64| Motion {
            position_mm: y,
            velocity_mm_per_s: v,
            fan_mm_per_s2: fan,
            turbulence_mm_per_s2: turbulence,
            // A sensor's lag is linear.
            sensed_mm: self.sensed(start, [y, v], dt_s),
            own: [p, q],
        };
        let unit = Unit::ALL;
        // A ball that is held has no velocity.
        let velocity = if phase == Phase::Held { &unit.still } else { &unit.velocity };
        // What is no state of the model moves nothing.
        let if_state = |is_state: bool, start: &Motion, rows, fan: f64, turbulence: f64| {
            if is_state { after(start, rows, fan, turbulence) } else { unit.still }
        };
        let derivatives = Derivatives {
            by_position: after(&unit.position, all[1 + POSITION], 0.0, 0.0),
            by_velocity: after(velocity, all[1 + VELOCITY], 0.0, 0.0),
            by_fan: if_state(has_fan, &unit.still, all[1 + FAN], by_fan[2], 0.0),
            by_turbulence: if_state(has_turbulence, &unit.still, all[1 + TURBULENCE], 0.0, by_turbulence[2]),
            by_sensed: if_state(has_sensed, &unit.sensed, [0.0; 2 + OWN_STATES], 0.0, 0.0),
            by_own: [0, 1].map(|state| if_state(has_own, &unit.still, all[1 + OWN + state], 0.0, 0.0)),
        };
        (after(motion, all[0], fan[2], turbulence[2]), derivatives)
    }

    /// y, v and the own states after the step, then the columns of D: `ROWS` rows of them where there are own states.
    fn with_columns<const ROWS: usize, const ALL: usize>(
        &self,
        motion: &Motion,
        phase: Phase,
        moving: [Moving; 3],
        dt_s: f64,
    ) -> [[f64; 2 + OWN_STATES]; 1 + OWN + OWN_STATES] {
        let velocity = if phase == Phase::Held { 0.0 } else { 1.0 };
        let whole = [motion.position_mm, velocity * motion.velocity_mm_per_s, motion.own[0], motion.own[1]];
        let mut start = [0.0; ALL];
        start[..ROWS].copy_from_slice(&whole[..ROWS]);
        for (row, column) in [(0, POSITION), (1, VELOCITY), (2, OWN), (3, OWN + 1)].into_iter().take(ROWS) {
            start[ROWS * (1 + column) + row] = if row == 1 { velocity } else { 1.0 };
        }
        let rate = |x: &[f64; ALL], moving: Moving| self.rates::<ROWS, ALL>(x, moving, phase);
        let end = rk4::step(rate, &start, moving, dt_s);
        let mut all = [[0.0; 2 + OWN_STATES]; 1 + OWN + OWN_STATES];
        for (column, rows) in all.iter_mut().zip(end.chunks_exact(ROWS)) {
            column[..ROWS].copy_from_slice(rows);
        }
        if ROWS == 2 {
            all[0][2..].copy_from_slice(&motion.own);
        }
        all
    }

    /// The rates of y, v and the own states, and of the columns of D.
    #[inline(always)]
    fn rates<const ROWS: usize, const ALL: usize>(
        &self,
        x: &[f64; ALL],
        Moving { drive, by_fan, by_turbulence }: Moving,
        phase: Phase,
    ) -> [f64; ALL] {
        let own = if ROWS > 2 { [x[2], x[3]] } else { [0.0; OWN_STATES] };
        let conditions = self.conditions([x[0], x[1]], own, drive);
        let mut rates = [0.0; ALL];
        let (mut of_force, mut friction_slope_per_s) = ([0.0; STATES], 0.0);
        if let Phase::Sliding(friction) = phase {
            let linear = drive.force - self.model.drag_per_s * x[1];
            (rates[0], friction_slope_per_s) = (x[1], friction.slope_per_s);
            (rates[1], of_force) = self.acceleration_with_slopes(linear, &conditions);
        }
        let mut of_own = [[0.0; STATES]; OWN_STATES];
        if ROWS > 2 {
            let own = self.own_rates_with_slopes(&conditions);
            rates[2..ROWS].copy_from_slice(&own.map(|(rate, _)| rate));
            of_own = own.map(|(_, slopes)| slopes);
        }
        let columns = x[ROWS..].chunks_exact(ROWS).zip(rates[ROWS..].chunks_exact_mut(ROWS)).enumerate();
        for (column, (x, rate)) in columns {
            let (fan, force) = match column {
                VELOCITY => (0.0, friction_slope_per_s),
                FAN => (by_fan, by_fan),
                TURBULENCE => (0.0, by_turbulence),
                _ => (0.0, 0.0),
            };
            if phase != Phase::Held {
                rate[0] = x[1];
                rate[1] = force - self.model.drag_per_s * x[1] + along(&of_force, x, fan);
            }
            for (rate, slopes) in rate[2..].iter_mut().zip(&of_own) {
                *rate = along(slopes, x, fan);
            }
        }
        rates
    }

    /// The acceleration of a ball that is `linear` without the effects, and the derivatives of their force by position,
    /// velocity, the fan and the own states.
    #[inline(always)]
    pub(crate) fn acceleration_with_slopes(&self, linear: f64, conditions: &Conditions) -> (f64, [f64; STATES]) {
        let effects = &self.model.effects;
        let acceleration = effects.accelerated_by_catalogue(linear, conditions);
        let [by_position, by_velocity, by_fan] = effects.built_in_slopes(conditions);
        let mut slopes = [by_position, by_velocity, by_fan, 0.0, 0.0];
        if !effects.written.has_force() {
            return (acceleration, slopes);
        }
        let (force, written) = effects.written.force_with_slopes(conditions);
        for (slope, own) in slopes.iter_mut().zip(self.of_states(written)) {
            *slope += own;
        }
        (acceleration + force, slopes)
    }

    /// The rate of each own state, and its derivatives by the states.
    pub(crate) fn own_rates_with_slopes(&self, conditions: &Conditions) -> [(f64, [f64; STATES]); OWN_STATES] {
        let rates = self.model.effects.written.own_rates_with_slopes(conditions);
        rates.map(|(rate, slopes)| (rate, self.of_states(slopes)))
    }

    /// The derivatives without that by the fan's acceleration where it is no state of the model.
    #[inline(always)]
    fn of_states(&self, mut slopes: [f64; STATES]) -> [f64; STATES] {
        if !self.model.effects.has_fan_state() {
            slopes[2] = 0.0;
        }
        slopes
    }

    /// The derivatives of the fan's acceleration at the start, the middle and the end of `dt_s`, where it is `fan`, by
    /// that at the start.
    fn fans_slope(&self, motion: &Motion, fan: [f64; 3], dt_s: f64) -> [f64; 3] {
        if !self.model.effects.has_fan_state() {
            return [0.0; 3];
        }
        let nudged = Motion { fan_mm_per_s2: motion.fan_mm_per_s2 + NUDGE, ..*motion };
        let there = self.fans(&nudged, dt_s);
        std::array::from_fn(|i| (there[i] - fan[i]) / NUDGE)
    }
}

/// The rate of a column: slopes by y, v, the fan and the own states, times the column's y, v, own states and fan.
#[inline(always)]
fn along(slopes: &[f64; STATES], column: &[f64], fan: f64) -> f64 {
    let own: f64 = slopes[3..].iter().zip(&column[2..]).map(|(slope, own)| slope * own).sum();
    slopes[0] * column[0] + slopes[1] * column[1] + slopes[2] * fan + own
}

/// The starts of the columns as the sensor sees them.
struct Unit {
    position: Motion,
    velocity: Motion,
    sensed: Motion,
    still: Motion,
}

impl Unit {
    const ALL: Self = {
        let still = Motion::at_rest(0.0, 0.0);
        Self {
            position: Motion { position_mm: 1.0, ..still },
            velocity: Motion { velocity_mm_per_s: 1.0, ..still },
            sensed: Motion { sensed_mm: 1.0, ..still },
            still,
        }
    };
}
