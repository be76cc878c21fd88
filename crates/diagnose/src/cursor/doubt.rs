//! How doubt about the state grows over a step: its transition and what the air adds.
//!
//! ```text
//! Φ = ∂motion/∂x                                    by central differences
//! Q = PSD·dt/6 · ( g₀·g₀ᵀ + 4·g·gᵀ + g₁·g₁ᵀ )       white acceleration over a step: Simpson's rule of Φ(s)·e_v
//!     g₀ = e_v, g₁ = Φ·e_v, g = (g₀ + g₁)/2         and δ² of turbulence on w
//! ```

use super::{STATES, Square, State};
use plant::{Model, Motion};

/// Steps of the differences, each small beside a flight and large beside rounding.
const NUDGE: [f64; STATES] = [1e-3, 1e-2, 1e-1, 1e-1, 1e-3];
/// Lengths of steps that are remembered: a clock of whole milliseconds has few.
const STEPS_KNOWN: usize = 16;

/// How a step of a certain length moves doubt: Φ and Q.
pub(super) type Doubt = (Square, Square);

/// The last steps' Φ and Q by their length: where the model is linear, steps of one length share them.
#[derive(Debug)]
pub(crate) struct Steps {
    linear: bool,
    known: Vec<(f64, Doubt)>,
    next: usize,
}

impl Steps {
    /// Steps of `model`.
    pub(crate) fn of(model: &Model) -> Self {
        let effects = &model.effects;
        let bent =
            effects.quadratic_drag.is_some() || effects.wall_friction.is_some() || effects.spin_asymmetry.is_some();
        Self { linear: !bent, known: Vec::new(), next: 0 }
    }

    pub(super) fn doubt(&mut self, dt: f64, compute: impl FnOnce() -> Doubt) -> Doubt {
        if !self.linear {
            return compute();
        }
        if let Some((_, doubt)) = self.known.iter().find(|(known, _)| *known == dt) {
            return *doubt;
        }
        let doubt = compute();
        if self.known.len() < STEPS_KNOWN {
            self.known.push((dt, doubt));
        } else {
            self.known[self.next] = (dt, doubt);
            self.next = (self.next + 1) % STEPS_KNOWN;
        }
        doubt
    }
}

/// The covariance that the air gathers over a step with this `transition`.
pub(super) fn process_noise(model: &Model, transition: &Square, dt: f64) -> Square {
    let first = State::from([0.0, 1.0, 0.0, 0.0, 0.0]);
    let last = transition * first;
    let middle = (first + last) / 2.0;
    let outer = |g: State| g * g.transpose();
    let white = model.noise.acceleration_psd_mm2_per_s3 * dt / 6.0;
    let mut noise = (outer(first) + 4.0 * outer(middle) + outer(last)) * white;
    if let Some(turbulence) = model.effects.turbulence {
        noise[(3, 3)] += turbulence.kick(dt).powi(2);
    }
    noise
}

/// A motion as a state.
pub(super) fn vector(motion: &Motion) -> State {
    State::from([
        motion.position_mm,
        motion.velocity_mm_per_s,
        motion.fan_mm_per_s2,
        motion.turbulence_mm_per_s2,
        motion.sensed_mm,
    ])
}

/// Which states this model remembers; the others follow from them or from the command.
pub(super) const fn remembered(model: &Model) -> [bool; STATES] {
    let effects = &model.effects;
    let lags = effects.fan_lag.is_some() || effects.spin_asymmetry.is_some();
    [true, true, lags, effects.turbulence.is_some(), effects.sensor_lag.is_some()]
}

/// ∂flow/∂x at `motion` by differences, for the states that this model remembers.
pub(super) fn derivative(model: &Model, flow: impl Fn(&Motion) -> Motion, motion: &Motion) -> Square {
    let mut transition = Square::zeros();
    for (i, _) in remembered(model).iter().enumerate().filter(|(_, remembered)| **remembered) {
        let nudged = |by: f64| {
            let mut nudged = *motion;
            match i {
                0 => nudged.position_mm += by,
                1 => nudged.velocity_mm_per_s += by,
                2 => nudged.fan_mm_per_s2 += by,
                3 => nudged.turbulence_mm_per_s2 += by,
                _ => nudged.sensed_mm += by,
            }
            vector(&flow(&nudged))
        };
        transition.set_column(i, &((nudged(NUDGE[i]) - nudged(-NUDGE[i])) / (2.0 * NUDGE[i])));
    }
    transition
}
