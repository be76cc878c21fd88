//! Other numbers in flight: laws, observer, and the duty that control values are counted from. All states are kept.

use super::{Regulator, Unready};
use crate::controller::Controllers;
use crate::mpc::Planner;
use crate::observer::Observer;

impl Regulator {
    /// The observer's numbers. `None`: there is none.
    #[must_use]
    pub fn observer(&self) -> Option<&Observer> {
        self.estimator.as_ref().map(crate::observer::Estimator::numbers)
    }

    /// Whether an estimate and plans can be made with these numbers.
    ///
    /// # Errors
    /// [`Unready`]: they are too far apart.
    pub fn can_fly(&self, set: &Controllers, observer: Option<&Observer>) -> Result<(), Unready> {
        let Some(observer) = observer else { return Ok(()) };
        let Some(estimator) = &self.estimator else { return Ok(()) };
        estimator.with(*observer).map_err(Unready::Observer)?;
        set.mpc.map_or(Ok(()), |mpc| Planner::new(&mpc, &observer.believed).map(drop).ok_or(Unready::Plan))
    }

    /// Flies with other numbers of the same tables from the next step on: integrals stay. The control value moves as
    /// far as the numbers do, so go to far ones in small steps.
    pub fn adopt(&mut self, set: Controllers, observer: Option<&Observer>) {
        if let (Some(old), Some(new)) = (self.set.pid, set.pid) {
            new.rescale(&old, &mut self.pid);
        }
        let planned = set.mpc.zip(observer.map(|observer| observer.believed));
        if let Some((mpc, believed)) = planned.filter(|_| planned != self.planned)
            && let Some(planner) = Planner::new(&mpc, &believed)
        {
            (self.planner, self.planned) = (Some(planner), planned);
        }
        self.set = set;
    }

    /// Estimates with other numbers of the observer from the next reading on: the estimate stays.
    ///
    /// # Errors
    /// [`Unready::Observer`]: they are too far apart, and the present ones stay.
    pub fn observe_with(&mut self, observer: &Observer) -> Result<(), Unready> {
        if let Some(estimator) = &mut self.estimator {
            *estimator = estimator.with(*observer).map_err(Unready::Observer)?;
        }
        Ok(())
    }

    /// Counts control values from another duty, so that each is larger `by` so much: what has found hover stays there.
    pub fn rebase(&mut self, by: f64) {
        self.control += by;
        self.integral += by;
        self.pid.rebase(by);
        if let Some(estimator) = &mut self.estimator {
            estimator.rebase(by);
        }
    }
}
