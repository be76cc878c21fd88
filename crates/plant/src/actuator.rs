//! From the duty that is written to the acceleration that it commands: the fan without its inertia.
//!
//! ```text
//! duty(t − delay) → nearest step → rate limit → u = duty − hover − drift·t → play → dead zone → thrust curve
//!   → gain·asymmetry·(1 + drift·t) → limits = commanded acceleration
//! ```
//!
//! The result does not depend on where the ball is: along a recorded duty it can be computed once.
//! Source: the order of the signal path, from the wire to the air.

use crate::model::Model;
use std::collections::VecDeque;

/// The state of the actuator. Its parameters are in the [`Model`], which every call takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator {
    /// Duties within the dead time: when each begins to act, and the duty.
    on_their_way: VecDeque<(f64, f64)>,
    /// The duty in force, percent.
    duty_percent: f64,
    /// What the actuator, whose rate may be limited, has reached of it, percent, and when, seconds.
    reached_percent: f64,
    reached_at_s: f64,
    /// The setpoint in force, mm, where it is known.
    setpoint_mm: Option<f64>,
    /// The state of the play, percent about hover.
    play_percent: f64,
}

impl Actuator {
    /// An actuator on which `duty_percent` has acted for ever before time 0, its play centred.
    #[must_use]
    pub fn new(model: &Model, duty_percent: f64) -> Self {
        let reached_percent = model.effects.duty(duty_percent);
        Self {
            on_their_way: VecDeque::new(),
            duty_percent,
            reached_percent,
            reached_at_s: 0.0,
            setpoint_mm: None,
            play_percent: about_hover(model, reached_percent, 0.0),
        }
    }

    /// Writes a duty at `time_s`. Times must not fall from call to call, of this and of [`Self::commanded`].
    #[inline]
    pub fn write(&mut self, model: &Model, time_s: f64, duty_percent: f64) {
        let delay_s = model.effects.duty_delay_s();
        if delay_s > 0.0 {
            self.on_their_way.push_back((time_s + delay_s, duty_percent));
        } else {
            self.take(model, time_s, duty_percent);
        }
    }

    /// The next instant after `after_s` at which the command jumps; integration steps should end there.
    #[inline]
    #[must_use]
    pub fn next_jump_s(&self, after_s: f64) -> Option<f64> {
        self.on_their_way.iter().map(|(at_s, _)| *at_s).find(|at_s| *at_s > after_s)
    }

    /// The commanded acceleration at `time_s`, mm/s² about hover.
    #[inline]
    pub fn commanded(&mut self, model: &Model, time_s: f64) -> f64 {
        while let Some(&(at_s, duty_percent)) = self.on_their_way.front().filter(|(at_s, _)| *at_s <= time_s) {
            self.on_their_way.pop_front();
            self.take(model, at_s, duty_percent);
        }
        self.drift_to(model, time_s);
        self.force(model, time_s)
    }

    /// Sets the setpoint in force, mm; `None` keeps the last one.
    #[inline]
    pub fn set_setpoint(&mut self, setpoint_mm: Option<f64>) {
        self.setpoint_mm = setpoint_mm.or(self.setpoint_mm);
    }

    /// The setpoint in force, mm, where it is known.
    #[must_use]
    pub const fn setpoint_mm(&self) -> Option<f64> {
        self.setpoint_mm
    }

    /// The acceleration that the duty commands once it is through the play, mm/s².
    #[inline]
    fn force(&self, model: &Model, time_s: f64) -> f64 {
        let (effects, setpoint_mm) = (&model.effects, model.setpoint(self.setpoint_mm));
        let u = effects.effective(self.play_percent, model.hover_duty_percent, time_s, setpoint_mm);
        effects.limited(effects.gain(model.gain_mm_per_s2_per_percent, u, time_s) * u)
    }

    /// Whether the command moves between its jumps.
    #[must_use]
    pub fn drifts(model: &Model) -> bool {
        model.effects.command_drifts()
    }

    /// Puts a duty in force; first the actuator follows the old one until then.
    #[inline]
    fn take(&mut self, model: &Model, time_s: f64, duty_percent: f64) {
        self.drift_to(model, time_s);
        self.duty_percent = duty_percent;
        self.follow(model, time_s);
    }

    /// The play moves between duties if the rate is limited or the hover drifts; otherwise it keeps its value after the
    /// last duty.
    #[inline]
    fn drift_to(&mut self, model: &Model, time_s: f64) {
        if model.effects.slews() || model.effects.hover_shifts() {
            self.follow(model, time_s);
        }
    }

    #[inline]
    fn follow(&mut self, model: &Model, time_s: f64) {
        let duty_percent = model.effects.duty(self.duty_percent);
        self.reached_percent = model.effects.reached(self.reached_percent, duty_percent, time_s - self.reached_at_s);
        self.reached_at_s = time_s;
        let input = about_hover(model, self.reached_percent, time_s);
        self.play_percent = model.effects.play(self.play_percent, input);
    }
}

/// u: the duty that is reached about hover, percent.
#[inline]
fn about_hover(model: &Model, reached_percent: f64, time_s: f64) -> f64 {
    reached_percent - model.hover_duty_percent - model.effects.hover_shift_percent(time_s)
}

#[cfg(test)]
mod tests;
