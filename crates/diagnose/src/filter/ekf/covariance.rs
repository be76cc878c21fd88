//! The prediction step of the state covariance: transition matrix and process noise.
//!
//! ```text
//! Φ = ∂motion/∂x                                    by central differences
//! Q = PSD·dt/6 · ( g₀·g₀ᵀ + 4·g·gᵀ + g₁·g₁ᵀ )       white acceleration over a step: Simpson's rule of Φ(s)·e_v
//!     g₀ = e_v, g₁ = Φ·e_v, g = (g₀ + g₁)/2         and δ² of turbulence on w
//! ```

use super::{STATES, Square, State};
use nalgebra::SMatrix;
use plant::{Model, Motion};

/// Steps of the central differences: small compared with the motion of a flight, large compared with rounding errors.
const NUDGE: [f64; STATES] = [1e-3, 1e-2, 1e-1, 1e-1, 1e-3];
/// Number of cached step lengths: a clock of whole milliseconds has few.
const STEPS_KNOWN: usize = 16;

/// A covariance smaller than this, in any unit, counts as 0. The variance of a state without process noise, such as
/// that of a fan lag, tends to 0, and subnormal numbers make a step ten times slower.
const NEGLIGIBLE: f64 = 1e-100;

/// The number, or 0 where it is negligible.
pub(super) fn flush_tiny(number: f64) -> f64 {
    if number.abs() < NEGLIGIBLE { 0.0 } else { number }
}

/// Transition matrix Φ and process noise Q of a step of a certain length.
pub(super) type Propagation = (Square, Square);

/// Φ and Q of the last steps by their length: where the model is linear, steps of the same length share them.
#[derive(Debug)]
pub(crate) struct PropagationCache {
    linear: bool,
    known: Vec<(f64, Propagation)>,
    next: usize,
}

impl PropagationCache {
    /// An empty cache for `model`.
    pub(crate) fn of(model: &Model) -> Self {
        Self { linear: model.effects.motion_is_linear(), known: Vec::new(), next: 0 }
    }

    pub(super) fn propagation(&mut self, dt: f64, compute: impl FnOnce() -> Propagation) -> Propagation {
        if !self.linear {
            return compute();
        }
        if let Some((_, propagation)) = self.known.iter().find(|(known, _)| *known == dt) {
            return *propagation;
        }
        let propagation = compute();
        if self.known.len() < STEPS_KNOWN {
            self.known.push((dt, propagation));
        } else {
            self.known[self.next] = (dt, propagation);
            self.next = (self.next + 1) % STEPS_KNOWN;
        }
        propagation
    }
}

/// P ← Φ·P·Φᵀ + Q, for the active states of `model` alone: the covariance of the others is never used. Most models have
/// two active states of five, and this product takes most of the time of a search.
pub(super) fn predict_covariance(model: &Model, (transition, noise): &Propagation, covariance: &Square) -> Square {
    let mut own = [0; STATES];
    let mut count = 0;
    for (i, _) in active_states(model).iter().enumerate().filter(|(_, active)| **active) {
        own[count] = i;
        count += 1;
    }
    let [a, b, c, d, e] = own;
    match count {
        2 => predict_covariance_in([a, b], transition, noise, covariance),
        3 => predict_covariance_in([a, b, c], transition, noise, covariance),
        4 => predict_covariance_in([a, b, c, d], transition, noise, covariance),
        _ => predict_covariance_in([a, b, c, d, e], transition, noise, covariance),
    }
}

fn predict_covariance_in<const N: usize>(
    own: [usize; N],
    transition: &Square,
    noise: &Square,
    covariance: &Square,
) -> Square {
    let of = |all: &Square| SMatrix::<f64, N, N>::from_fn(|i, j| all[(own[i], own[j])]);
    let transition = of(transition);
    let known = transition * of(covariance) * transition.transpose() + of(noise);
    let mut all = Square::zeros();
    for (i, at) in own.iter().enumerate() {
        for (j, and) in own.iter().enumerate() {
            all[(*at, *and)] = flush_tiny(known[(i, j)]);
        }
    }
    all
}

/// The process noise of a step with this transition matrix.
pub(super) fn process_noise(model: &Model, transition: &Square, dt: f64) -> Square {
    let first = State::from([0.0, 1.0, 0.0, 0.0, 0.0]);
    let last = transition * first;
    let middle = (first + last) / 2.0;
    let outer = |g: State| g * g.transpose();
    let white = model.noise.acceleration_psd_mm2_per_s3 * dt / 6.0;
    let mut noise = (outer(first) + 4.0 * outer(middle) + outer(last)) * white;
    if let Some(turbulence) = model.effects.coloured_force() {
        noise[(3, 3)] += turbulence.kick(dt).powi(2);
    }
    noise
}

/// The state vector of a motion.
pub(super) fn vector(motion: &Motion) -> State {
    State::from([
        motion.position_mm,
        motion.velocity_mm_per_s,
        motion.fan_mm_per_s2,
        motion.turbulence_mm_per_s2,
        motion.sensed_mm,
    ])
}

/// Which states are active in this model; the others follow from them or from the command.
pub(super) fn active_states(model: &Model) -> [bool; STATES] {
    let effects = &model.effects;
    [true, true, effects.has_fan_state(), effects.coloured_force().is_some(), effects.has_sensor_state()]
}

