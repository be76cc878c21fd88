//! Progress of the programme: its own time, with segments that end early skipped, and its gains. During an experiment
//! that was started in flight, only the time of the programme goes on.

use super::{Pilot, Seen};
use crate::flight::command::GainChange;
use crate::flight::experiment::Experiment;
use crate::flight::experiment::offers::Offer;
use crate::flight::name::Name;
use crate::flight::vocabulary::Mode;
use control::pid::Pid;

/// Position of a flight within its experiment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Programme {
    /// Time of its start.
    began_s: Option<f64>,
    /// Skipped time, seconds.
    left_out_s: f64,
    /// The gains that it sets, and those to restore after them.
    gains: Option<(GainChange, Pid)>,
}

impl Programme {
    /// Starts at the first position.
    pub(super) fn begin(&mut self, time_s: f64) {
        self.began_s.get_or_insert(time_s);
    }

    /// The programme's own time. `None`: it has not begun.
    pub(super) fn at_s(&self, time_s: f64) -> Option<f64> {
        self.began_s.map(|began_s| time_s - began_s + self.left_out_s)
    }

    /// Whether it sets the gains now.
    pub(super) const fn sets_gains(&self) -> bool {
        self.gains.is_some()
    }

    /// Gains were commanded: these are restored later.
    pub(super) fn keep(&mut self, commanded: Pid) {
        if let Some((_, own)) = &mut self.gains {
            *own = commanded;
        }
    }
}

/// An experiment that was started in flight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Started {
    /// Its index in the offers.
    index: usize,
    /// The progress of the programme.
    parked: Programme,
}

impl Pilot {
    /// The same pilot, with experiments that may be started in flight.
    #[must_use]
    pub fn offering(mut self, offers: Vec<Offer>) -> Self {
        self.offers = offers;
        self
    }

    /// The experiments that can be started in flight.
    #[must_use]
    pub fn offers(&self) -> &[Offer] {
        &self.offers
    }

    /// The programme, or an experiment that was started.
    pub(super) fn flown(&self) -> &Experiment {
        let started = self.started.and_then(|started| self.offers.get(started.index));
        started.map_or(&self.orders.experiment, |offer| &offer.experiment)
    }

    /// The experiment that was started and is not over.
    #[must_use]
    pub fn experiment(&self) -> Option<Name> {
        self.offers.get(self.started?.index).map(|offer| offer.name)
    }

    /// Starts an experiment of the offers. Its time begins with the next cycle that has a position.
    pub(super) fn park_programme(&mut self, index: usize) {
        self.give_gains_back();
        self.started = Some(Started { index, parked: self.programme });
        self.programme = Programme::default();
        self.been_in_band = false;
    }

    /// Returns to the programme, if an experiment was started.
    pub(super) fn end_experiment(&mut self) {
        let Some(started) = self.started else { return };
        self.give_gains_back();
        self.programme = started.parked;
        self.started = None;
        self.been_in_band = false;
    }

    fn give_gains_back(&mut self) {
        if let Some((_, own)) = self.programme.gains.take() {
            self.change_gains(own);
        }
    }

    /// Begins the experiment that was started in flight, and returns to the programme after its end.
    fn follow_experiment(&mut self, time_s: f64) {
        let airborne = !matches!(self.mode, Mode::Waiting | Mode::Stopped);
        let over = self.programme.at_s(time_s).is_some_and(|at_s| self.flown().demand(at_s).is_none());
        if over && self.started.is_some() {
            self.end_experiment();
        }
        if airborne {
            self.programme.begin(time_s);
        }
    }

    /// Skips segments that the ball's position has ended, and sets the gains of the programme. A commanded setpoint is
    /// in force instead of the programme, of which only the time goes on.
    pub(super) fn follow_programme(&mut self, time_s: f64, seen: Seen) {
        self.follow_experiment(time_s);
        let Some(at_s) = self.programme.at_s(time_s) else { return };
        if let (Seen::Ball(position_mm), None) = (seen, self.held_mm) {
            self.programme.left_out_s += self.flown().left_out_s(at_s, position_mm);
        }
        let asked = self.programme.at_s(time_s).and_then(|at_s| self.flown().gains(at_s));
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

    /// The integral is kept: if it absorbed the derivative of noise, it would push the ball for T_i.
    fn change_gains(&mut self, gains: Pid) {
        self.orders.regulator.forget_derivatives();
        self.orders.regulator.retune(gains);
    }
}
