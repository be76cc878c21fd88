//! A ball that is pushed and does not move: jammed, or above a fan that does not turn.
//!
//! ```text
//! stuck:   |control| ≥ [safety] stuck.control_percent, with one sign, while max − min of the position ≤ 20 mm,
//!          for [safety] stuck.after_s
//! ```
//!
//! A free ball cannot do that: on the plant of `config.toml` one percent about hover moves it at 200 mm/s. The
//! exception is a ball at an end of the pipe that is pushed towards that end, as after a gain that was too large: it
//! rests there until the controller pushes it away. A ball that is stuck where the controller has no error is not
//! detected.

use config::Stuck;

/// A ball whose readings vary by no more than this has not moved, mm: eight times the noise of one reading.
const STILL_MM: f64 = 20.0;
/// A ball this close to an end of the pipe may lie there, mm: as far as the noise of its readings reaches.
const AT_END_MM: f64 = STILL_MM;

/// Memory of a push.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Still {
    push: Option<Push>,
}

#[derive(Clone, Copy, Debug)]
struct Push {
    since_s: f64,
    upward: bool,
    lowest_mm: f64,
    highest_mm: f64,
}

impl Still {
    /// Takes a cycle of closed loop in a pipe of `top_mm`. Returns how long the ball has been stuck, if that is too
    /// long.
    pub(super) fn pushed(
        &mut self,
        time_s: f64,
        position_mm: f64,
        control_percent: f64,
        limits: &Stuck,
        top_mm: f64,
    ) -> Option<f64> {
        let upward = control_percent > 0.0;
        let at_end = if upward { position_mm >= top_mm - AT_END_MM } else { position_mm <= AT_END_MM };
        if at_end || control_percent.abs() < limits.control_percent {
            self.push = None;
            return None;
        }
        let begins = Push { since_s: time_s, upward, lowest_mm: position_mm, highest_mm: position_mm };
        let push = self.push.get_or_insert(begins);
        push.lowest_mm = push.lowest_mm.min(position_mm);
        push.highest_mm = push.highest_mm.max(position_mm);
        if push.upward != upward || push.highest_mm - push.lowest_mm > STILL_MM {
            *push = begins;
        }
        let still_s = time_s - push.since_s;
        (still_s >= limits.after_s).then_some(still_s)
    }
}
