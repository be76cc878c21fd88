//! A simulated rig without chips: the loop gets the plant's readings, and a duty acts as it is written.
//!
//! For rigs whose sensor and fan driver are unknown. Time advances only when the loop sleeps.

use super::{Rig, Sighting};
use control::{Duty, Millimetres};
use embedded_hal::i2c::ErrorKind;
use plant::{Model, Motion, Simulator};
use std::cell::Cell;

/// The plant, read and driven without a bus.
pub struct Direct {
    simulator: Simulator,
    now_s: Cell<f64>,
    setpoint_mm: Option<f64>,
}

impl Direct {
    /// A rig with the ball at the bottom of its travel and the fan off, at time 0.
    #[must_use]
    pub fn new(model: &Model, seed: u64) -> Self {
        Self { simulator: Simulator::new(model.clone(), seed), now_s: Cell::new(0.0), setpoint_mm: None }
    }

    /// The true motion of the ball now.
    pub(super) fn motion_now(&self) -> Motion {
        motion_at(&self.simulator, self.now_s.get())
    }
}

/// The motion at a time that may be ahead of a simulator, which does not fly on: where it stops would change how it
/// cuts time into steps.
pub(super) fn motion_at(simulator: &Simulator, time_s: f64) -> Motion {
    let mut ahead = simulator.clone();
    ahead.advance_to(time_s);
    ahead.motion()
}

impl Rig for Direct {
    fn now_s(&self) -> f64 {
        self.now_s.get()
    }

    fn sleep_until_s(&self, t_s: f64) {
        self.now_s.set(self.now_s.get().max(t_s));
    }

    fn align(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }

    fn position(&mut self) -> Result<Sighting, ErrorKind> {
        self.simulator.advance_to(self.now_s.get());
        Ok(Sighting::Ball(Millimetres(self.simulator.reading_mm())))
    }

    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind> {
        self.simulator.advance_to(self.now_s.get());
        self.simulator.set_setpoint(self.setpoint_mm);
        self.simulator.drive(duty.percent());
        Ok(duty)
    }

    fn set_setpoint(&mut self, setpoint_mm: Option<f64>) {
        self.setpoint_mm = setpoint_mm;
    }
}
