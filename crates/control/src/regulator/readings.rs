//! The measurements for the regulator: the position by one sensor or two, and the speed of the fan.

use super::{Regulator, STRONGEST, VELOCITY_N, VELOCITY_TD_S, is_a_place, sensible};
use crate::observer::Estimate;
use libm::fabs;

impl Regulator {
    /// Takes a reading, `dt_s` after the last one.
    pub fn read(&mut self, position_mm: f64, dt_s: f64) {
        if self.filter(position_mm, dt_s) {
            self.innovation = self.estimator.as_mut().and_then(|estimator| estimator.update(position_mm));
        }
    }

    /// Takes a reading of the second sensor besides one of the first: only the observer uses it, if its noise is known.
    pub fn read_second(&mut self, position_mm: f64) {
        if let Some(estimator) = self.estimator.as_mut().filter(|estimator| estimator.knows_second())
            && is_a_place(position_mm)
        {
            estimator.update_second(position_mm);
        }
    }

    /// Takes a reading of the second sensor in place of one of the first, `dt_s` after the last of either.
    pub fn stand_in(&mut self, position_mm: f64, dt_s: f64) {
        if self.filter(position_mm, dt_s) {
            self.innovation = self.estimator.as_mut().and_then(|estimator| estimator.update_second(position_mm));
        }
    }

    /// Takes the control value at which the fan would keep its speed.
    pub fn read_fan(&mut self, control: f64) {
        if let Some(estimator) = self.estimator.as_mut().filter(|_| fabs(control) <= STRONGEST) {
            estimator.update_fan(control);
        }
    }

    /// Takes a position into the velocity's filter. `false`: the position is not possible.
    fn filter(&mut self, position_mm: f64, dt_s: f64) -> bool {
        if !is_a_place(position_mm) {
            return false;
        }
        let filtered = self.velocity.step(position_mm, sensible(dt_s), VELOCITY_TD_S, VELOCITY_N);
        let velocity_mm_per_s = filtered / VELOCITY_TD_S;
        self.filtered = Some(Estimate { position_mm, velocity_mm_per_s, fan: 0.0, disturbance: 0.0 });
        true
    }
}
