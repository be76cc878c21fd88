//! The forms of the effects: closures along the signal path, each with its own memory.
//!
//! On purpose they are not the formulas that a diagnosis fits: soft edges, several elements instead of one, exponential
//! approaches instead of straight lines. Each documents in which sense the catalogue's parameter is its equivalent.

pub(crate) mod clutter;
pub(crate) mod curves;
pub(crate) mod forces;
pub(crate) mod memory;
pub(crate) mod outside;
pub(crate) mod sensor;

use std::collections::VecDeque;

/// The step of the world, s.
pub(crate) const STEP_S: f64 = 0.000_25;

/// A part of the signal path, once a step: value in, time in the record in (negative before its start), value out.
pub(crate) type Link = Box<dyn FnMut(f64, f64) -> f64>;

/// A force on the ball: height in mm, speed in mm/s, time in s; acceleration out, mm/s².
pub(crate) type Force = Box<dyn FnMut(f64, f64, f64) -> f64>;

/// What the stream of air adds: the acceleration of the fan's air at rest in mm/s², speed in mm/s; acceleration out.
pub(crate) type Stream = Box<dyn Fn(f64, f64) -> f64>;

/// The last values of a signal, one a step.
pub(crate) struct History {
    values: VecDeque<f64>,
    capacity: usize,
}

impl History {
    /// Keeps this many seconds.
    pub(crate) fn of(seconds: f64) -> Self {
        Self { values: VecDeque::new(), capacity: (seconds / STEP_S).ceil() as usize + 2 }
    }

    /// Adds the value of this step.
    pub(crate) fn push(&mut self, value: f64) {
        self.values.push_front(value);
        self.values.truncate(self.capacity);
    }

    /// The value this long ago, linear between steps; the oldest if none is that old.
    pub(crate) fn ago(&self, seconds: f64) -> f64 {
        let steps = seconds / STEP_S;
        let at = |i: usize| self.values[i.min(self.values.len() - 1)];
        let (whole, part) = (steps.floor() as usize, steps.fract());
        at(whole) + part * (at(whole + 1) - at(whole))
    }
}

/// One step of a first-order lag, exact for a constant input.
pub(crate) fn follow(state: &mut f64, input: f64, time_constant_s: f64) -> f64 {
    *state += (input - *state) * -(-STEP_S / time_constant_s).exp_m1();
    *state
}

/// A step of first-order lag whose factor was computed before: see [`follow`].
pub(crate) fn lag(time_constant_s: f64) -> impl FnMut(f64) -> f64 {
    let (share, mut state) = (-(-STEP_S / time_constant_s).exp_m1(), None);
    move |input| {
        let now = state.get_or_insert(input);
        *now += (input - *now) * share;
        *now
    }
}

/// An exponential approach at time t of a record of this length: 0 at its start, its whole length at its end, 1 s/s on
/// average. The time constant is twice the length.
pub(crate) fn approach(t: f64, seconds: f64) -> f64 {
    seconds * (-t.max(0.0) / (2.0 * seconds)).exp_m1() / (-0.5_f64).exp_m1()
}
