//! What a force or a shift of the readings may depend on, before each reading of a filter run.

use super::sensitivities::FilterRun;
use crate::fit::estimate::Problem;
use crate::record::commanded::commanded;
use plant::{Conditions, Input, Model};

/// The share of a change that has come after `dt_s` through a first-order lag of `lag_s`; all of it without a lag.
pub(crate) fn share_after(dt_s: f64, lag_s: f64) -> f64 {
    if lag_s > 0.0 { -(-dt_s / lag_s).exp_m1() } else { 1.0 }
}

/// The conditions between the previous reading and a reading.
pub(crate) struct Before {
    /// Seconds since the previous reading.
    pub(crate) dt_s: f64,
    /// The filtered state after the previous reading, the command since, and the time midway.
    pub(crate) conditions: Conditions,
    /// Whether it is the first reading of a flight that has a previous one.
    pub(crate) is_first: bool,
}

impl FilterRun {
    /// The conditions before each reading; `None` where there is no previous one.
    pub(crate) fn before_readings(&self, problem: &Problem<'_>) -> Vec<Option<Before>> {
        let model = &self.fit.model;
        // The rows before each reading include the delay of the duty already.
        let prompt = Model { effects: model.effects.without_duty_delay(), ..model.clone() };
        let (commanded, writes) = (commanded(&prompt, problem.recording), problem.recording.writes());
        let rows = self.rows_on_the_way(problem.recording);
        let at = |k: usize| {
            let dt_s = self.steps[k].dt?;
            let leg = &self.steps[k.checked_sub(1)?].leg;
            let now = &commanded[rows[k].clone()];
            let commanded_mm_per_s2 = now.iter().sum::<f64>() / now.len().max(1) as f64;
            let setpoint_mm = writes.get(rows[k].start).and_then(|write| write.setpoint_mm);
            let input = Input { commanded_mm_per_s2, time_s: leg.time_s + 0.5 * dt_s, setpoint_mm };
            let mut motion = leg.motion;
            if !model.effects.has_fan_state() {
                motion.fan_mm_per_s2 = commanded_mm_per_s2;
            }
            let is_first = self.steps[k - 1].dt.is_none();
            Some(Before { dt_s, conditions: model.conditions_of(&motion, input), is_first })
        };
        (0..self.steps.len()).map(at).collect()
    }
}
