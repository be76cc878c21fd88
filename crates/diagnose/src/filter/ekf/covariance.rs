//! The prediction step of the state covariance: transition matrix and process noise.
//!
//! ```text
//! Φ = ∂motion/∂x                                    see `step`, or exact where a step is a linear map
//! Q = PSD·dt/6 · ( g₀·g₀ᵀ + 4·g·gᵀ + g₁·g₁ᵀ )       white acceleration over a step: Simpson's rule of Φ(s)·e_v
//!     g₀ = e_v, g₁ = Φ·e_v, g = (g₀ + g₁)/2         and δ² of turbulence on w
//! ```

use super::active::Active;
use super::step::Step;
use super::{Square, State};
use plant::{Input, Model, Motion};

/// Number of cached step lengths: a clock of whole milliseconds has few.
const STEPS_KNOWN: usize = 16;

/// What a step of a certain length does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Propagation {
    /// Transition matrix Φ.
    pub(super) transition: Square,
    /// Process noise Q.
    pub(super) noise: Square,
    /// g and h of the whole step, x ← Φ·x + g·command + h·friction, where it is such a map.
    response: Option<[State; 2]>,
}

impl Propagation {
    /// All zeros: the columns of states that the model lacks are never written.
    fn zero() -> Self {
        Self { transition: Square::zeros(), noise: Square::zeros(), response: None }
    }

    /// Sets the step of a model whose motion is a linear map: Φ, g and h are the motions of unit states, of a unit
    /// command and of a unit friction.
    pub(super) fn set_linear(&mut self, active: &Active, step: &Step<'_>) {
        let moved = |state: State, commanded: f64, friction: f64| {
            vector(&motion_of(&state).slide(step.model, Input::of(commanded), friction, step.dt))
        };
        for &i in active.indices() {
            self.transition.set_column(i, &moved(State::from_fn(|j, _| f64::from(u8::from(i == j))), 0.0, 0.0));
        }
        self.set_noise(active, step);
        self.response = Some([moved(State::zeros(), 1.0, 0.0), moved(State::zeros(), 0.0, 1.0)]);
    }

    /// Sets the step at this motion; returns the state after it.
    pub(super) fn set(&mut self, active: &Active, step: &Step<'_>, motion: &Motion) -> State {
        let after = step.moved(active, motion, &mut self.transition);
        self.set_noise(active, step);
        self.response = None;
        after
    }

    /// The state after the step in an endless pipe. `None`: the step is no linear map.
    pub(super) fn moved(&self, active: &Active, state: &State, commanded: f64, friction: f64) -> Option<State> {
        let [by_command, by_friction] = self.response?;
        let mut next = by_command * commanded + by_friction * friction;
        for &j in active.indices() {
            next.axpy(state[j], &self.transition.column(j), 1.0);
        }
        Some(next)
    }

    /// Sets the step `linear` with a friction that changes with the velocity at its start.
    pub(super) fn set_with_friction(&mut self, linear: &Self, active: &Active, step: &Step<'_>, slope_per_s: f64) {
        self.transition = linear.transition;
        if let Some([_, by_friction]) = linear.response {
            self.transition.column_mut(1).axpy(slope_per_s, &by_friction, 1.0);
        }
        self.set_noise(active, step);
        self.response = None;
    }

    /// Sets Q from Φ, for the active states.
    fn set_noise(&mut self, active: &Active, &Step { model, dt, .. }: &Step<'_>) {
        let Self { transition, noise, .. } = self;
        let white = model.noise.acceleration_psd_mm2_per_s3 * dt / 6.0;
        let [first, last] = [State::from_fn(|i, _| f64::from(u8::from(i == 1))), transition.column(1).into_owned()];
        let middle = (first + last) / 2.0;
        for &i in active.indices() {
            for &j in active.indices() {
                noise[(i, j)] = (first[i] * first[j] + 4.0 * (middle[i] * middle[j]) + last[i] * last[j]) * white;
            }
        }
        if let Some(turbulence) = model.effects.coloured_force() {
            noise[(3, 3)] += turbulence.kick(dt).powi(2);
        }
    }
}

/// Φ and Q of the last steps by their length: where the model is linear, steps of the same length share them. They are
/// written in place: most steps of a search set new ones, and each copy is a kilobyte.
#[derive(Debug)]
pub(crate) struct PropagationCache {
    linear: bool,
    /// The step lengths, apart from what belongs to them: the search reads nothing else.
    lengths: Vec<f64>,
    known: Vec<Propagation>,
    next: usize,
    /// For a step that no other shares.
    scratch: Propagation,
}

impl PropagationCache {
    /// An empty cache for `model`.
    pub(crate) fn of(model: &Model) -> Self {
        let effects = &model.effects;
        let linear =
            effects.motion_is_linear_in_command() || effects.motion_is_linear() && effects.friction().is_none();
        Self { linear, lengths: Vec::new(), known: Vec::new(), next: 0, scratch: Propagation::zero() }
    }

    /// The propagation of a step of this length: from the cache where the motion is linear, else as `set` sets it.
    pub(super) fn propagation(&mut self, dt: f64, set: impl FnOnce(&mut Propagation)) -> &Propagation {
        if self.linear {
            return self.shared(dt, set).0;
        }
        set(&mut self.scratch);
        &self.scratch
    }

