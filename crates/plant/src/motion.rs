//! The ball in its air stream, event by event.
//!
//! ```text
//! y free, or held at rest: by friction while |net| ≤ f, at an end while the ball would leave the pipe
//! v crosses 0 with friction: the ball stops at that instant
//! y crosses an end:          v ← −e·v at that instant; a hop shorter than the step is none
//! ```
//!
//! The instants are solved for, so that a step of any length ends where a hundred short ones do. A ball that is
//! held is asked anew at each step whether it breaks away.
//! Source: see [`crate::effects::WallFriction`] and [`crate::effects::EndStop`].

use crate::flow::Flow;
use crate::model::Model;
use crate::root::falling_zero;
use crate::tangent::{Derivatives, Friction, Phase};

/// More events than this in one step are the chatter of a ball at rest.
pub(crate) const MAX_EVENTS: u32 = 8;

/// The number of states that an effect may have of its own.
pub const OWN_STATES: usize = 2;

/// The input of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// The acceleration that the duty commands, mm/s² about hover, constant during the step.
    pub commanded_mm_per_s2: f64,
    /// Time at the start of the step, seconds since the start of the flight.
    pub time_s: f64,
    /// The setpoint in force, mm, where it is known.
    pub setpoint_mm: Option<f64>,
}

impl Input {
    /// A command of so many mm/s² at time 0, with no known setpoint.
    #[must_use]
    pub const fn of(commanded_mm_per_s2: f64) -> Self {
        Self { commanded_mm_per_s2, time_s: 0.0, setpoint_mm: None }
    }

    pub(crate) const fn later(self, by_s: f64) -> Self {
        Self { time_s: self.time_s + by_s, ..self }
    }
}

/// State of the plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// y, mm above the bottom of the pipe.
    pub position_mm: f64,
    /// v, mm/s, upward.
    pub velocity_mm_per_s: f64,
    /// A, mm/s²: what the fan's air does to the ball at rest, about hover.
    pub fan_mm_per_s2: f64,
    /// w, mm/s²: what turbulence adds to it.
    pub turbulence_mm_per_s2: f64,
    /// s, mm: the position as the sensor's lag shows it; without that effect the position itself.
    pub sensed_mm: f64,
    /// The own states of the effect that has some; 0 without.
    pub own: [f64; OWN_STATES],
}

/// Where the ball's way ends.
#[derive(Clone, Copy)]
struct Ends {
    bottom: f64,
    top: f64,
}

impl Ends {
    const NONE: Self = Self { bottom: f64::NEG_INFINITY, top: f64::INFINITY };

    /// The end that lies before `position` on the way out, and the direction of that way.
    fn passed(&self, position: f64) -> Option<(f64, f64)> {
        if position < self.bottom {
            Some((self.bottom, -1.0))
        } else if position > self.top {
            Some((self.top, 1.0))
        } else {
            None
        }
    }

    /// The way out for a ball at an end: −1 at the bottom, +1 at the top, 0 elsewhere.
    fn way_out(&self, position: f64) -> f64 {
        if position <= self.bottom {
            -1.0
        } else if position >= self.top {
            1.0
        } else {
            0.0
        }
    }
}

impl Motion {
    /// The ball at rest at `position_mm` with the fan settled at `commanded` mm/s².
    #[must_use]
    pub const fn at_rest(position_mm: f64, commanded: f64) -> Self {
        Self {
            position_mm,
            velocity_mm_per_s: 0.0,
            fan_mm_per_s2: commanded,
            turbulence_mm_per_s2: 0.0,
            sensed_mm: position_mm,
            own: [0.0; OWN_STATES],
        }
    }

    /// The mean motion over `dt_s` under a constant command: nothing random is added.
    // Inlined as `Flow::free` is, for the same reason; what happens at an event is kept out of the way.
    #[must_use]
    #[inline(always)]
    pub fn step(&self, model: &Model, input: Input, dt_s: f64) -> Self {
        let (bottom, top) = model.ends_mm();
        self.advance(&Flow { model, input }, Ends { bottom, top }, dt_s)
    }

    /// The same step where the pipe has no ends.
    #[must_use]
    pub fn step_in_endless_pipe(&self, model: &Model, input: Input, dt_s: f64) -> Self {
        self.advance(&Flow { model, input }, Ends::NONE, dt_s)
    }

    /// The same step where the pipe has no ends and friction is the constant acceleration `friction_mm_per_s2`: for
    /// those who know the velocity only roughly, and so the mean of what friction does.
    #[must_use]
    pub fn slide(&self, model: &Model, input: Input, friction_mm_per_s2: f64, dt_s: f64) -> Self {
        Flow { model, input }.free(self, friction_mm_per_s2, dt_s)
    }

