//! What the link asks the program that owns it, in the publisher's thread.

use crate::flight::last_fault::LastFault;
use crate::flight::vocabulary::Fault;
use control::numbers::Values;

/// The program that flies.
pub trait Owner: Send {
    /// A fault has stopped the fan, and the flight waits for `fly`: keeps it, and returns what is published.
    fn waits_after(&self, fault: Fault) -> LastFault;
    /// The K_p at which the PID loop of the believed model loses stability with these numbers. `None`: at none, or
    /// there is no model or no PID.
    fn critical_kp_per_mm(&self, numbers: &Values) -> Option<f64>;
}

/// An owner without a disk and without a model.
#[cfg(test)]
pub(crate) struct Nobody;

#[cfg(test)]
impl Owner for Nobody {
    fn waits_after(&self, fault: Fault) -> LastFault {
        LastFault::now(fault.to_string(), None)
    }

    fn critical_kp_per_mm(&self, numbers: &Values) -> Option<f64> {
        numbers.first().copied().flatten().map(|kp_per_mm| 6.0 * kp_per_mm)
    }
}
