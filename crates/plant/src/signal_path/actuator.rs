//! What the effects that are on do between the duty and the acceleration by the fan.

use super::{acts, name};
use crate::effects::{Effects, for_each_effect};

impl Effects {
    /// By how much a duty acts late, seconds.
    #[inline(always)]
    #[must_use]
    pub fn duty_delay_s(&self) -> f64 {
        fold!(self, delays_duty, 0.0, |sum, act, effect| sum + act(effect))
    }

    /// The duty that the fan makes of one, percent.
    #[inline(always)]
    pub(crate) fn duty(&self, percent: f64) -> f64 {
        fold!(self, on_duty, percent, |duty, act, effect| act(effect, duty))
    }

    /// The duty that acts `dt_s` after it was `reached_percent`, under a constant duty, percent.
    #[inline(always)]
    pub(crate) fn reached(&self, reached_percent: f64, duty_percent: f64, dt_s: f64) -> f64 {
        fold!(self, slews, duty_percent, |_duty, act, effect| act(effect, reached_percent, duty_percent, dt_s))
    }

    /// Whether the duty that acts moves between the duties that are written.
    #[inline(always)]
    pub(crate) fn slews(&self) -> bool {
        any!(self, slews)
    }

    /// How far hover has moved, percent.
    #[inline(always)]
    pub(crate) fn hover_shift_percent(&self, time_s: f64) -> f64 {
        fold!(self, shifts_hover, 0.0, |sum, act, effect| sum + act(effect, time_s))
    }

    /// Whether hover moves with time.
    #[inline(always)]
    pub(crate) fn hover_shifts(&self) -> bool {
        any!(self, shifts_hover)
    }

    /// Where the play stands once the duty has gone to `about_hover_percent`.
    #[inline(always)]
    pub(crate) fn play(&self, stands_percent: f64, about_hover_percent: f64) -> f64 {
        fold!(self, plays, about_hover_percent, |_stands, act, effect| act(effect, stands_percent, about_hover_percent))
    }

    /// The effective duty about hover at a time and a setpoint, percent.
    #[inline(always)]
    pub(crate) fn effective(&self, about_hover_percent: f64, hover_percent: f64, time_s: f64, setpoint_mm: f64) -> f64 {
        let u = fold!(self, on_command, about_hover_percent, |u, act, effect| act(effect, u));
        self.written.effective(u, [hover_percent + about_hover_percent, time_s, setpoint_mm])
    }

    /// The gain at an effective duty and a time, in the unit of `gain`.
    #[inline(always)]
    pub(crate) fn gain(&self, gain: f64, effective_percent: f64, time_s: f64) -> f64 {
        let gain = fold!(self, gain_by_command, gain, |gain, act, effect| gain * act(effect, effective_percent));
        fold!(self, gain_by_time, gain, |gain, act, effect| gain * act(effect, time_s))
    }

    /// Whether the command moves with time under a constant duty.
    #[inline(always)]
    pub(crate) fn command_drifts(&self) -> bool {
        self.hover_shifts() || self.slews() || any!(self, gain_by_time) || self.written.command_drifts()
    }

    /// The acceleration that the fan can give of the commanded one, mm/s².
    #[inline(always)]
    pub(crate) fn limited(&self, commanded: f64) -> f64 {
        fold!(self, limits, commanded, |a, act, effect| act(effect, a))
    }

    /// The fan's acceleration, mm/s², `dt_s` after it was `acceleration`, under a constant command.
    #[inline(always)]
    pub(crate) fn fan(&self, commanded: f64, acceleration: f64, dt_s: f64) -> f64 {
        fold!(self, follows, commanded, |_a, act, effect| act(effect, commanded, acceleration, dt_s))
    }

    /// Whether the fan has inertia, and so a state.
    #[inline(always)]
    #[must_use]
    pub fn has_fan_state(&self) -> bool {
        any!(self, follows)
    }

    /// The same effects without those that act behind the rotor, or delay nothing of it.
    #[must_use]
    pub fn of_rotor(&self) -> Self {
        let mut effects = self.clone();
        for entry in self.present().iter().filter(|entry| !entry.acts.reaches_rotor) {
            effects.remove(entry.name);
        }
        effects
    }

    /// The same effects without those by which a duty acts late as a whole.
    #[must_use]
    pub fn without_duty_delay(&self) -> Self {
        let mut effects = self.clone();
        for_each_effect!(self, effect => if acts(effect).delays_duty.is_some() { effects.remove(name(effect)); });
        effects
    }
}
