//! The prediction step of the state covariance: transition matrix and process noise.
//!
//! ```text
//! Φ = ∂motion/∂x                                    by central differences, or automatically: see `step`
//! Q = PSD·dt/6 · ( g₀·g₀ᵀ + 4·g·gᵀ + g₁·g₁ᵀ )       white acceleration over a step: Simpson's rule of Φ(s)·e_v
//!     g₀ = e_v, g₁ = Φ·e_v, g = (g₀ + g₁)/2         and δ² of turbulence on w
//! ```

use super::{STATES, Square, State};
use nalgebra::SMatrix;
use plant::{Model, Motion};

/// Steps of the central differences: small compared with the motion of a flight, large compared with rounding errors.
const NUDGE: [f64; STATES] = [1e-3, 1e-2, 1e-1, 1e-1, 1e-3, 1e-3, 1e-3];
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

    pub(super) fn propagation(&mut self, dt: f64, compute: impl FnOnce() -> Propagation) -> &Propagation {
        let same = if self.linear { self.known.iter().position(|(known, _)| *known == dt) } else { None };
        let at = same.unwrap_or_else(|| self.keep(dt, compute()));
        &self.known[at].1
    }

    /// Keeps a new one in the place of the oldest, and returns its place. Where the motion is not linear, none is used
    /// again, and one place is enough.
    fn keep(&mut self, dt: f64, propagation: Propagation) -> usize {
        let places = if self.linear { STEPS_KNOWN } else { 1 };
        let at = self.next;
        self.next = (at + 1) % places;
        if at < self.known.len() {
            self.known[at] = (dt, propagation);
        } else {
            self.known.push((dt, propagation));
        }
        at
    }
}

/// Evaluates an expression with the indices of the active states as an array, whose length the compiler then knows.
macro_rules! in_active {
    ($active:expr, $own:ident => $body:expr) => {{
        let [a, b, c, d, e, f, g] = $active.own;
        match $active.count {
            2 => in_active!($own = [a, b] => $body),
            3 => in_active!($own = [a, b, c] => $body),
            4 => in_active!($own = [a, b, c, d] => $body),
            5 => in_active!($own = [a, b, c, d, e] => $body),
            6 => in_active!($own = [a, b, c, d, e, f] => $body),
            _ => in_active!($own = [a, b, c, d, e, f, g] => $body),
        }
    }};
    ($own:ident = $indices:expr => $body:expr) => {{
        let $own = $indices;
        $body
    }};
}

/// The active states of a model; the others follow from them or from the command. Most models have two of seven, and
/// the products of the covariance take most of the time of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    own: [usize; STATES],
    count: usize,
}

impl Active {
    pub(super) fn of(model: &Model) -> Self {
        let effects = &model.effects;
        let (fan, sensor) = (effects.has_fan_state(), effects.has_sensor_state());
        let (air, number) = (effects.coloured_force().is_some(), effects.own_states());
        let active = [true, true, fan, air, sensor, number > 0, number > 1];
        let (mut own, mut count) = ([0; STATES], 0);
        for (i, _) in active.iter().enumerate().filter(|(_, active)| **active) {
            own[count] = i;
            count += 1;
        }
        Self { own, count }
    }

    /// Their indices, ascending.
    #[inline(always)]
    pub(super) fn indices(&self) -> &[usize] {
        &self.own[..self.count]
    }

    /// P ← Φ·P·Φᵀ + Q. The covariance of the other states is never used.
    pub(super) fn predict(&self, (transition, noise): &Propagation, covariance: &mut Square) {
        in_active!(self, own => predict_in(own, transition, noise, covariance));
    }

    /// P ← P − t·tᵀ·share.
    #[inline]
    pub(super) fn reduce(&self, covariance: &mut Square, towards: &State, share: f64) {
        for &i in self.indices() {
            for &j in self.indices() {
                covariance[(i, j)] -= towards[i] * towards[j] * share;
            }
        }
    }

    /// Φ·δ.
    #[inline]
    pub(super) fn transfer(&self, transition: &Square, change: &State) -> State {
        in_active!(self, own => transfer_in(own, transition, change))
    }
}

#[inline(always)]
fn transfer_in<const N: usize>(own: [usize; N], transition: &Square, change: &State) -> State {
    let mut moved = State::zeros();
    for i in own {
        moved[i] = own.iter().map(|j| transition[(i, *j)] * change[*j]).sum();
    }
    moved
}