/// ∂flow/∂x at `motion` by central differences, for the active states of this model.
pub(super) fn derivative(model: &Model, flow: impl Fn(&Motion) -> Motion, motion: &Motion) -> Square {
    let mut transition = Square::zeros();
    for (i, _) in active_states(model).iter().enumerate().filter(|(_, active)| **active) {
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

#[cfg(test)]
mod tests {
    use super::{PropagationCache, Square, active_states, derivative, predict_covariance, vector};
    use crate::tests_support::model;
    use plant::{Effects, Model, Motion};

    /// A test matrix without symmetry, with entries of both signs.
    fn any(seed: f64) -> Square {
        Square::from_fn(|i, j| (seed + 7.1 * i as f64 + 3.3 * j as f64).sin())
    }

    /// The transition matrix of a step by central differences of the motion, with other steps than those under test.
    fn by_differences(model: &Model, commanded: f64, motion: &Motion, dt: f64) -> Square {
        let column = |i: usize| {
            let by = [1e-2, 1e-1, 1.0, 1.0, 1e-2][i];
            let at = |sign: f64| {
                let mut state = vector(motion);
                state[i] += sign * by;
                let [position_mm, velocity_mm_per_s, fan_mm_per_s2, turbulence_mm_per_s2, sensed_mm] = state.into();
                let there = Motion { position_mm, velocity_mm_per_s, fan_mm_per_s2, turbulence_mm_per_s2, sensed_mm };
                vector(&there.step_in_endless_pipe(model, commanded, dt))
            };
            (at(1.0) - at(-1.0)) / (2.0 * by)
        };
        let active = active_states(model);
        Square::from_fn(|i, j| if active[j] { column(j)[i] } else { 0.0 })
    }

    #[test]
    fn the_transition_of_every_effect_is_that_of_its_motion_at_each_of_two_states() {
        let (dt, commanded) = (0.02, 300.0);
        let state = |position_mm, velocity_mm_per_s, fan_mm_per_s2| Motion {
            position_mm,
            velocity_mm_per_s,
            fan_mm_per_s2,
            turbulence_mm_per_s2: 40.0,
            sensed_mm: position_mm - 3.0,
        };
        // The fan below the command and above it, the ball low and rising, high and falling.
        let states = [state(180.0, 150.0, 100.0), state(430.0, -220.0, 500.0)];
        let bare = Model { effects: Effects::default(), ..model() };
        for entry in Effects::CATALOGUE {
            let mut model = bare.clone();
            model.effects.set(entry.name, entry.sizes[0]);
            if model.effects.friction().is_some() {
                continue; // The filter averages friction over the distribution of the velocity; see `Ekf::step`.
            }
            // What is cached at the first state must hold at the second.
            let mut cache = PropagationCache::of(&model);
            for motion in &states {
                let flow = |nudged: &Motion| nudged.step_in_endless_pipe(&model, commanded, dt);
                let (transition, _) = cache.propagation(dt, || (derivative(&model, flow, motion), Square::zeros()));
                let expected = by_differences(&model, commanded, motion, dt);
                let off = (transition - expected).abs().max();
                assert!(off < 1e-5, "{}: {off}: {transition} for {expected}", entry.name);
            }
        }
    }

    #[test]
    fn doubt_grows_as_the_whole_product_says_in_the_states_that_are_remembered() {
        let none = Model { effects: Effects::default(), ..model() };
        let mut all = model();
        all.effects.set("turbulence", &[300.0, 0.5]);
        let mut two = all.clone();
        all.effects.set("sensor_lag", &[0.1]);
        two.effects.remove("fan_lag");
        for (model, own) in [(none, &[0, 1][..]), (model(), &[0, 1, 2]), (two, &[0, 1, 3]), (all, &[0, 1, 2, 3, 4])] {
            let is_own = |i: usize| own.contains(&i);
            let of_own = |m: Square| Square::from_fn(|i, j| if is_own(i) && is_own(j) { m[(i, j)] } else { 0.0 });
            let [transition, noise, before] = [1.0, 2.0, 3.0].map(|seed| of_own(any(seed)));
            let whole = transition * before * transition.transpose() + noise;
            let predict_covariance = predict_covariance(&model, &(transition, noise), &before);
            assert!((predict_covariance - whole).abs().max() < 1e-14, "{predict_covariance} for {whole}");
            // The entries of the other states must not be used.
            let spoilt = Square::from_fn(|i, j| if is_own(i) && is_own(j) { before[(i, j)] } else { f64::NAN });
            assert_eq!(super::predict_covariance(&model, &(transition, noise), &spoilt), predict_covariance);
        }
    }

    #[test]
    fn doubt_that_fades_becomes_none_and_no_number_too_small_for_the_processor() {
        let (mut doubt, halve) = (any(1.0), Square::identity() * 0.5);
        for _ in 0..600 {
            doubt = predict_covariance(&model(), &(halve, Square::zeros()), &doubt);
            assert!(doubt.iter().all(|number| *number == 0.0 || number.is_normal()), "{doubt}");
        }
        assert_eq!(doubt, Square::zeros());
    }
}
