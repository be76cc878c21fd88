//! Other numbers in flight: checked as a whole, reached in half a second, and taken back in their order.

use super::Pilot;
use crate::flight::command::{GainChange, Refusal};
use control::check::within;
use control::numbers::{Numbers, Values};

/// Time in which numbers move to where they are wanted, seconds: a quick loop's own.
const MOVES_S: f64 = 0.5;
/// Changes that can be taken back.
const KEPT: usize = 16;

/// The numbers of a flight.
#[derive(Clone, Debug)]
pub(super) struct Tuning {
    /// As commanded last.
    wanted: Numbers,
    /// Where the numbers come from, and how long they have moved, while they do.
    on_the_way: Option<(Numbers, f64)>,
    /// What was wanted before, the oldest first.
    before: Vec<Numbers>,
}

impl Tuning {
    /// The numbers that a flight begins with.
    pub(super) fn of(numbers: Numbers) -> Self {
        Self { wanted: numbers, on_the_way: None, before: Vec::with_capacity(KEPT) }
    }

    /// Wants other numbers; the old ones can be taken back.
    fn replace(&mut self, wanted: Numbers) {
        if self.before.len() == KEPT {
            self.before.remove(0);
        }
        self.before.push(std::mem::replace(&mut self.wanted, wanted));
    }

    /// The numbers now.
    fn now(&self) -> Numbers {
        match &self.on_the_way {
            Some((from, moved_s)) => self.wanted.on_the_way(from, moved_s / MOVES_S),
            None => self.wanted.clone(),
        }
    }
}

impl Pilot {
    /// The numbers that were commanded last; those of a programme's segment are not among them.
    #[must_use]
    pub const fn numbers(&self) -> &Numbers {
        &self.tuning.wanted
    }

    /// Changes numbers together.
    pub(super) fn change_numbers(&mut self, values: &Values) -> Result<(), Refusal> {
        let wanted = self.tuning.wanted.with(values).map_err(Refusal::Absent)?;
        self.move_to(wanted, true)
    }

    /// Changes gains of the PID. While a programme sets them, they are for the time after it.
    pub(super) fn change_commanded_gains(&mut self, change: GainChange) -> Result<(), Refusal> {
        let commanded = self.tuning.wanted.controllers.pid;
        let gains = change.applied_to(commanded.or(self.gains()).ok_or(Refusal::NoPid)?);
        gains.check().map_err(Refusal::Gain)?;
        let mut wanted = self.tuning.wanted.clone();
        wanted.controllers.pid = Some(gains);
        if self.programme.sets_gains() {
            self.programme.keep(gains);
            self.tuning.replace(wanted);
            return Ok(());
        }
        self.move_to(wanted, true)
    }

    /// Takes the last change back.
    pub(super) fn undo(&mut self) -> Result<(), Refusal> {
        let before = self.tuning.before.last().cloned().ok_or(Refusal::NothingToUndo)?;
        self.move_to(before, false)?;
        self.tuning.before.pop();
        Ok(())
    }

    fn move_to(&mut self, wanted: Numbers, keep: bool) -> Result<(), Refusal> {
        if self.programme.sets_gains() {
            return Err(Refusal::ProgrammeGains);
        }
        wanted.check().map_err(|(table, error)| Refusal::Number { table, error })?;
        let safety = &self.orders.safety;
        let (lowest, highest) = (safety.duty_min_percent, safety.duty_max_percent);
        within("hover_duty_percent", wanted.compensation.hover_duty_percent, lowest, highest)
            .map_err(|error| Refusal::Number { table: "compensation", error })?;
        let regulator = &mut self.orders.regulator;
        regulator.can_fly(&wanted.controllers, wanted.observer.as_ref()).map_err(Refusal::Unready)?;
        if let Some(observer) = &wanted.observer {
            regulator.observe_with(observer).map_err(Refusal::Unready)?;
        }
        self.tuning.on_the_way = Some((self.tuning.now(), 0.0));
        if keep {
            self.tuning.replace(wanted)
        } else {
            self.tuning.wanted = wanted
        }
        Ok(())
    }

    /// Moves the numbers, after `dt_s`.
    pub(super) fn move_numbers(&mut self, dt_s: f64) {
        let Some((_, moved_s)) = &mut self.tuning.on_the_way else { return };
        *moved_s += dt_s.max(0.0);
        if *moved_s >= MOVES_S {
            self.tuning.on_the_way = None;
        }
        let mut now = self.tuning.now();
        if self.programme.sets_gains() {
            now.controllers.pid = self.orders.regulator.controllers().pid;
        }
        let by = self.compensator.adopt(&now.compensation, self.control);
        self.control += by;
        self.acting += by;
        self.orders.regulator.rebase(by);
        self.orders.regulator.adopt(now.controllers, now.observer.as_ref());
        self.orders.compensation = now.compensation;
    }
}

#[cfg(test)]
mod tests;
