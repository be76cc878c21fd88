//! How far the programme is: its own time, from which segments that end early are left out, and the gains that it asks for.

use super::{Pilot, Seen};
use crate::command::GainChange;
use control::pid::Pid;

/// Where in its experiment a flight is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Programme {
    /// When it began.
    began_s: Option<f64>,
    /// What has been left out of it, seconds.
    left_out_s: f64,
    /// The gains that it asks for, and those that come back after them.
    gains: Option<(GainChange, Pid)>,
}

impl Programme {
    /// The first position is there.
    pub(super) fn begin(&mut self, time_s: f64) {
        self.began_s.get_or_insert(time_s);
    }

    /// The programme's own time. `None`: it has not begun.
    pub(super) fn at_s(&self, time_s: f64) -> Option<f64> {
        self.began_s.map(|began_s| time_s - began_s + self.left_out_s)
    }

    /// Somebody commanded gains: they are the ones that come back.
    pub(super) fn keep(&mut self, commanded: Pid) {
        if let Some((_, own)) = &mut self.gains {
            *own = commanded;
        }
    }
}

impl Pilot {
    /// Leaves out what the ball has ended, and takes the gains that the programme asks for. A setpoint that was commanded is in force
    /// instead of the programme, which goes on in time alone.
    pub(super) fn follow_programme(&mut self, time_s: f64, seen: Seen) {
        let Some(at_s) = self.programme.at_s(time_s) else { return };
        if let (Seen::Ball(position_mm), None) = (seen, self.held_mm) {
            self.programme.left_out_s += self.orders.experiment.left_out_s(at_s, position_mm);
        }
        let asked = self.programme.at_s(time_s).and_then(|at_s| self.orders.experiment.gains(at_s));
        let asked = asked.filter(|_| self.held_mm.is_none());
        match (asked, self.programme.gains, self.gains()) {
            (Some(asked), Some((given, _)), _) if asked == given => {}
            (Some(asked), given, Some(now)) => {
                let own = given.map_or(now, |(_, own)| own);
                self.programme.gains = Some((asked, own));
                self.change_gains(asked.applied_to(own));
            }
            (None, Some((_, own)), _) => {
                self.programme.gains = None;
                self.change_gains(own);
            }
            _ => {}
        }
    }

    /// The integral stands: one that took up what the derivative makes of noise would push the ball for T_i.
    fn change_gains(&mut self, gains: Pid) {
        self.orders.regulator.forget_derivatives();
        self.orders.regulator.retune(gains);
    }
}