    /// The same step, and its derivatives by the states at its start.
    #[must_use]
    pub fn slide_with_derivatives(
        &self,
        model: &Model,
        input: Input,
        friction: Friction,
        dt_s: f64,
    ) -> (Self, Derivatives) {
        Flow { model, input }.with_derivatives(self, Phase::Sliding(friction), dt_s)
    }

    #[inline(always)]
    fn advance(self, flow: &Flow<'_>, ends: Ends, dt_s: f64) -> Self {
        if ends.way_out(self.position_mm) == 0.0 && flow.model.effects.friction().is_none() {
            // The usual case, and the only one that has to be fast: in the air before the step and after it.
            let free = flow.free(&self, 0.0, dt_s);
            if ends.passed(free.position_mm).is_none() {
                return free;
            }
        }
        self.advance_through_events(flow, ends, dt_s)
    }

    #[inline(never)]
    fn advance_through_events(mut self, flow: &Flow<'_>, ends: Ends, dt_s: f64) -> Self {
        let mut left = dt_s;
        if let Some((end, _)) = ends.passed(self.position_mm) {
            self = self.moved_to(end, self.velocity_mm_per_s, flow.model);
        }
        for _ in 0..MAX_EVENTS {
            let rest = Flow { input: flow.input.later(dt_s - left), ..*flow };
            let (after, used) = self.until_event(&rest, ends, left);
            (self, left) = (after, left - used);
            if left <= 0.0 {
                return self;
            }
        }
        Flow { input: flow.input.later(dt_s - left), ..*flow }.held(&self, left)
    }

    /// Moves on to the next event, or for all of `dt_s`; and how long that took.
    fn until_event(mut self, flow: &Flow<'_>, ends: Ends, dt_s: f64) -> (Self, f64) {
        let out = ends.way_out(self.position_mm);
        if self.velocity_mm_per_s * out > 0.0 {
            self.velocity_mm_per_s = flow.model.rebound(self.velocity_mm_per_s);
        }
        let Some(direction) = self.slides(flow) else { return (flow.held(&self, dt_s), dt_s) };
        let friction = flow.model.effects.friction().map_or(0.0, |friction| friction.acceleration(direction));
        let last = self.until_stop(flow, direction, friction, dt_s);
        self.until_end(flow, friction, ends, last)
    }

    /// The direction in which the ball slides, or begins to slide. `None`: friction holds it.
    pub(crate) fn slides(&self, flow: &Flow<'_>) -> Option<f64> {
        let v = self.velocity_mm_per_s;
        let net = if v == 0.0 { flow.net(self) } else { v };
        let friction = flow.model.effects.friction().filter(|friction| friction.acceleration_mm_per_s2 > 0.0);
        let is_held = v == 0.0 && friction.is_some_and(|friction| friction.holds(net));
        (!is_held).then(|| net.signum())
    }

    /// The motion under a constant friction until friction stops the ball, or for all of `dt_s`; and how long that
    /// took.
    pub(crate) fn until_stop(&self, flow: &Flow<'_>, direction: f64, friction: f64, dt_s: f64) -> (Self, f64) {
        let slide = |t: f64| flow.free(self, friction, t);
        let last = slide(dt_s);
        if last.still_slides(direction, friction) {
            return (last, dt_s);
        }
        let stop = falling_zero(|t| slide(t).velocity_mm_per_s * direction, dt_s);
        (Self { velocity_mm_per_s: 0.0, ..slide(stop) }, stop)
    }

    /// Whether a slide in `direction` under this friction ends here without a stop on the way.
    pub(crate) fn still_slides(&self, direction: f64, friction: f64) -> bool {
        friction == 0.0 || self.velocity_mm_per_s * direction >= 0.0
    }

    /// What becomes of a free motion to `last` when an end of the pipe is in its way.
    fn until_end(&self, flow: &Flow<'_>, friction: f64, ends: Ends, last: (Self, f64)) -> (Self, f64) {
        let Some((end, out)) = ends.passed(last.0.position_mm) else { return last };
        if self.position_mm == end {
            // A hop shorter than the step, or none: the ball rests.
            return (flow.held(self, last.1), last.1);
        }
        let free = |t: f64| flow.free(self, friction, t);
        let hit = falling_zero(|t| (end - free(t).position_mm) * out, last.1);
        let at_hit = free(hit);
        (at_hit.moved_to(end, flow.model.rebound(at_hit.velocity_mm_per_s), flow.model), hit)
    }

    /// The same at another position and velocity.
    fn moved_to(self, position_mm: f64, velocity_mm_per_s: f64, model: &Model) -> Self {
        let sensed_mm = if model.effects.has_sensor_state() { self.sensed_mm } else { position_mm };
        Self { position_mm, velocity_mm_per_s, sensed_mm, ..self }
    }
}

#[cfg(test)]
mod tests;
