//! Commands to the pilot in flight.

use super::cross_checks::Watch;
use super::{Pilot, Still};
use crate::flight::command::{Command, Refusal};
use crate::flight::name::Name;
use crate::flight::vocabulary::Mode;
use control::check::within;
use control::controller::Kind;

impl Pilot {
    /// Executes a command, or refuses it.
    ///
    /// # Errors
    /// [`Refusal`] names the limit that it would break.
    pub fn command(&mut self, command: Command) -> Result<(), Refusal> {
        match command {
            Command::Setpoint(asked_mm) => {
                let (min_mm, max_mm) = (self.orders.safety.setpoint_min_mm, self.orders.safety.setpoint_max_mm);
                within("setpoint_mm", asked_mm, min_mm, max_mm).map_err(|_| Refusal::Setpoint {
                    asked_mm,
                    min_mm,
                    max_mm,
                })?;
                if self.mode == Mode::OpenLoop {
                    return Err(Refusal::OpenLoop);
                }
                self.end_experiment();
                self.held_mm = Some(asked_mm);
            }
            Command::Gains(change) => self.change_commanded_gains(change)?,
            Command::Numbers(values) => self.change_numbers(&values)?,
            Command::Undo => self.undo()?,
            Command::Controller(asked) => {
                if !self.orders.regulator.switch(asked) {
                    return Err(Refusal::Controller { asked, known: self.orders.regulator.controllers().into() });
                }
            }
            Command::Stop => {
                // After a later `fly` the ball takes off into the programme, not into the middle of an experiment.
                self.end_experiment();
                self.mode = Mode::Stopped;
            }
            Command::Fly => {
                if self.mode == Mode::Stopped {
                    // A fault may have stopped it in the middle of an experiment.
                    self.end_experiment();
                    self.mode = Mode::Waiting;
                    self.fault = None;
                    self.last = None;
                    self.reported = None;
                    self.watch = Watch::default();
                    self.waiting_since_s = None;
                    self.been_in_band = false;
                    self.still = Still::default();
                }
            }
            Command::Programme => {
                self.end_experiment();
                self.held_mm = None;
            }
            Command::Experiment(asked) => self.begin_experiment(asked)?,
        }
        Ok(())
    }

    fn begin_experiment(&mut self, asked: Name) -> Result<(), Refusal> {
        let found = self.offers.iter().position(|offer| offer.name == asked);
        let index = found.ok_or(Refusal::Experiment { asked })?;
        let changes_gains = self.offers.get(index).is_some_and(|offer| offer.experiment.changes_gains());
        if changes_gains && self.controller() != Kind::Pid {
            return Err(Refusal::NeedsPid { flies: self.controller() });
        }
        if changes_gains && self.orders.compensation.predistortion.is_some() {
            return Err(Refusal::Predistortion);
        }
        if self.mode == Mode::Stopped {
            return Err(Refusal::Stopped);
        }
        self.end_experiment();
        self.held_mm = None;
        self.park_programme(index);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