#[inline(always)]
fn predict_in<const N: usize>(own: [usize; N], transition: &Square, noise: &Square, covariance: &mut Square) {
    let of = |all: &Square| SMatrix::<f64, N, N>::from_fn(|i, j| all[(own[i], own[j])]);
    let transition = of(transition);
    let known = transition * of(covariance) * transition.transpose() + of(noise);
    for (i, at) in own.iter().enumerate() {
        for (j, and) in own.iter().enumerate() {
            covariance[(*at, *and)] = flush_tiny(known[(i, j)]);
        }
    }
}

/// The process noise of a step with this transition matrix.
pub(super) fn process_noise(model: &Model, transition: &Square, dt: f64) -> Square {
    let first = State::from_fn(|i, _| f64::from(u8::from(i == 1)));
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
        motion.own[0],
        motion.own[1],
    ])
}

/// The motion of a state vector.
pub(super) fn motion_of(state: &State) -> Motion {
    let [position_mm, velocity_mm_per_s, fan_mm_per_s2, turbulence_mm_per_s2, sensed_mm, first, second] =
        (*state).into();
    let own = [first, second];
    Motion { position_mm, velocity_mm_per_s, fan_mm_per_s2, turbulence_mm_per_s2, sensed_mm, own }
}

/// ∂flow/∂x at `motion` by central differences, for the active states.
pub(super) fn derivative(active: &Active, flow: impl Fn(&Motion) -> Motion, motion: &Motion) -> Square {
    let mut transition = Square::zeros();
    for &i in active.indices() {
        let nudged = |by: f64| {
            let mut nudged = vector(motion);
            nudged[i] += by;
            vector(&flow(&motion_of(&nudged)))
        };
        transition.set_column(i, &((nudged(NUDGE[i]) - nudged(-NUDGE[i])) / (2.0 * NUDGE[i])));
    }
    transition
}

#[cfg(test)]
mod tests {
    use super::{Active, PropagationCache, Square, derivative, motion_of, vector};
    use crate::tests_support::model;
    use plant::{Effects, Input, Model, Motion};

    /// A test matrix without symmetry, with entries of both signs.
    fn any(seed: f64) -> Square {
        Square::from_fn(|i, j| (seed + 7.1 * i as f64 + 3.3 * j as f64).sin())
    }

    /// The transition matrix of a step by central differences of the motion, with other steps than those under test.
    fn by_differences(model: &Model, commanded: f64, motion: &Motion, dt: f64) -> Square {
        let column = |i: usize| {
            let by = [1e-2, 1e-1, 1.0, 1.0, 1e-2, 1e-2, 1e-2][i];
            let at = |sign: f64| {
                let mut state = vector(motion);
                state[i] += sign * by;
                let there = motion_of(&state);
                vector(&there.step_in_endless_pipe(model, Input::of(commanded), dt))
            };
            (at(1.0) - at(-1.0)) / (2.0 * by)
        };
        let active = Active::of(model);
        Square::from_fn(|i, j| if active.indices().contains(&j) { column(j)[i] } else { 0.0 })
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
            own: [70.0, -20.0],
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
                let flow = |nudged: &Motion| nudged.step_in_endless_pipe(&model, Input::of(commanded), dt);
                let (transition, _) =
                    *cache.propagation(dt, || (derivative(&Active::of(&model), flow, motion), Square::zeros()));
                let expected = by_differences(&model, commanded, motion, dt);
                let off = (transition - expected).abs().max();
                assert!(off < 1e-5, "{}: {off}: {transition} for {expected}", entry.name);
            }
        }
    }

    #[test]
    fn the_covariance_of_the_active_states_is_that_of_the_whole_product() {
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
            let mut after = before;
            Active::of(&model).predict(&(transition, noise), &mut after);
            assert!((after - whole).abs().max() < 1e-14, "{after} for {whole}");
            // The entries of the other states must not be used.
            let mut spoilt = Square::from_fn(|i, j| if is_own(i) && is_own(j) { before[(i, j)] } else { f64::NAN });
            Active::of(&model).predict(&(transition, noise), &mut spoilt);
            assert_eq!(of_own(spoilt), after);
        }
    }

    #[test]
    fn a_covariance_that_decays_becomes_zero_and_no_subnormal_number() {
        let own = |m: Square| Square::from_fn(|i, j| if i < 3 && j < 3 { m[(i, j)] } else { 0.0 });
        let (mut covariance, halve) = (own(any(1.0)), Square::identity() * 0.5);
        for _ in 0..600 {
            Active::of(&model()).predict(&(halve, Square::zeros()), &mut covariance);
            assert!(covariance.iter().all(|number| *number == 0.0 || number.is_normal()), "{covariance}");
        }
        assert_eq!(covariance, Square::zeros());
    }
}
