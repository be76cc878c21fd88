//! The mode that comes next: by what is seen of the ball, and for how long nothing is.

use super::{Pilot, Seen};
use crate::flight::experiment::Demand;
use crate::flight::vocabulary::{Fault, Mode};

/// How long the first position may take, seconds: a working sensor that sees a ball needs a hundredth of it.
const WAIT_S: f64 = 5.0;

impl Pilot {
    /// The mode after this cycle's reading.
    pub(super) fn change_mode(&mut self, time_s: f64, seen: Seen) {
        let silent_s = self.last.map_or(0.0, |(last_s, _)| time_s - last_s);
        // A loop that is faster than its sensor has no new report in most cycles.
        if let Seen::Nothing(Some(fault)) = seen {
            self.reported = Some((time_s, fault));
        }
        let is_recent = |(at_s, _): &(f64, Fault)| time_s - at_s <= self.missing_s();
        let reported = self.reported.filter(is_recent).map(|(_, fault)| fault);
        self.mode = match (self.mode, seen) {
            (Mode::Stopped, _) => Mode::Stopped,
            (Mode::Waiting, Seen::Nothing(_)) => {
                let silent_s = time_s - *self.waiting_since_s.get_or_insert(time_s);
                let fault = reported.unwrap_or(Fault::SensorSilent { silent_s });
                if silent_s > WAIT_S { self.stop(fault) } else { Mode::Waiting }
            }
            (Mode::Waiting, Seen::Ball(_)) => {
                self.programme.begin(time_s);
                self.orders.regulator.take_off();
                self.closed_or_open(time_s)
            }
            (_, Seen::Nothing(_)) if silent_s > self.orders.safety.coast_s => {
                self.stop(reported.unwrap_or(Fault::SensorSilent { silent_s }))
            }
            (mode, Seen::Nothing(_)) => {
                if silent_s > self.missing_s() {
                    Mode::Coasting
                } else {
                    mode
                }
            }
            (_, Seen::Ball(position_mm)) => match self.left_band(position_mm) {
                Some(fault) => self.stop(fault),
                None => self.closed_or_open(time_s),
            },
        };
    }

    fn closed_or_open(&mut self, time_s: f64) -> Mode {
        match self.demand(time_s) {
            Some(Demand::Drive { .. }) => Mode::OpenLoop,
            _ => {
                if self.mode == Mode::OpenLoop {
                    // The integral still contains hover; the duty of an excitation does not.
                    self.orders.regulator.forget_derivatives();
                }
                Mode::Flying
            }
        }
    }

    pub(super) fn stop(&mut self, fault: Fault) -> Mode {
        self.fault = Some(fault);
        Mode::Stopped
    }

    /// The band of an experiment applies after the ball has been inside it: it starts at the bottom.
    fn left_band(&mut self, position_mm: f64) -> Option<Fault> {
        let outside = self.flown().outside_band(position_mm);
        self.been_in_band |= outside.is_none();
        outside.filter(|_| self.been_in_band).map(|(min_mm, max_mm)| Fault::OutsideBand { position_mm, min_mm, max_mm })
    }
}
