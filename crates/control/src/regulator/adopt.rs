//! Other numbers in flight: laws, observer, and the duty that control values are counted from. All states are kept.

use super::{Handover, Regulator, Unready};
use crate::controller::Controllers;
use crate::feed_forward::Way;
use crate::mpc::Planner;
use crate::observer::Observer;
use crate::state_feedback::Integral;
use core::mem::discriminant;

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
        let Some(observer) = observer else {
            return set.needs_observer().map_or(Ok(()), |needed_by| Err(Unready::NoObserver { needed_by }));
        };
        let Some(estimator) = &self.estimator else { return Ok(()) };
        estimator.with(*observer).map_err(Unready::Observer)?;
        set.mpc.map_or(Ok(()), |mpc| Planner::new(&mpc, &observer.believed).map(drop).ok_or(Unready::Plan))
    }

    /// Flies with other numbers from the next step on: integrals stay. The control value moves as far as the numbers
    /// do, so go to far ones in small steps. Where words or tables are others, it stays: the controller is set up anew.
    pub fn adopt(&mut self, set: Controllers, observer: Option<&Observer>) {
        if says_otherwise(&self.set, &set) {
            self.handover = Handover::Ahead;
        }
        if self.set.feed_forward.is_none() {
            self.way = Way::default();
        }
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

/// Whether two sets of controllers have other words or tables; numbers may differ.
fn says_otherwise(old: &Controllers, new: &Controllers) -> bool {
    let pid = |set: &Controllers| set.pid.map(|law| (law.derivative_on, discriminant(&law.anti_windup)));
    let integral = |law: Option<Integral>| law.map(|integral| discriminant(&integral));
    let feedback = |set: &Controllers| set.state_feedback.map(|law| (law.velocity, integral(law.integral)));
    let cascade = |set: &Controllers| set.cascade.map(|law| law.velocity);
    let forward = |set: &Controllers| set.feed_forward.is_some();
    pid(old) != pid(new)
        || feedback(old) != feedback(new)
        || cascade(old) != cascade(new)
        || forward(old) != forward(new)
}