    /// The propagation that all steps of this length share, set where it is new, and the one for a step that no other
    /// shares.
    pub(super) fn shared(&mut self, dt: f64, set: impl FnOnce(&mut Propagation)) -> (&Propagation, &mut Propagation) {
        let at = self.lengths.iter().position(|known| *known == dt).unwrap_or_else(|| {
            let at = self.replaced(dt);
            set(&mut self.known[at]);
            at
        });
        (&self.known[at], &mut self.scratch)
    }

    /// The place of a new step length: that of the oldest once all are used.
    fn replaced(&mut self, dt: f64) -> usize {
        let at = self.next;
        self.next = (at + 1) % STEPS_KNOWN;
        if at < self.known.len() {
            self.lengths[at] = dt;
        } else {
            self.lengths.push(dt);
            self.known.push(Propagation::zero());
        }
        at
    }
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

#[cfg(test)]
mod tests {
    use super::super::active::Active;
    use super::super::step::Step;
    use super::{Propagation, PropagationCache, Square, State, motion_of, vector};
    use crate::tests_support::model;
    use plant::{Effects, Input, Model, Motion};

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
            // What is cached at the first state must hold at the second.
            let mut cache = PropagationCache::of(&model);
            for motion in &states {
                let active = Active::of(&model);
                // A velocity that is known exactly: friction is not smoothed.
                let step = Step::new(&model, Input::of(commanded), dt, 0.0);
                let transition = cache.propagation(dt, |new| _ = new.set(&active, &step, motion)).transition;
                let expected = by_differences(&model, commanded, motion, dt);
                let off = (transition - expected).abs().max();
                assert!(off < 1e-5, "{}: {off}: {transition} for {expected}", entry.name);
            }
        }
    }

    #[test]
    fn a_linear_step_is_the_motion_of_the_plant() {
        let dt = 0.017;
        let bare = Model { effects: Effects::default(), ..model() };
        let linear = [("fan_lag", &[0.2][..]), ("turbulence", &[300.0, 0.5]), ("sensor_lag", &[0.1])];
        for count in 0..=linear.len() {
            let mut model = bare.clone();
            linear[..count].iter().for_each(|(name, values)| assert!(model.effects.set(name, values)));
            assert!(model.effects.motion_is_linear_in_command());
            let (active, motion) =
                (Active::of(&model), motion_of(&State::from([300.0, -80.0, 90.0, 40.0, 295.0, 0.0, 0.0])));
            let mut linear = Propagation::zero();
            linear.set_linear(&active, &Step::new(&model, Input::of(250.0), dt, 0.0));
            let linear = linear.moved(&active, &vector(&motion), 250.0, 0.0).unwrap();
            let exact = vector(&motion.step_in_endless_pipe(&model, Input::of(250.0), dt));
            let off = (linear - exact).abs().max();
            assert!(off < 1e-11, "{count}: {linear} for {exact}");
        }
        for name in ["height_dependent_flow", "quadratic_drag", "spin_asymmetry"] {
            let mut model = bare.clone();
            let entry = Effects::CATALOGUE.iter().find(|entry| entry.name == name).unwrap();
            assert!(model.effects.set(name, entry.sizes[0]));
            assert!(!model.effects.motion_is_linear_in_command(), "{name}");
        }
    }

    #[test]
    fn a_linear_step_with_friction_is_that_of_the_plant_with_its_derivatives_sliding_and_averaged() {
        let (dt, commanded) = (0.017, 250.0);
        let mut model = model();
        assert!(model.effects.set("wall_friction", &[200.0]));
        let active = Active::of(&model);
        let [mut linear, mut sliding] = [Propagation::zero(), Propagation::zero()];
        linear.set_linear(&active, &Step::new(&model, Input::of(commanded), dt, 0.0));
        for (velocity, roughness) in [(80.0, 0.0), (-80.0, 0.0), (30.0, 60.0), (0.0, 60.0)] {
            let motion = motion_of(&State::from([300.0, velocity, 90.0, 0.0, 300.0, 0.0, 0.0]));
            let step = Step::new(&model, Input::of(commanded), dt, roughness);
            let friction = step.friction(&motion).unwrap();
            let mut transition = Square::zeros();
            let after = step.moved(&active, &motion, &mut transition);
            let found = linear.moved(&active, &vector(&motion), commanded, friction.mm_per_s2).unwrap();
            sliding.set_with_friction(&linear, &active, &step, friction.slope_per_s);
            let slopes = sliding.transition;
            let own = active.indices();
            let off = |a: f64, b: f64| (a - b).abs();
            let most = own.iter().map(|&i| off(found[i], after[i])).fold(0.0, f64::max);
            assert!(most < 1e-10, "{velocity}: {found} for {after}");
            let entries = own.iter().flat_map(|&i| own.iter().map(move |&j| (i, j)));
            let most = entries.map(|at| off(slopes[at], transition[at])).fold(0.0, f64::max);
            assert!(most < 1e-10, "{velocity}: {slopes} for {transition}");
        }
    }
}
